/// What accuracy costs with a submission's own methods, for its page: error against steps and against force evaluations, beside the
/// reference, and a sentence that reads each curve.
///
/// Prices are counts, never seconds, so that the same submission gives the same bytes. No points hang on any of it.
#pragma once

#include <string>
#include <vector>

#include "framework/report/html.h"

namespace tumble::grading {

struct CostLine {
  std::string reading;                  // the sentence
  bool is_right = false;                // it does what its method promises
  bool is_attempted = true;
  bool is_wasteful = false;             // right, and dearer than it need be
};

struct CostSection {
  std::string scene;                    // its title; empty: nothing is measured of this module
  std::string truth;                    // what errors are measured against, and what an error is
  std::vector<CostLine> lines;          // of the submission
  std::vector<report::Plot> plots;
  std::vector<report::Table> tables;
};

struct CostSectionOptions {
  double call_wall_s = 3.0;             // a call that takes longer has hung: it ends its own curve
  double session_wall_s = 60.0;         // of all calls of one curve; right ones take seconds at most on an idle machine
};

}  // namespace tumble::grading
