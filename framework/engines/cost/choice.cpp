// Each way is refined until it fulfils the wish or cannot beat what another way reached already.
#include "framework/engines/cost/choice.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "framework/core/cpu_time.h"

namespace tumble::engines {
namespace {

constexpr int kMostChoiceHalvings = 14;        // 1 to 16384 steps a frame
constexpr int kMostTolerances = 13;      // 0.1 to 1e-13
constexpr double kAim = 0.7;             // of the error asked for: where a power law is expected to lead, its next term still fits in
constexpr int kMostTrims = 3;            // trials between a rung that fails and the next one, which passes
constexpr double kWorthTrimming = 0.9;   // of the price: what saves less is not looked for
constexpr double kHopelessPrice = 3.0;        // prices: above this of the best one a way that does not yet fulfil the wish is given up
constexpr int kMostWorseTrials = 2;            // trials in a row that are no better
constexpr double kAlikeErrors = 1.05;          // errors that differ by less are one: the cheaper run is better

bool is_right(const CostRung& rung) { return rung.stopped_by.empty() && std::isfinite(rung.error_m); }

class Search {
 public:
  Search(const scene::Scene& scene, const CostTruth& truth, const CostWish& wish, double most_s, const CostOptions& options, const std::function<void(const CostChoice&)>& told)
      : scene_(scene), truth_(truth), wish_(wish), until_(cpu_seconds() + most_s), options_(options), told_(told) {}

  void refine(const CostWay& way);
  CostChoices found;

 private:
  CostChoice tried(const CostWay& way, long steps, double tolerance);
  void trim(CostChoice fails, CostChoice passes);
  bool fulfils(const CostRung& rung) const { return is_right(rung) && (wish_.error_m ? rung.error_m <= *wish_.error_m : rung.cpu_s <= *wish_.price_s); }
  bool better(const CostRung& a, const CostRung& b) const;
  double best_price() const { return found.best ? found.best->rung.cpu_s : wish_.price_s.value_or(std::numeric_limits<double>::infinity()); }

  const scene::Scene& scene_;
  const CostTruth& truth_;
  const CostWish wish_;
  const double until_;
  const CostOptions& options_;
  const std::function<void(const CostChoice&)>& told_;
};

bool Search::better(const CostRung& a, const CostRung& b) const {
  if (wish_.error_m) return a.cpu_s < b.cpu_s;
  const double error_a = std::max(a.error_m, truth_.floor_m), error_b = std::max(b.error_m, truth_.floor_m);   // below it, none is better
  return error_a * kAlikeErrors < error_b || (error_a < error_b * kAlikeErrors && a.cpu_s < b.cpu_s);
}

CostChoice Search::tried(const CostWay& way, long steps, double tolerance) {
  CostChoice choice{way, steps, tolerance, run_rung(scene_, way, truth_, steps, tolerance, options_)};
  told_(choice);
  if (!is_right(choice.rung)) return choice;
  const bool closer = !found.closest || (wish_.error_m ? choice.rung.error_m < found.closest->rung.error_m : choice.rung.cpu_s < found.closest->rung.cpu_s);
  if (closer) found.closest = choice;
  if (fulfils(choice.rung) && (!found.best || better(choice.rung, found.best->rung))) found.best = choice;
  return choice;
}

// Between two rungs the error goes as a power of the step, or of the tolerance: there lies what is just good enough.
void Search::trim(CostChoice fails, CostChoice passes) {
  const double asked = *wish_.error_m;
  const bool by_tolerance = passes.steps == fails.steps;
  for (int k = 0; k < kMostTrims && cpu_seconds() < until_; ++k) {
    const double span = std::log(fails.rung.error_m / passes.rung.error_m);
    if (!(span > 0.0) || !is_right(fails.rung) || passes.rung.cpu_s > best_price() * kHopelessPrice) return;
    const double part = std::clamp(std::log(fails.rung.error_m / (kAim * asked)) / span, 0.1, 1.0);   // of the way from fails to passes
    const auto between = [part](double from, double to) { return from * std::pow(to / from, part); };
    const long steps = by_tolerance ? passes.steps : std::lround(std::ceil(between(static_cast<double>(fails.steps), static_cast<double>(passes.steps))));
    const double tolerance = std::isfinite(passes.tolerance) ? between(fails.tolerance, passes.tolerance) : kUnset;
    if (by_tolerance ? part > 0.95 : static_cast<double>(steps) > kWorthTrimming * static_cast<double>(passes.steps)) return;
    CostChoice middle = tried(passes.way, steps, tolerance);
    if (!is_right(middle.rung)) return;
    if (fulfils(middle.rung)) return;
    fails = middle;
  }
}

void Search::refine(const CostWay& way) {
  if (cpu_seconds() > until_) {
    found.was_cut_short = true;
    return;
  }
  const bool steps_shrink = way.has_ladder && (!way.controlled || !steps_are_free(scene_));
  const int most = !way.has_ladder ? 1 : way.controlled ? kMostTolerances : kMostChoiceHalvings;
  std::optional<CostChoice> before;
  double least = std::numeric_limits<double>::infinity();
  int worse = 0;
  for (int k = 0; k < most; ++k) {
    const CostChoice now = tried(way, steps_shrink ? 1L << k : 1L, way.controlled ? std::pow(10.0, -1.0 - k) : kUnset);
    found.was_cut_short = found.was_cut_short || cpu_seconds() > until_;
    if (now.rung.not_attempted || cpu_seconds() > until_) return;
    if (wish_.error_m && fulfils(now.rung)) {
      if (before) trim(*before, now);
      return;
    }
    if (is_right(now.rung) && now.rung.error_m <= truth_.floor_m) return;   // no truth tells better
    if (is_right(now.rung) && now.rung.cpu_s > (wish_.error_m ? kHopelessPrice * best_price() : *wish_.price_s)) return;
    if (wish_.price_s && found.best && found.best->rung.error_m <= truth_.floor_m && now.rung.cpu_s > found.best->rung.cpu_s) return;
    const bool is_new = !before || now.rung.evaluations > before->rung.evaluations;   // a tolerance that changes nothing tells nothing
    const bool falls = now.rung.error_m * kAlikeErrors < least;
    worse = falls ? 0 : worse + (is_right(now.rung) && is_new ? 1 : 0);
    if (worse >= kMostWorseTrials && least < kAnswer * truth_.scale_m) return;    // round-off has taken over, or it is another motion
    if (is_right(now.rung)) least = std::min(least, now.rung.error_m);
    before = now;
  }
}

}  // namespace

CostChoices choose_way(const scene::Scene& scene, const std::vector<CostWay>& ways, const CostTruth& truth, const CostWish& wish, double most_s, const CostOptions& options,
                       const std::function<void(const CostChoice&)>& told) {
  Search search(scene, truth, wish, most_s, options, told);
  for (const CostWay& way : ways) search.refine(way);
  return search.found;
}

}  // namespace tumble::engines
