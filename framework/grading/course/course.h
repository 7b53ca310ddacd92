/// The files and programs of the course's tree that grading needs.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "framework/core/files.h"
#include "framework/grading/verdicts/rubric.h"
#include "framework/modules/registry.h"

namespace tumble::grading {

struct Course {
  std::filesystem::path root;   // of the source tree
  std::filesystem::path build;  // of the build tree: programs in bin/, shared objects in modules/
  const modules::Registry* registry = nullptr;
  std::string command;  // as typed, for records
  // the public tests alone, by the program that students have, too
  bool public_only = false;
  // the build tree that `build` was copied from: what is made once and kept; empty: `build`
  std::filesystem::path kept = {};
};

/// build/bin/judge_a1; check_a1_sandboxed, which has the same words, for the public tests alone.
/// @throws UserError when it is missing: a student's tree has no judge
std::filesystem::path judge_of(const Course& course, const std::string& id);
/// build/modules/a1_WORD.so, which may not exist.
std::filesystem::path built_module(const Course& course, const std::string& id,
                                   const std::string& word);
/// Public and hidden items, together 100 points; or the public ones.
/// @throws UserError as read_rubric and joined
Rubric rubric_of(const Course& course, const std::string& id);
/// The demo scenes of an assignment, by name.
std::vector<std::filesystem::path> scenes_of(const Course& course, const std::string& id);

/// "Suite.Name" of every test that the judge runs, in its order.
/// @throws UserError when the judge does not list them: it is incomplete, or older or newer than
///   this program
std::vector<std::string> tests_of_judge(const Course& course, const std::string& id);
/// Checks that every entry of the rubric has a test in the judge, and every test an entry.
/// @throws UserError with the first one without a counterpart, and the nearest name
void require_rubric_of_judge(const Course& course, const std::string& id);

/// Copies of the programs and modules that a grading runs, so that a concurrent or failed build
/// does not affect it.
class CourseSnapshot {
 public:
  /// @throws UserError when one is not built or cannot be copied
  CourseSnapshot(const Course& course, const std::string& id);
  /// The same course with `build` set to the copies.
  const Course& course() const { return course_; }

 private:
  PrivateFolder folder_;
  Course course_;
};

}  // namespace tumble::grading
