/// Verdicts in a terminal.
#pragma once

#include <cstddef>
#include <iosfwd>
#include <string>
#include <vector>

#include "framework/grading/verdicts/rubric.h"
#include "framework/grading/verdicts/verdict.h"

namespace tumble::grading {

struct TableWords {
  bool colours = false;
  // A line for each test; else one for each group of tests, where they are more than a few.
  bool all = false;
  std::size_t columns = 80;  // lines are broken at them, at spaces
  std::string source = "";   // text of the submission; may be empty
};

/// For text written to the descriptor: colours where its terminal has them, and its width where
/// that can be read.
TableWords table_words_for(int descriptor);

/// Prints a table of the tests; then the stories, as in in_order_of_mending(); then a count. Where
/// the source of the submission is known, stories have the lines in which functions begin, and what
/// to mend first stands behind them (mend_order.h).
/// @param rubric  gives titles, levels and points; may be empty
void print_verdicts(std::ostream& out, const std::vector<TestResult>& results, const Rubric& rubric,
                    const TableWords& words);

}  // namespace tumble::grading
