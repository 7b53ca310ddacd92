// The files that audits wrote for likely causes: each slip of the tree stands in one, each test in
// a rubric, and the slips can be told apart. Where a test here fails, `tumble audit aN` writes the
// file anew.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

#include "tests/support/places.h"
#include "framework/grading/course/slip.h"
#include "framework/grading/grades/causes_file.h"
#include "framework/grading/verdicts/rubric.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;

const fs::path kRoot = test::source_dir();

class CausesFile : public ::testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    if (!fs::exists(folder() / "mutants")) GTEST_SKIP() << "this tree has no slips";
    if (!fs::exists(folder() / "causes.json"))
      GTEST_SKIP() << "not audited yet: its pages group failures by function alone";
    slips = read_causes(folder() / "causes.json");
  }
  static fs::path folder() { return kRoot / "solutions_private" / GetParam(); }

  std::vector<AuditedSlip> slips;
};

TEST_P(CausesFile, HoldsEverySlipOfTheTreeInItsWords) {
  std::map<std::string, std::string> of_tree, of_file;
  for (const auto& entry : fs::directory_iterator(folder() / "mutants"))
    if (entry.path().extension() == kSlipExtension) {
      const SlipTitle title = read_slip_title(entry.path());
      of_tree[title.name] = title.slip;
    }
  for (const AuditedSlip& slip : slips) of_file[slip.name] = slip.says;
  EXPECT_EQ(of_tree, of_file);
}

TEST_P(CausesFile, NamesTestsOfTheRubricsAlone) {
  std::set<std::string> known;
  for (const auto& file :
       {kRoot / "assignments" / GetParam() / "rubric.json", folder() / "rubric_hidden.json"})
    for (const RubricItem& item : read_rubric(file).items) known.insert(item.test);
  for (const AuditedSlip& slip : slips) {
    EXPECT_FALSE(slip.fails.empty()) << slip.name;
    for (const Failure& failure : slip.fails)
      EXPECT_TRUE(known.contains(failure.test)) << slip.name << ": " << failure.test;
  }
}

// All tests that some slip fails, but these: passed.
std::map<std::string, std::string> others(const std::vector<AuditedSlip>& slips,
                                          const std::vector<Failure>& failures) {
  std::map<std::string, std::string> all;
  for (const AuditedSlip& slip : slips)
    for (const Failure& failure : slip.fails) all[failure.test] = failure.function;
  for (const Failure& failure : failures) all.erase(failure.test);
  return all;
}

bool names(const LikelySlip& likely, const std::string& slip) {
  return likely.name == slip ||
         std::find(likely.equals.begin(), likely.equals.end(), slip) != likely.equals.end();
}

// "a1_impulse", ...: the folders of assignments/ that hold a rubric.
std::vector<std::string> assignments() {
  std::vector<std::string> folders;
  for (const auto& entry : fs::directory_iterator(kRoot / "assignments"))
    if (fs::exists(entry.path() / "rubric.json")) folders.push_back(entry.path().filename());
  std::sort(folders.begin(), folders.end());
  return folders;
}

// What a submission with one slip fails is what the audit saw, so the slip, or one that cannot be
// told from it, comes first.
TEST_P(CausesFile, EachSlipAloneIsNamedFirst) {
  std::size_t named = 0;
  for (const AuditedSlip& slip : slips) {
    const auto found = likely_slips(slip.fails, others(slips, slip.fails), slips);
    named += !found.empty() && names(found.front(), slip.name);
  }
  RecordProperty("named", static_cast<int>(named));
  // Slips with the same answers in all tests stand for each other; a few are named third or later.
  EXPECT_GE(static_cast<double>(named), 0.9 * static_cast<double>(slips.size()));
}

// Two slips in two functions do not hide each other: each test that one of them alone fails gives
// its answer, and a common one fails in some way. Both are named in most pairs.
TEST_P(CausesFile, TwoSlipsInOneSubmissionAreBothNamed) {
  std::size_t pairs = 0, both = 0;
  for (std::size_t i = 0; i < slips.size(); ++i)
    for (std::size_t k = i + 1; k < slips.size(); ++k) {
      if (slips[i].function.empty() || slips[k].function.empty() ||
          slips[i].function == slips[k].function)
        continue;
      std::map<std::string, Failure> together;
      for (const AuditedSlip* slip : {&slips[i], &slips[k]})
        for (const Failure& failure : slip->fails) {
          const auto [it, is_new] = together.emplace(failure.test, failure);
          if (!is_new) it->second.found = "another answer";
        }
      std::vector<Failure> failures;
      for (const auto& [test, failure] : together) failures.push_back(failure);
      const auto found = likely_slips(failures, others(slips, failures), slips);
      const auto has = [&](const std::string& name) {
        return std::any_of(found.begin(), found.end(),
                           [&](const LikelySlip& likely) { return names(likely, name); });
      };
      ++pairs;
      both += has(slips[i].name) && has(slips[k].name);
    }
  ASSERT_GT(pairs, 0u);
  RecordProperty("pairs", static_cast<int>(pairs));
  RecordProperty("both", static_cast<int>(both));
  EXPECT_GE(static_cast<double>(both), 0.75 * static_cast<double>(pairs))
      << both << " of " << pairs;
}

INSTANTIATE_TEST_SUITE_P(Assignments, CausesFile, ::testing::ValuesIn(assignments()));

}  // namespace
}  // namespace tumble::grading
