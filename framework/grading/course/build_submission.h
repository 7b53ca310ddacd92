/// Builds a submission's shared object from its source.
#pragma once

#include <filesystem>
#include <string>

#include "framework/grading/course/course.h"

namespace tumble::grading {

struct BuiltSubmission {
  enum class Outcome { kBuilt, kRefused, kGraderFault };
  Outcome outcome = Outcome::kGraderFault;
  std::string said;   // the compiler's errors; or why it could not run
};

/// Compiles in the sandbox, where only headers of the project are visible.
/// @param object  written where the outcome is kBuilt
BuiltSubmission build_submission(const Course& course, const std::string& id, const std::filesystem::path& source, const std::filesystem::path& object);

/// The header of an assignment's module.
std::filesystem::path module_header(const Course& course, const std::string& id);

}  // namespace tumble::grading
