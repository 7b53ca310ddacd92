/// What tumble cost measures of one scene or module, as a page.
#pragma once

#include <string>
#include <vector>

#include "framework/cli/cost_ways.h"
#include "framework/report/cost_page.h"

namespace tumble::cli {

struct MeasuredCost {
  report::CostPage page;
  std::string against;            // what errors are measured against, in a line
  double duration_s, asked_s;     // looked at, and asked for
  std::string size;               // of a scene whose usual size is too large; else empty
  bool not_attempted = false;     // something that is needed is a stub
};

/// Finds the truth, runs every ladder, reads them. Progress goes to stderr.
/// @throws UserError as find_subject, and for a scene with neither a truth nor numbers to be judged by
MeasuredCost measure_cost(const Context& context, const CostWords& words);

/// A file of tests/truths about the same problem tells the truth's error better than two runs of one engine do.
/// @param laws  right ones
void check_with_files(const Context& context, const scene::Scene& scene, const Laws& laws, engines::CostTruth& truth);

/// Which way pays at which error, a sentence each.
std::vector<std::string> verdicts(const report::CostPage& page);

/// The curve that gets to an error for the least price; nullptr where none does.
const report::CostCurve* cheapest_curve(const report::CostPage& page, double mark);

}  // namespace tumble::cli
