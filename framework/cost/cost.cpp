#include "framework/cost/cost.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>

#include <fmt/format.h>

#include "framework/core/cpu_time.h"
#include "framework/core/error.h"
#include "framework/core/not_implemented.h"
#include "framework/core/text.h"
#include "framework/engines/base/guarded_laws.h"
#include "framework/engines/judging/judge.h"
#include "framework/truths/memory_scene.h"
#include "framework/scene/words.h"

namespace tumble::cost {
namespace {

constexpr double kNoise = 0.02;     // of the set-up time: its variation from run to run
constexpr double kCoarsest = 16.0;  // of the scene's own step: the coarsest step
// of the scene's own: after so long rods and joints are projected, whatever the integration does
// between
constexpr double kLinkedSteps = 32.0;
// A run that costs less than kLeastGrowth times the one before shows that steps are not the cost:
constexpr double kWorthSkipping = 0.5;  // s: where it costs as much as this
constexpr long kSkip = 8;               // the next run has this many times its steps
constexpr long kMostSteps = 1L << 24;   // per sample
constexpr int kMostResolutions = 14;
constexpr double kNearFloor = 3.0;  // of the error floor: finer runs show nothing
// of the scale: below it, errors that no longer decrease are round-off
constexpr double kGood = 1e-3;
// times the evaluations of the run before, where steps are halved: twice as many but for those that
// have been shortened anyway
constexpr double kMoreWork = 1.5;
constexpr int kMostWorse = 2;  // runs in a row that are no better than the best
// the same where contacts act once per step, or what acts begins within one that is shortened for
// it: that instant within a step is practically random
constexpr int kMostWorseInSteps = 4;

std::string too_long(double most_s) {
  return fmt::format("it would take more than {:.0f} s", most_s);
}

/// Records a run and its CPU time; ends a run that takes too long, with or without integration.
class Measurement final : public TrajectorySink {
 public:
  explicit Measurement(double most_s) : most_s_(most_s) {}
  void begin(const TrajectoryInfo& info, const std::vector<TrajectoryBody>& bodies) override {
    recorder_.begin(info, bodies);
    start_ = first_frame_ = cpu_seconds();
  }
  void frame(const Frame& frame) override {
    const double now = cpu_seconds();
    if (frames_++ == 0) first_frame_ = now;
    recorder_.frame(frame);
    if (now - start_ > most_s_) throw StoppedRun(too_long(most_s_));
  }
  void event(const Event& event) override {
    recorder_.event(event);
    if (++events_ % kLookEach == 0 && cpu_seconds() - start_ > most_s_)
      throw StoppedRun(too_long(most_s_));
  }
  void end(const Counters& counters, const std::string& stopped_by) override {
    cpu_s = cpu_seconds() - start_;
    building_s = first_frame_ - start_;
    recorder_.end(counters, stopped_by);
  }
  const Trajectory& run() const { return recorder_.trajectory(); }
  double cpu_s = 0.0, building_s = 0.0;  // total; up to the first frame

 private:
  static constexpr int kLookEach = 256;
  TrajectoryRecorder recorder_;
  double most_s_, start_ = 0.0, first_frame_ = 0.0;
  long frames_ = 0, events_ = 0;
};

bool has_control(const scene::Scene& scene) {
  return scene::asks_for(scene, [](const scene::Traits& traits) { return traits.looks; });
}

bool links_meet(const scene::Scene& scene) {
  const bool linked =
      scene::asks_for(scene, [](const scene::Traits& traits) { return traits.ties; });
  return linked && std::count_if(scene.bodies.begin(), scene.bodies.end(),
                                 [](const scene::BodySpec& body) { return body.collides; }) > 1;
}

double energy_of(const Frame& frame) { return frame.kinetic_energy + frame.potential_energy; }

void compare(const std::vector<Frame>& frames, const CostReference& reference, CostResult& result) {
  double scale = 0.0, lowest = reference.samples.front().potential_energy;
  for (const Frame& frame : reference.samples) {
    lowest = std::min(lowest, frame.potential_energy);
    scale = std::max(scale, frame.kinetic_energy + frame.potential_energy - lowest);
  }
  result.error_m = frames.size() < reference.samples.size() ? kUnset : 0.0;
  for (std::size_t k = 0; k < std::min(frames.size(), reference.samples.size()); ++k) {
    const double distance = distance_between(frames[k], reference.samples[k], reference.radii);
    if (!(distance <= result.error_m))
      result.error_m = std::isnan(result.error_m) ? kUnset : distance;
    result.times.push_back(reference.samples[k].time);
    result.energy_errors.push_back(
        std::abs(energy_of(frames[k]) - energy_of(reference.samples[k])) /
        (scale > 0.0 ? scale : 1.0));
  }
}

/// A run that is shorter than the scene is judged only by checks that apply until its end.
scene::Scene judged_part(scene::Scene scene, const CostReference& reference) {
  if (reference.duration_s < scene.duration_s)
    std::erase_if(scene.checks,
                  [](const scene::CheckSpec& check) { return !check.expected.empty(); });
  return scene;
}

/// The worst of the scene's numbers, relative to its tolerance.
void judge(const scene::Scene& scene, const Trajectory& run, CostResult& result) {
  result.error_m = 0.0;
  for (const engines::CheckResult& check : engines::judge_run(scene, run)) {
    double share = check.at_least ? check.threshold / check.value : check.value / check.threshold;
    // no tolerance at all
    if (check.threshold == 0.0)
      share = check.passed ? 0.0 : std::numeric_limits<double>::infinity();
    if (!check.passed && !(share > 1.0)) share = std::numeric_limits<double>::infinity();
    if (share <= result.error_m) continue;
    result.error_m = share;
    const std::string unit = check.unit.empty() ? "" : ' ' + check.unit;
    result.worst =
        fmt::format("{}{}: {}{}, allowed at {} {}{}", check.kind,
                    check.subject == "all" ? "" : " of " + check.subject, three_digits(check.value),
                    unit, check.at_least ? "least" : "most", three_digits(check.threshold), unit);
  }
  double scale = 0.0, lowest = std::numeric_limits<double>::infinity();
  for (const Frame& frame : run.frames) {
    lowest = std::min(lowest, frame.potential_energy);
    scale = std::max(scale, energy_of(frame) - lowest);
  }
  for (const Frame& frame : run.frames) {
    result.times.push_back(frame.time);
    result.energy_errors.push_back(std::abs(energy_of(frame) - energy_of(run.frames.front())) /
                                   (scale > 0.0 ? scale : 1.0));
  }
}

engines::RunOptions options_of(const CostMethod& method, const CostOptions& options,
                               double frame_rate_hz) {
  engines::RunOptions how;
  how.engine = method.engine;
  if (method.engine == "rd") how.propagator = method.propagator;
  how.timewarp = options.timewarp;
  how.frame_rate_hz = frame_rate_hz;
  return how;
}

/// Stops a run that takes too long. It reads the clock rarely, so that this costs nothing; also
/// within a step where the method chooses its substeps.
StepFunction until_too_long(const StepFunction& step, double most_s, bool controlled) {
  constexpr int kEach = 64;
  const auto calls = std::make_shared<int>(0);
  const auto look = [until = cpu_seconds() + most_s, most_s, calls] {
    if (++*calls % kEach == 0 && cpu_seconds() > until) throw OutOfTime(too_long(most_s));
  };
  if (!controlled)
    return [step, look](const OdeFunction& f, double t, const VectorXd& y, double h) {
      look();
      return step(f, t, y, h);
    };
  return [step, look](const OdeFunction& f, double t, const VectorXd& y, double h) {
    const OdeFunction watched = [&](double at, const VectorXd& state) -> VectorXd {
      look();
      return f(at, state);
    };
    return step(watched, t, y, h);
  };
}

std::uint64_t count_of(const Counters& counters, const std::string& name) {
  const auto found = counters.counts.find(name);
  return found == counters.counts.end() ? 0 : found->second;
}

/// CPU time of models and shapes. Engines with steps record their first frame just before the first
/// step; the others, as soon as they can.
double before_first_step(const scene::Scene& stepped, const Laws& laws, engines::RunOptions how,
                         const Measurement& run) {
  if (how.engine == "rd") return run.building_s;
  how.duration_s = 1e-9 * stepped.step_s;
  Measurement built(std::numeric_limits<double>::infinity());
  engines::run_scene(stepped, laws, how, built);
  return built.cpu_s;
}

}  // namespace

CostRun run_of(const scene::Scene& scene, const CostMethod& method, const CostReference& reference,
               long steps, double tolerance, const CostOptions& options) {
  truths::SteppedScene stepped = truths::in_equal_steps(
      scene, reference.duration_s, reference.intervals * steps, reference.intervals);
  CostRun run{std::move(stepped.scene), method.laws,
              options_of(method, options, stepped.frame_rate_hz)};
  if (method.stabilisation) run.scene.stabilisation = method.stabilisation;
  if (method.coordinates) run.scene.coordinates = *method.coordinates;
  if (method.step_function) {
    run.laws.integrate_step = method.step_function(tolerance);
    run.laws.steps_in_units = method.steps_in_units;
  }
  if (method.tuned) method.tuned(tolerance, run.laws);
  if (std::isfinite(options.most_of_run_s))
    run.laws.integrate_step =
        until_too_long(run.laws.integrate_step, options.most_of_run_s, method.controlled);
  return run;
}

CostResult run_at_resolution(const scene::Scene& scene, const CostMethod& method,
                             const CostReference& reference, long steps, double tolerance,
                             const CostOptions& options) {
  const auto [stepped, laws, how] = run_of(scene, method, reference, steps, tolerance, options);
  CostResult result;
  result.step_s = method.has_refinement ? stepped.step_s : kUnset;
  if (method.controlled) result.tolerance = tolerance;
  double building = std::numeric_limits<double>::infinity(), whole = building;
  const double begun = cpu_seconds();
  try {
    // The fastest of several short runs; the first one gives error and counters.
    for (int k = 0; k < options.runs && (k == 0 || cpu_seconds() - begun < kShort); ++k) {
      Measurement run(options.most_of_run_s);
      engines::run_scene(stepped, laws, how, run);
      building = std::min(building, before_first_step(stepped, laws, how, run));
      whole = std::min(whole, run.cpu_s);
      if (k > 0) continue;
      result.stopped_by = run.run().stopped_by;
      result.stage_seconds = run.run().counters.stage_seconds;
      result.evaluations = count_of(run.run().counters, method.counted);
      result.has_shortened_steps = count_of(run.run().counters, "shortened_steps") > 0;
      if (reference.by_numbers)
        judge(judged_part(scene, reference), run.run(), result);
      else
        compare(run.run().frames, reference, result);
      // its exact cost is irrelevant
      if (!result.stopped_by.empty() || result.error_m > kAnswer * reference.scale_m) break;
    }
  } catch (const UserError& error) {
    result.stopped_by = error.what();
  } catch (const StoppedRun& stop) {  // before the engine reports it
    result.stopped_by = stop.what();
  } catch (const NotImplemented& missing) {
    result.stopped_by = missing.function() + " is not written yet";
    result.not_attempted = true;
  }
  result.spent_s = cpu_seconds() - begun;
  result.took_too_long =
      result.stopped_by.find(too_long(options.most_of_run_s)) != std::string::npos;
  // CPU time without the set-up before the first step.
  if (!std::isfinite(whole)) return result;  // it did not finish
  result.cpu_s = std::max(1e-6, whole - building);
  // the difference of two long times is noise: the clocks of the stages are more exact
  if (result.cpu_s < kNoise * building) {
    double stages = 0.0;
    for (const auto& [stage, seconds] : result.stage_seconds) stages += seconds;
    result.cpu_s = std::max(result.cpu_s, std::min(stages, whole));
  }
  result.building_s = building;
  return result;
}

long first_steps(const scene::Scene& scene, const CostReference& reference) {
  const double interval = reference.duration_s / static_cast<double>(reference.intervals);
  return std::max(1L, std::lround(interval / (kCoarsest * scene.step_s)));
}

bool steps_are_free(const scene::Scene& scene) {
  return !has_control(scene) && !scene.contact && !links_meet(scene);
}

long outer_steps(const scene::Scene& scene, const CostReference& reference) {
  // Motors are sampled between steps, and persistent contacts act once per step: there the step is
  // part of the scene. Rods and joints stay within the tolerance during a step, and are projected
  // at its end.
  const double interval = reference.duration_s / static_cast<double>(reference.intervals);
  if (has_control(scene) || scene.contact)
    return std::max(1L, std::lround(interval / (2.0 * scene.step_s)));
  // a constraint error that grows over a long step causes forces that no tolerance can correct
  const bool linked = scene::is_constrained(scene);
  return linked ? std::max(1L, std::lround(interval / (kLinkedSteps * scene.step_s))) : 1;
}

namespace {

/// 10^-this is the first tolerance. Rods react at once to any error: with looser tolerances a run
/// diverges, slowly.
int first_decade(const scene::Scene& scene) { return scene::is_constrained(scene) ? 4 : 1; }

std::size_t most_resolutions(const scene::Scene& scene, const CostMethod& method,
                             const std::vector<double>& asked) {
  if (!method.has_refinement) return 1;
  return !asked.empty() ? asked.size()
                        : static_cast<std::size_t>(
                              kMostResolutions - (method.controlled ? first_decade(scene) - 1 : 0));
}

/// Twice as many as in the last run; more where these would cost next to nothing.
long finer_steps(const std::vector<CostResult>& results, double interval) {
  const auto last = std::lround(interval / results.back().step_s);
  const bool skips = results.size() > 1 && results.back().stopped_by.empty() &&
                     results.back().spent_s > kWorthSkipping &&
                     results.back().spent_s < kLeastGrowth * results[results.size() - 2].spent_s;
  return std::min((skips ? kSkip : 2L) * last, kMostSteps);
}

/// Steps per sample of the next run.
long steps_of(const scene::Scene& scene, const CostMethod& method, const CostReference& reference,
              const RefinementWords& words, const std::vector<CostResult>& results) {
  const double interval = reference.duration_s / static_cast<double>(reference.intervals);
  // Motors are sampled and contacts act once per step, and linked bodies that collide follow an
  // interpolated path between the ends of steps: there the step is reduced with the tolerance,
  // except where something other than the integration is varied.
  if ((method.controlled && (method.tuned || steps_are_free(scene))) || !method.has_refinement)
    return outer_steps(scene, reference);
  if (!words.steps_s.empty() && !method.controlled)
    return std::max(1L, std::lround(interval / words.steps_s[results.size()]));
  return results.empty() ? first_steps(scene, reference) : finer_steps(results, interval);
}

}  // namespace

bool refinement_is_done(const scene::Scene& scene, const CostMethod& method,
                        const CostReference& reference, const std::vector<CostResult>& results,
                        const RefinementWords& words) {
  if (results.empty()) return false;
  const std::vector<double>& asked = method.controlled ? words.tolerances : words.steps_s;
  if (results.size() >= most_resolutions(scene, method, asked) || results.back().not_attempted)
    return true;
  if (!asked.empty()) return false;
  double least = std::numeric_limits<double>::infinity();
  int worse = 0;
  for (std::size_t k = 0; k < results.size(); ++k) {
    // a tolerance without effect, or a step that was shortened in the run before to nearly this one
    const bool is_new =
        k == 0 ||
        (method.controlled ? results[k].evaluations > results[k - 1].evaluations
                           : !results[k - 1].has_shortened_steps ||
                                 static_cast<double>(results[k].evaluations) >
                                     kMoreWork * static_cast<double>(results[k - 1].evaluations));
    worse = results[k].error_m < least ? 0 : worse + (is_new ? 1 : 0);
    least = std::min(least, std::isfinite(results[k].error_m) ? results[k].error_m : least);
  }
  const bool is_by_chance =
      scene.contact || std::any_of(results.begin(), results.end(), [](const CostResult& result) {
        return result.has_shortened_steps;
      });
  const int most_worse = is_by_chance ? kMostWorseInSteps : kMostWorse;
  return results.back().error_m <= kNearFloor * reference.floor_m ||
         (worse >= most_worse && least < kGood * reference.scale_m);
}

double next_price(const std::vector<CostResult>& results) {
  if (results.empty()) return 0.0;
  const double last = results.back().spent_s, most = kGrowth * last;
  if (results.size() < 2 || results.back().took_too_long ||
      results[results.size() - 2].took_too_long)
    return most;
  // part of the cost may be the same at any step
  return std::clamp(last + kGrowth * (last - results[results.size() - 2].spent_s),
                    kLeastGrowth * last, most);
}

void extend_refinement(const scene::Scene& scene, const CostMethod& method,
                       const CostReference& reference, double budget_s, const CostOptions& options,
                       const RefinementWords& words, std::vector<CostResult>& results,
                       const std::function<void(const CostResult&)>& progress) {
  const double until = cpu_seconds() + budget_s;
  const bool is_asked = !(method.controlled ? words.tolerances : words.steps_s).empty();
  if (!results.empty() && results.back().took_too_long) {
    if (options.most_of_run_s < next_price(results)) return;
    results.pop_back();
  }
  while (!refinement_is_done(scene, method, reference, results, words)) {
    const std::size_t k = results.size();
    const double tolerance = !method.controlled ? kUnset
                             : words.tolerances.empty()
                                 ? std::pow(10.0, -first_decade(scene) - static_cast<double>(k))
                                 : words.tolerances[k];
    results.push_back(run_at_resolution(scene, method, reference,
                                        steps_of(scene, method, reference, words, results),
                                        tolerance, options));
    progress(results.back());
    if (results.back().took_too_long) return;
    if (!is_asked && cpu_seconds() + next_price(results) > until) return;
  }
}

std::vector<CostResult> run_refinement(const scene::Scene& scene, const CostMethod& method,
                                       const CostReference& reference, double budget_s,
                                       const CostOptions& options,
                                       const std::vector<double>& steps_s,
                                       const std::vector<double>& tolerances,
                                       const std::function<void(const CostResult&)>& progress) {
  std::vector<CostResult> results;
  extend_refinement(scene, method, reference, budget_s, options, {steps_s, tolerances}, results,
                    progress);
  return results;
}

}  // namespace tumble::cost
