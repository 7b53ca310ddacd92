/// From a submission's source to a shared object.
#pragma once

#include <filesystem>
#include <string>

#include "framework/grading/course/course.h"

namespace tumble::grading {

struct BuiltSubmission {
  enum class Outcome { kBuilt, kRefused, kGraderFault };
  Outcome outcome = Outcome::kGraderFault;
  std::string said;   // the compiler's words, cut short; or why it could not be asked
};

/// Compiles in the sandbox, where nothing of the project but headers can be seen.
/// @param object  written where the outcome is kBuilt
BuiltSubmission build_submission(const Course& course, const std::string& id, const std::filesystem::path& source, const std::filesystem::path& object);

/// The header that says what the module of an assignment is.
std::filesystem::path module_header(const Course& course, const std::string& id);

}  // namespace tumble::grading
