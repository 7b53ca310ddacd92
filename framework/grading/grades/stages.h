/// What follows the verdicts of a submission: causes, pictures, costs, its code in its page.
///
/// A grade is made of its verdicts. Where a stage behind them fails, the grade keeps its verdicts
/// and points: a note says what is missing, for the student too, and a fault says why, for the
/// grader alone, because it may name private files. A grade with a fault is made again by the next
/// run.
#pragma once

#include <functional>
#include <string>

#include "framework/grading/grades/grade.h"

namespace tumble::grading {

/// Notes that a stage failed.
/// @param what  is missing: "the pictures"
void note_failed_stage(Grade& grade, const std::string& what, const std::string& why);

/// Runs a stage; an exception of it is noted. @return whether it came to its end
bool run_stage(Grade& grade, const std::string& what, const std::function<void()>& stage);

}  // namespace tumble::grading
