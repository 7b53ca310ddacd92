/// Grades one submission: compiled and judged in the sandbox, and drawn.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "framework/grading/course/course.h"
#include "framework/grading/grades/grade.h"

namespace tumble::grading {

/// Grades one submission in this process; makes its pictures in `folder` and writes nothing else there.
/// @return never a partial grade: what could not be judged is kGraderFault
/// @throws UserError when the pictures cannot be written
Grade grade_submission(const Course& course, const std::string& id, const Submission& submission, const std::filesystem::path& folder,
                       const GradeOptions& options = {});

/// The points of an earlier run's verdicts under another rubric.
/// @return empty where the rubric names a test that the earlier run has no verdict on: then it must be run again
std::optional<Grade> graded_by(const Rubric& rubric, Grade earlier);

}  // namespace tumble::grading
