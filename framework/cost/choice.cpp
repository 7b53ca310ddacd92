// Refines each method until it fulfils the goal or cannot improve on what another has reached.
#include "framework/cost/choice.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "framework/core/cpu_time.h"

namespace tumble::cost {
namespace {

constexpr int kMostChoiceHalvings = 14;  // 1 to 16384 steps per frame
constexpr int kMostTolerances = 13;      // 0.1 to 1e-13
// of the requested error: leaves room for the next term where a power law is extrapolated
constexpr double kAim = 0.7;
// runs between a resolution that fails and the next one, which passes
constexpr int kMostTrims = 3;
constexpr double kWorthTrimming = 0.9;  // of the cost: a smaller saving is not worth a search
// times the best cost: a method that has not fulfilled the goal by then is given up
constexpr double kHopelessPrice = 3.0;
constexpr int kMostWorseTrials = 2;  // runs in a row without improvement

bool is_right(const CostResult& result) {
  return result.stopped_by.empty() && std::isfinite(result.error_m);
}

class Search {
 public:
  Search(const scene::Scene& scene, const CostReference& reference, const CostGoal& goal,
         double most_s, const CostOptions& options,
         const std::function<void(const CostChoice&)>& progress)
      : scene_(scene),
        reference_(reference),
        goal_(goal),
        until_(cpu_seconds() + most_s),
        options_(options),
        progress_(progress) {}

  void refine(const CostMethod& method);
  CostChoices found;

 private:
  CostChoice tried(const CostMethod& method, long steps, double tolerance);
  void trim(CostChoice fails, CostChoice passes);
  bool fulfils(const CostResult& result) const {
    return is_right(result) &&
           (goal_.error_m ? result.error_m <= *goal_.error_m : result.cpu_s <= *goal_.price_s);
  }
  bool better(const CostResult& a, const CostResult& b) const;
  double best_price() const {
    return found.best ? found.best->result.cpu_s
                      : goal_.price_s.value_or(std::numeric_limits<double>::infinity());
  }

  const scene::Scene& scene_;
  const CostReference& reference_;
  const CostGoal goal_;
  const double until_;
  const CostOptions& options_;
  const std::function<void(const CostChoice&)>& progress_;
};

bool Search::better(const CostResult& a, const CostResult& b) const {
  if (goal_.error_m) return a.cpu_s < b.cpu_s;
  // below the error floor no run is better
  const double error_a = std::max(a.error_m, reference_.floor_m),
               error_b = std::max(b.error_m, reference_.floor_m);
  return error_a * kAlikeErrors < error_b ||
         (error_a < error_b * kAlikeErrors && a.cpu_s < b.cpu_s);
}

CostChoice Search::tried(const CostMethod& method, long steps, double tolerance) {
  CostChoice choice{method, steps, tolerance,
                    run_at_resolution(scene_, method, reference_, steps, tolerance, options_)};
  progress_(choice);
  if (!is_right(choice.result)) return choice;
  const bool closer =
      !found.closest || (goal_.error_m ? choice.result.error_m < found.closest->result.error_m
                                       : choice.result.cpu_s < found.closest->result.cpu_s);
  if (closer) found.closest = choice;
  if (fulfils(choice.result) && (!found.best || better(choice.result, found.best->result)))
    found.best = choice;
  return choice;
}

// Between two resolutions the error follows a power of the step, or of the tolerance: the coarsest
// resolution that passes lies there.
void Search::trim(CostChoice fails, CostChoice passes) {
  const double asked = *goal_.error_m;
  const bool by_tolerance = passes.steps == fails.steps;
  for (int k = 0; k < kMostTrims && cpu_seconds() < until_; ++k) {
    const double span = std::log(fails.result.error_m / passes.result.error_m);
    if (!(span > 0.0) || !is_right(fails.result) ||
        passes.result.cpu_s > best_price() * kHopelessPrice)
      return;
    // of the interval from fails to passes
    const double part =
        std::clamp(std::log(fails.result.error_m / (kAim * asked)) / span, 0.1, 1.0);
    const auto between = [part](double from, double to) {
      return from * std::pow(to / from, part);
    };
    const long steps = by_tolerance
                           ? passes.steps
                           : std::lround(std::ceil(between(static_cast<double>(fails.steps),
                                                           static_cast<double>(passes.steps))));
    const double tolerance =
        std::isfinite(passes.tolerance) ? between(fails.tolerance, passes.tolerance) : kUnset;
    if (by_tolerance
            ? part > 0.95
            : static_cast<double>(steps) > kWorthTrimming * static_cast<double>(passes.steps))
      return;
    CostChoice middle = tried(passes.method, steps, tolerance);
    if (!is_right(middle.result)) return;
    if (fulfils(middle.result)) return;
    fails = middle;
  }
}

void Search::refine(const CostMethod& method) {
  if (cpu_seconds() > until_) {
    found.was_cut_short = true;
    return;
  }
  const bool steps_shrink =
      method.has_refinement && (!method.controlled || !steps_are_free(scene_));
  const int most = !method.has_refinement ? 1
                   : method.controlled    ? kMostTolerances
                                          : kMostChoiceHalvings;
  std::optional<CostChoice> before;
  double least = std::numeric_limits<double>::infinity();
  int worse = 0;
  // Halves the step, or divides the tolerance by ten, until one of the conditions below ends it.
  for (int k = 0; k < most; ++k) {
    const CostChoice now = tried(method, steps_shrink ? 1L << k : 1L,
                                 method.controlled ? std::pow(10.0, -1.0 - k) : kUnset);
    found.was_cut_short = found.was_cut_short || cpu_seconds() > until_;
    if (now.result.not_attempted || cpu_seconds() > until_) return;
    // The goal is reached: look between the last two resolutions for a cheaper run.
    if (goal_.error_m && fulfils(now.result)) {
      if (before) trim(*before, now);
      return;
    }
    // No improvement is possible: the error floor, the cost of the best method, or a better run.
    // the error floor is reached
    if (is_right(now.result) && now.result.error_m <= reference_.floor_m) return;
    if (is_right(now.result) &&
        now.result.cpu_s > (goal_.error_m ? kHopelessPrice * best_price() : *goal_.price_s))
      return;
    if (goal_.price_s && found.best && found.best->result.error_m <= reference_.floor_m &&
        now.result.cpu_s > found.best->result.cpu_s)
      return;
    // Errors that no longer decrease.
    // a tolerance without effect
    const bool is_new = !before || now.result.evaluations > before->result.evaluations;
    const bool falls = now.result.error_m * kAlikeErrors < least;
    worse = falls ? 0 : worse + (is_right(now.result) && is_new ? 1 : 0);
    // round-off dominates, or it is another motion
    if (worse >= kMostWorseTrials && least < kAnswer * reference_.scale_m) return;
    if (is_right(now.result)) least = std::min(least, now.result.error_m);
    before = now;
  }
}

}  // namespace

CostChoices choose_method(const scene::Scene& scene, const std::vector<CostMethod>& methods,
                          const CostReference& reference, const CostGoal& goal, double most_s,
                          const CostOptions& options,
                          const std::function<void(const CostChoice&)>& progress) {
  Search search(scene, reference, goal, most_s, options, progress);
  for (const CostMethod& method : methods) search.refine(method);
  return search.found;
}

}  // namespace tumble::cost
