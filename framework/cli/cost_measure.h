/// The measurements of tumble cost for one scene or module, as a page.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "framework/cli/cost_methods.h"
#include "framework/report/cost_page.h"

namespace tumble::cli {

struct MeasuredCost {
  report::CostPage page;
  std::string against;         // the reference of errors, in one line
  double duration_s, asked_s;  // compared duration, and requested duration
  std::string size;            // of a scene whose usual size is too large; else empty
  bool not_attempted = false;  // a required function is a stub
};

/// What is measured so far, where `all` methods are to be; the others are named as not run.
using CostSoFar =
    std::function<void(const MeasuredCost& so_far, std::size_t done, std::size_t all)>;

/// Computes the reference, runs every refinement, and reads them. Progress goes to stderr.
/// @param each  called whenever a method was measured farther; its time is nobody's budget
/// @throws UserError as find_subject, and for a scene with neither a reference solution nor numbers
///   of its own
MeasuredCost measure_cost(const Context& context, const CostWords& words,
                          const CostSoFar& each = {});

/// A file of tests/truths for the same problem gives a better error floor than two runs of one
/// engine.
/// @param laws  right ones
void check_with_files(const Context& context, const scene::Scene& scene, const Laws& laws,
                      cost::CostReference& reference);

/// "tolerance 1e-4", all in one style and not broken between lines.
std::string tolerance_in_words(double tolerance);

/// The cheapest method for each error, one sentence each.
std::vector<std::string> verdicts(const report::CostPage& page);

/// What joint coordinates change, in a sentence: the smallest error that is reached both with rows
/// and without, and what it costs; empty where a page does not have both.
std::string coordinates_compared(const report::CostPage& page);

/// The curve that reaches an error at the least cost; nullptr where none does.
const report::CostCurve* cheapest_curve(const report::CostPage& page, double mark);

}  // namespace tumble::cli
