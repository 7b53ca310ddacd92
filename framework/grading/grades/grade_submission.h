/// Grades one submission: compiles and judges it in the sandbox, and draws its scenes.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "framework/grading/course/course.h"
#include "framework/grading/grades/grade.h"

namespace tumble::grading {

/// Grades one submission in this process; writes its pictures, and nothing else, into `folder`.
/// @param judged  called once with the verdicts and points, before the stages behind them
/// @return never a partial grade: if judging fails, its state is kGraderFault; what a stage behind
///   the verdicts fails at is missing, and noted (stages.h)
Grade grade_submission(const Course& course, const std::string& id, const Submission& submission,
                       const std::filesystem::path& folder, const GradeOptions& options = {},
                       const std::function<void(const Grade&)>& judged = {});

/// The points of an earlier run's verdicts under another rubric.
/// @return empty if the rubric has a test without a verdict in the earlier run: then it must be run
///   again
std::optional<Grade> graded_by(const Rubric& rubric, Grade earlier);

}  // namespace tumble::grading
