/// Verdicts for a person at a terminal.
#pragma once

#include <iosfwd>
#include <map>
#include <string>
#include <vector>

#include "framework/grading/verdicts/rubric.h"
#include "framework/grading/verdicts/verdict.h"

namespace tumble::grading {

/// A table with a line a test, grouped by level; then the story of each test that needs one; then a count.
/// @param rubric  gives titles, levels and points; may be empty
void print_verdicts(std::ostream& out, const std::vector<TestResult>& results, const Rubric& rubric, bool colours);

}  // namespace tumble::grading
