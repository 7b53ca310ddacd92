// What an audit says of its tests.
#include <set>
#include <gtest/gtest.h>

#include "tests/support/places.h"
#include "framework/core/digest.h"
#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/grading/grades/audit.h"
#include "framework/grading/grades/grade_key.h"
#include "framework/grading/grades/kept_file.h"

namespace tumble::grading {
namespace {

AuditResult result(const std::string& name, bool is_right,
                   const std::vector<std::string>& caught_by) {
  AuditResult result;
  result.candidate.name = name;
  result.candidate.file = name + ".cpp";
  result.candidate.is_right = is_right;
  for (const std::string& test : caught_by) {
    TestResult wrong;
    wrong.test = test;
    wrong.verdict = Verdict::kWrong;
    result.caught_by.push_back(wrong);
  }
  return result;
}

TEST(Audit, ARightSolutionThatATestAccusesIsNoCatch) {
  const auto catches = catches_of(
      {result("slip", false, {"S.One"}), result("another way", true, {"S.One", "S.Two"})});
  EXPECT_EQ(catches.at("S.One").count, 1u);
  EXPECT_FALSE(catches.contains("S.Two"));
}

TEST(Audit, NamesTheSlipsThatOneTestAloneCatches) {
  const auto catches =
      catches_of({result("alone", false, {"S.One"}), result("twice", false, {"S.One", "S.Two"}),
                  result("survives", false, {})});
  EXPECT_EQ(catches.at("S.One").count, 2u);
  EXPECT_EQ(catches.at("S.One").alone, std::vector<std::string>{"alone"});
  EXPECT_TRUE(catches.at("S.Two").alone.empty());
}

TEST(Audit, OnlyTheNamedAreJudgedAndAnUnknownNameIsAnsweredWithTheNearest) {
  const std::vector<Candidate> all = {result("e_squared", false, {}).candidate,
                                      result("float", false, {}).candidate,
                                      result("reference", true, {}).candidate};
  EXPECT_EQ(only(all, {}).size(), 3u);
  ASSERT_EQ(only(all, {"float", "reference"}).size(), 2u);
  EXPECT_EQ(only(all, {"float", "reference"})[0].name, "float");
  try {
    only(all, {"e_sqared"});
    FAIL() << "an unknown name was taken";
  } catch (const UserError& error) {
    EXPECT_NE(std::string(error.what()).find("Did you mean 'e_squared'?"), std::string::npos)
        << error.what();
  }
}

// All of these decide what a submission answers.
TEST(Audit, ResultsOfOtherFilesAreNotKept) {
  namespace fs = std::filesystem;
  modules::Registry registry;
  register_assignments(registry);
  const PrivateFolder build;
  const Course course{test::source_dir(), build.path(), &registry, ""};
  write_whole(build.path() / "bin/judge_a1", "one");
  std::set<std::string> digests{judging_digest(course, "a1")};
  for (const char* file : {"bin/judge_a1", "bin/worker_a1", "bin/sandbox_init",
                           "submission_sdk/precompiled.h", "submission_sdk/libkernels.a"}) {
    write_whole(build.path() / file, "another");
    EXPECT_TRUE(digests.insert(judging_digest(course, "a1")).second) << file;
  }
}

// As a process leaves them that ended while it wrote: the audit runs it again.
TEST(Audit, KeptResultsThatAreNotWholeAreNone) {
  namespace fs = std::filesystem;
  const fs::path root = test::source_dir();
  if (!fs::exists(root / "solutions_private/a1_impulse/mutants")) GTEST_SKIP() << "no slips here";
  modules::Registry registry;
  register_assignments(registry);
  const PrivateFolder build;
  write_whole(build.path() / "bin/judge_a1", "of which only the digest counts");
  const Course course{root, build.path(), &registry, ""};
  const Candidate slip = find_candidates(course, "a1").front();
  const std::string text = sources_of({slip}).front().text;
  const fs::path kept =
      build.path() / "audit/a1" /
      (slip.file.stem().string() + "-" +
       digest(judging_digest(course, "a1") + digest(text)).substr(0, 32) + ".results");
  write_results((build.path() / "results.json").string(),
                result(slip.name, false, {"Impulse.Any"}).caught_by);
  keep_file(kept, text_of(build.path() / "results.json"));
  ASSERT_EQ(kept_audit(course, "a1").size(), 1u);
  EXPECT_EQ(kept_audit(course, "a1").front().caught_by.size(), 1u);
  const std::string whole = text_of(kept);
  write_whole(kept, whole.substr(0, whole.size() / 2));
  EXPECT_TRUE(kept_audit(course, "a1").empty());
  write_whole(kept, text_of(build.path() / "results.json"));
  EXPECT_TRUE(kept_audit(course, "a1").empty()) << "without its digest";
}

}  // namespace
}  // namespace tumble::grading
