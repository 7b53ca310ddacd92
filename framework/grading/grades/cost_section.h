/// The cost of accuracy with a submission's methods, for its page: error against steps and against
/// force evaluations, compared with the reference, and a sentence that interprets each curve.
///
/// Costs are counts, never seconds, so that the same submission gives the same bytes. It earns no
/// points.
#pragma once

#include <string>
#include <vector>

#include "framework/report/html.h"

namespace tumble::grading {

struct CostLine {
  std::string reading;    // the sentence
  bool is_right = false;  // the method has its nominal order and accuracy
  bool is_attempted = true;
  bool is_wasteful = false;  // right, but costlier than necessary
  std::string more = {};  // of what ended it: the arguments of its last call, which fill a screen
};

/// What is to be read in a line, of a text whose first line says it.
CostLine line_that_says(const std::string& text);

struct CostSection {
  std::string scene;            // its title; empty: this module is not measured
  std::string truth;            // the reference solution, and the definition of the error
  std::vector<CostLine> lines;  // of the submission
  std::vector<report::Plot> plots;
  std::vector<report::Table> tables;
};

struct CostSectionOptions {
  double call_wall_s = 3.0;  // a longer call counts as hung: it ends its own curve
  // of all calls of one curve; right calls take at most seconds on an idle machine
  double session_wall_s = 60.0;
};

}  // namespace tumble::grading
