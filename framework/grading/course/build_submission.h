/// Builds a submission's shared object from its source, in a course.
#pragma once

#include <filesystem>
#include <string>

#include "framework/grading/compiler/build_module.h"
#include "framework/grading/course/course.h"

namespace tumble::grading {

/// See build_module.
BuiltSubmission build_submission(const Course& course, const std::string& id,
                                 const std::filesystem::path& source,
                                 const std::filesystem::path& object);

/// The header of an assignment's module.
std::filesystem::path module_header(const Course& course, const std::string& id);

}  // namespace tumble::grading
