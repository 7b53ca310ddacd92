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
/// @param rubric  gives titles, levels and points; may be empty
void print_verdicts(std::ostream& out, const std::vector<TestResult>& results, const Rubric& rubric,
                    bool colours);

}  // namespace tumble::grading
