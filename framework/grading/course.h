/// Where a course's files and programs lie: what grading needs to know of the tree that it runs in.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "framework/grading/rubric.h"
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

/// 16 hex digits that differ where the bytes do. For noticing change, not against forgery: nothing is gained by a collision,
/// since a record is compared with that of the same submission's own past.
std::string digest(std::string_view bytes);
/// Of a file's bytes; of "missing" where it cannot be read.
std::string digest_of_file(const std::filesystem::path& file);

}  // namespace tumble::grading
