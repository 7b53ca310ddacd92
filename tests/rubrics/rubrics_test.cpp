// A rubric and the tests it is about name the same tests, and the points of an assignment sum to
// 100.
#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/places.h"
#include "framework/grading/verdicts/rubric.h"

namespace tumble::testing {
namespace {

namespace fs = std::filesystem;
using Names = std::set<std::string>;

const fs::path kRoot = test::source_dir();
const fs::path kPrivate = kRoot / "solutions_private";  // absent from what students get

/// Tests that a judge of this build is linked with, "Suite.Name" a line. A judge holds no student's
/// file: it is there whatever stands in one.
Names tests_of(const std::string& program) {
  const std::string command = "'" + test::binary_dir() + "/bin/" + program + "' --list";
  const auto close = [](FILE* pipe) { ::pclose(pipe); };
  const std::unique_ptr<FILE, decltype(close)> pipe(::popen(command.c_str(), "r"), close);
  Names names;
  std::array<char, 512> buffer;
  while (pipe && std::fgets(buffer.data(), buffer.size(), pipe.get())) {
    std::string line(buffer.data());
    line.erase(line.find_last_not_of(" \n") + 1);
    names.insert(line);
  }
  return names;
}

Names named_in(const grading::Rubric& rubric) {
  Names names;
  for (const grading::RubricItem& item : rubric.items) names.insert(item.test);
  return names;
}

std::string missing_from(const Names& names, const Names& present) {
  std::string missing;
  for (const std::string& name : names)
    if (!present.contains(name)) missing += "\n  " + name;
  return missing;
}

void expect_same(const Names& in_rubric, const Names& linked, const std::string& rubric,
                 const std::string& program) {
  ASSERT_FALSE(linked.empty()) << program << " lists no test";
  EXPECT_EQ(missing_from(linked, in_rubric), "")
      << "in " << program << ", worth nothing in " << rubric;
  EXPECT_EQ(missing_from(in_rubric, linked), "") << "in " << rubric << ", unknown to " << program;
}

/// Folders below assignments/ that hold a rubric: "a1_impulse", "a2_integration", ...
std::vector<std::string> assignments() {
  std::vector<std::string> folders;
  for (const auto& entry : fs::directory_iterator(kRoot / "assignments"))
    if (fs::exists(entry.path() / "rubric.json")) folders.push_back(entry.path().filename());
  std::sort(folders.begin(), folders.end());
  return folders;
}

TEST(Rubrics, PublicOnesNameThePublicTests) {
  ASSERT_FALSE(assignments().empty());
  for (const std::string& folder : assignments()) {
    const fs::path file = kRoot / "assignments" / folder / "rubric.json";
    const grading::Rubric rubric = grading::read_rubric(file);
    EXPECT_EQ(folder.substr(0, rubric.assignment.size() + 1), rubric.assignment + "_") << file;
    expect_same(named_in(rubric), tests_of("check_" + rubric.assignment + "_sandboxed"),
                file.lexically_relative(kRoot), "check_" + rubric.assignment + "_sandboxed");
  }
}

TEST(Rubrics, SumTo100WithTheHiddenOnesAndNameEveryTest) {
  if (!fs::exists(kPrivate)) GTEST_SKIP() << "the hidden tests are not here";
  for (const std::string& folder : assignments()) {
    const fs::path file = kRoot / "assignments" / folder / "rubric.json";
    const grading::Rubric open = grading::read_rubric(file);
    const grading::Rubric hidden =
        grading::read_rubric(kPrivate / folder / "rubric_hidden.json", true);
    EXPECT_EQ(hidden.assignment, open.assignment);
    // throws where the sum is not 100, or a test is in both
    const grading::Rubric whole = grading::joined(open, hidden);
    EXPECT_EQ(whole.total(), 100.0) << folder;
    expect_same(named_in(whole), tests_of("judge_" + open.assignment),
                folder + ", public and hidden together", "judge_" + open.assignment);
  }
}

}  // namespace
}  // namespace tumble::testing
