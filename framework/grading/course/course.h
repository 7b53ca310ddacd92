/// Where a course's files and programs lie: what grading needs to know of the tree that it runs in.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "framework/core/files.h"
#include "framework/grading/verdicts/rubric.h"
#include "framework/modules/registry.h"

namespace tumble::grading {

struct Course {
  std::filesystem::path root;    // of the source tree
  std::filesystem::path build;   // of the build tree: programs in bin/, shared objects in modules/
  const modules::Registry* registry = nullptr;
  std::string command;           // as typed, for records
};

/// build/bin/judge_a1. @throws UserError when it is not there: a student's tree has no judge
std::filesystem::path judge_of(const Course& course, const std::string& id);
/// build/modules/a1_WORD.so, which may not exist.
std::filesystem::path built_module(const Course& course, const std::string& id, const std::string& word);
/// Public and hidden items, together 100 points. @throws UserError as read_rubric and joined do
Rubric rubric_of(const Course& course, const std::string& id);
/// The demo scenes of an assignment, by name.
std::vector<std::filesystem::path> scenes_of(const Course& course, const std::string& id);

/// "Suite.Name" of every test that the judge runs, in its order.
/// @throws UserError when the judge does not say: it is half built, or of another time than this program
std::vector<std::string> tests_of_judge(const Course& course, const std::string& id);
/// Every entry of the rubric has a test in the judge, and every test an entry.
/// @throws UserError that names the first that has none, and the nearest name
void require_rubric_of_judge(const Course& course, const std::string& id);

/// Copies of the programs and modules that a grading runs: a build that goes on beside it, or is broken, changes nothing.
class CourseSnapshot {
 public:
  /// @throws UserError when one is not built or cannot be copied
  CourseSnapshot(const Course& course, const std::string& id);
  /// The same course; `build` is the copies'.
  const Course& course() const { return course_; }

 private:
  PrivateFolder folder_;
  Course course_;
};

}  // namespace tumble::grading
