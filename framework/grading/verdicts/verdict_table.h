/// Verdicts in a terminal.
#pragma once

#include <iosfwd>
#include <map>
#include <string>
#include <vector>

#include "framework/grading/verdicts/rubric.h"
#include "framework/grading/verdicts/verdict.h"

namespace tumble::grading {

/// Prints a table with one line per test, grouped by level; then the stories; then a count.
/// Where the source of the submission is known, stories have the lines in which functions begin,
/// and what to mend first stands behind them (mend_order.h).
/// @param rubric  gives titles, levels and points; may be empty
/// @param source  text of the submission; may be empty
void print_verdicts(std::ostream& out, const std::vector<TestResult>& results, const Rubric& rubric,
                    bool colours, const std::string& source = "");

}  // namespace tumble::grading
