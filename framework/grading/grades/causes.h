/// From the tests of a submission to what its author should mend first. Pure functions of data.
#pragma once

#include <string>
#include <vector>

#include "framework/grading/grades/cause.h"
#include "framework/grading/grades/grade.h"
#include "framework/grading/grades/likely_slips.h"
#include "framework/grading/verdicts/own_functions.h"

namespace tumble::grading {

/// Every test without full points belongs to one cause. The one that costs the most points is
/// first; before it only the one that kept tests from running.
/// @param source  text of the submission, to find the functions in; `file` is its name
std::vector<Cause> causes_of(const std::vector<ScoredTest>& tests,
                             const std::vector<AuditedSlip>& known, const std::string& file,
                             const std::string& source);

/// The points that a cause costs.
double points_lost(const Cause& cause, const std::vector<ScoredTest>& tests);

/// A function's lines with their numbers, from the line where it is defined to its last bracket, at
/// most forty.
std::string lines_of_function(const std::string& source, int line);

/// Some lines before and after this one, which has an arrow, with their numbers.
std::string lines_around(const std::string& source, int line);

}  // namespace tumble::grading
