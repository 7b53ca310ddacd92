#include "framework/engines/cost/cost.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>

#include <fmt/format.h>

#include "framework/core/cpu_time.h"
#include "framework/core/error.h"
#include "framework/core/not_implemented.h"
#include "framework/engines/base/guarded_laws.h"
#include "framework/engines/judging/judge.h"
#include "framework/engines/truths/memory_scene.h"
#include "framework/scene/words.h"

namespace tumble::engines {
namespace {

constexpr double kShort = 0.1;            // s: after so long runs are not repeated
constexpr double kNoise = 0.02;           // of what comes before the first step: by so much its time differs from run to run
constexpr double kCoarsest = 16.0;        // of the scene's own step: where a ladder begins
constexpr double kLinkedSteps = 32.0;     // of the scene's own: after so long rods and joints are brought back, whatever method goes on between
constexpr double kSamePrice = 1.2;        // a rung that costs no more than so many times the one before shows that steps are not what costs:
constexpr double kWorthSkipping = 0.5;    // s: where it costs as much as this
constexpr long kSkip = 8;                 // the next one has so many times its steps
constexpr long kMostSteps = 1L << 24;      // a sample
constexpr int kMostRungs = 14;
constexpr double kNearFloor = 3.0;        // of the truth's floor: finer runs show nothing
constexpr double kNoAnswer = 0.1;         // of the scale: a run with a larger error is on the way to others
constexpr double kGood = 1e-3;            // of the scale: below it, errors that do not fall are round-off
constexpr int kMostWorse = 2;             // rungs in a row that are no better than the best
constexpr int kMostWorseInSteps = 4;      // the same where contacts push once a step: when something lands within a step is as good as drawn by lot
constexpr double kGrowth = 2.2;           // price of a rung over the one before, as expected
constexpr double kLeastGrowth = 1.2;      // the same where most of it does not come from steps

std::string too_long(double most_s) { return fmt::format("it would take more than {:.0f} s", most_s); }

/// The run and its clock; ends a run that takes too long, whether or not it integrates.
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
    if (++events_ % kLookEach == 0 && cpu_seconds() - start_ > most_s_) throw StoppedRun(too_long(most_s_));
  }
  void end(const Counters& counters, const std::string& stopped_by) override {
    cpu_s = cpu_seconds() - start_;
    building_s = first_frame_ - start_;
    recorder_.end(counters, stopped_by);
  }
  const Trajectory& run() const { return recorder_.trajectory(); }
  double cpu_s = 0.0, building_s = 0.0;   // all of it; up to the first frame

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
  const bool linked = scene::asks_for(scene, [](const scene::Traits& traits) { return traits.ties; });
  return linked && std::count_if(scene.bodies.begin(), scene.bodies.end(), [](const scene::BodySpec& body) { return body.collides; }) > 1;
}

double energy_of(const Frame& frame) { return frame.kinetic_energy + frame.potential_energy; }

void compare(const std::vector<Frame>& frames, const CostTruth& truth, CostRung& rung) {
  double scale = 0.0, lowest = truth.samples.front().potential_energy;
  for (const Frame& frame : truth.samples) {
    lowest = std::min(lowest, frame.potential_energy);
    scale = std::max(scale, frame.kinetic_energy + frame.potential_energy - lowest);
  }
  rung.error_m = frames.size() < truth.samples.size() ? kUnset : 0.0;
  for (std::size_t k = 0; k < std::min(frames.size(), truth.samples.size()); ++k) {
    const double distance = distance_between(frames[k], truth.samples[k], truth.radii);
    if (!(distance <= rung.error_m)) rung.error_m = std::isnan(rung.error_m) ? kUnset : distance;
    rung.times.push_back(truth.samples[k].time);
    rung.energy_errors.push_back(std::abs(energy_of(frames[k]) - energy_of(truth.samples[k])) / (scale > 0.0 ? scale : 1.0));
  }
}

/// A run that is shorter than the scene is not judged by what it cannot have reached.
scene::Scene judged_part(scene::Scene scene, const CostTruth& truth) {
  if (truth.duration_s < scene.duration_s) std::erase_if(scene.checks, [](const scene::CheckSpec& check) { return !check.expected.empty(); });
  return scene;
}

/// The worst of the scene's numbers, over what each is allowed.
void judge(const scene::Scene& scene, const Trajectory& run, CostRung& rung) {
  rung.error_m = 0.0;
  for (const CheckResult& check : judge_run(scene, run)) {
    double share = check.at_least ? check.threshold / check.value : check.value / check.threshold;
    if (check.threshold == 0.0) share = check.passed ? 0.0 : std::numeric_limits<double>::infinity();   // nothing at all is allowed
    if (!check.passed && !(share > 1.0)) share = std::numeric_limits<double>::infinity();
    if (share <= rung.error_m) continue;
    rung.error_m = share;
    rung.worst = fmt::format("{} of {}: {:.3g} {}{:.3g} {}", check.kind, check.subject, check.value, check.at_least ? ">= " : "<= ", check.threshold, check.unit);
  }
  double scale = 0.0, lowest = std::numeric_limits<double>::infinity();
  for (const Frame& frame : run.frames) {
    lowest = std::min(lowest, frame.potential_energy);
    scale = std::max(scale, energy_of(frame) - lowest);
  }
  for (const Frame& frame : run.frames) {
    rung.times.push_back(frame.time);
    rung.energy_errors.push_back(std::abs(energy_of(frame) - energy_of(run.frames.front())) / (scale > 0.0 ? scale : 1.0));
  }
}

RunOptions options_of(const CostWay& way, const CostOptions& options, double frame_rate_hz) {
  RunOptions how;
  how.engine = way.engine;
  if (way.engine == "rd") how.propagator = way.propagator;
  how.timewarp = options.timewarp;
  how.frame_rate_hz = frame_rate_hz;
  return how;
}

/// Stops a run that takes too long. The clock is looked at rarely enough to cost nothing; within a step too where the method chooses its parts.
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

/// What models and shapes cost. Engines that step show their first frame just before the first step; the others show it when they can.
double before_first_step(const scene::Scene& stepped, const Laws& laws, RunOptions how, const Measurement& run) {
  if (how.engine == "rd") return run.building_s;
  how.duration_s = 1e-9 * stepped.step_s;
  Measurement built(std::numeric_limits<double>::infinity());
  run_scene(stepped, laws, how, built);
  return built.cpu_s;
}

}  // namespace

CostRun run_of(const scene::Scene& scene, const CostWay& way, const CostTruth& truth, long steps, double tolerance, const CostOptions& options) {
  truths::SteppedScene stepped = truths::in_equal_steps(scene, truth.duration_s, truth.intervals * steps, truth.intervals);
  CostRun run{std::move(stepped.scene), way.laws, options_of(way, options, stepped.frame_rate_hz)};
  if (way.stabilisation) run.scene.stabilisation = way.stabilisation;
  if (way.method) run.laws.integrate_step = way.method(tolerance);
  if (way.tuned) way.tuned(tolerance, run.laws);
  if (std::isfinite(options.most_of_rung_s)) run.laws.integrate_step = until_too_long(run.laws.integrate_step, options.most_of_rung_s, way.controlled);
  return run;
}

CostRung run_rung(const scene::Scene& scene, const CostWay& way, const CostTruth& truth, long steps, double tolerance, const CostOptions& options) {
  const auto [stepped, laws, how] = run_of(scene, way, truth, steps, tolerance, options);
  CostRung rung;
  rung.step_s = way.has_ladder ? stepped.step_s : kUnset;
  if (way.controlled) rung.tolerance = tolerance;
  double building = std::numeric_limits<double>::infinity(), whole = building;
  const double begun = cpu_seconds();
  try {
    for (int k = 0; k < options.runs && (k == 0 || cpu_seconds() - begun < kShort); ++k) {
      Measurement run(options.most_of_rung_s);
      run_scene(stepped, laws, how, run);
      building = std::min(building, before_first_step(stepped, laws, how, run));
      whole = std::min(whole, run.cpu_s);
      if (k > 0) continue;
      rung.stopped_by = run.run().stopped_by;
      rung.stage_seconds = run.run().counters.stage_seconds;
      rung.evaluations = count_of(run.run().counters, way.counted);
      if (truth.by_numbers) judge(judged_part(scene, truth), run.run(), rung);
      else compare(run.run().frames, truth, rung);
      if (!rung.stopped_by.empty() || rung.error_m > kNoAnswer * truth.scale_m) break;   // what such a run costs need not be known well
    }
  } catch (const UserError& error) {
    rung.stopped_by = error.what();
  } catch (const StoppedRun& stop) {   // before the engine looks for it
    rung.stopped_by = stop.what();
  } catch (const NotImplemented& missing) {
    rung.stopped_by = missing.function() + " is not written yet";
    rung.not_attempted = true;
  }
  rung.spent_s = cpu_seconds() - begun;
  rung.took_too_long = rung.stopped_by.find(too_long(options.most_of_rung_s)) != std::string::npos;
  if (!std::isfinite(whole)) return rung;   // it never came to an end
  rung.cpu_s = std::max(1e-6, whole - building);
  if (rung.cpu_s < kNoise * building) {   // the difference of two long times is noise: the stages' own clocks know better
    double stages = 0.0;
    for (const auto& [stage, seconds] : rung.stage_seconds) stages += seconds;
    rung.cpu_s = std::max(rung.cpu_s, std::min(stages, whole));
  }
  rung.building_s = building;
  return rung;
}

long first_steps(const scene::Scene& scene, const CostTruth& truth) {
  const double interval = truth.duration_s / static_cast<double>(truth.intervals);
  return std::max(1L, std::lround(interval / (kCoarsest * scene.step_s)));
}

bool steps_are_free(const scene::Scene& scene) { return !has_control(scene) && !scene.contact && !links_meet(scene); }

long outer_steps(const scene::Scene& scene, const CostTruth& truth) {
  // Motors look between steps, and lasting contacts push once a step: there the step is part of the scene. Rods and joints are held to
  // the tolerance within a step, and brought back at its end.
  const double interval = truth.duration_s / static_cast<double>(truth.intervals);
  if (has_control(scene) || scene.contact) return std::max(1L, std::lround(interval / (2.0 * scene.step_s)));
  const bool linked = scene::is_constrained(scene);   // what drifts apart for long pulls so hard that no tolerance helps
  return linked ? std::max(1L, std::lround(interval / (kLinkedSteps * scene.step_s))) : 1;
}

namespace {

/// 10^-this is the first tolerance. Rods pull at once at whatever is out of place: by looser ones a run blows up, slowly.
int first_decade(const scene::Scene& scene) { return scene::is_constrained(scene) ? 4 : 1; }

std::size_t most_rungs(const scene::Scene& scene, const CostWay& way, const std::vector<double>& asked) {
  if (!way.has_ladder) return 1;
  return !asked.empty() ? asked.size() : static_cast<std::size_t>(kMostRungs - (way.controlled ? first_decade(scene) - 1 : 0));
}

/// Twice as many as in the last rung; more where these would cost next to nothing.
long finer_steps(const std::vector<CostRung>& rungs, double interval) {
  const auto last = std::lround(interval / rungs.back().step_s);
  const bool skips = rungs.size() > 1 && rungs.back().stopped_by.empty() && rungs.back().spent_s > kWorthSkipping && rungs.back().spent_s < kSamePrice * rungs[rungs.size() - 2].spent_s;
  return std::min((skips ? kSkip : 2L) * last, kMostSteps);
}

/// Steps per sample of the next rung.
long steps_of(const scene::Scene& scene, const CostWay& way, const CostTruth& truth, const LadderWords& words, const std::vector<CostRung>& rungs) {
  const double interval = truth.duration_s / static_cast<double>(truth.intervals);
  // Motors look and contacts push once a step, and bodies that hang on others and meet something go along a curve through their steps'
  // ends: there steps shrink with the tolerance, but where something else than the integration is looked at.
  if ((way.controlled && (way.tuned || steps_are_free(scene))) || !way.has_ladder) return outer_steps(scene, truth);
  if (!words.steps_s.empty() && !way.controlled) return std::max(1L, std::lround(interval / words.steps_s[rungs.size()]));
  return rungs.empty() ? first_steps(scene, truth) : finer_steps(rungs, interval);
}

}  // namespace

bool ladder_is_done(const scene::Scene& scene, const CostWay& way, const CostTruth& truth, const std::vector<CostRung>& rungs, const LadderWords& words) {
  if (rungs.empty()) return false;
  const std::vector<double>& asked = way.controlled ? words.tolerances : words.steps_s;
  if (rungs.size() >= most_rungs(scene, way, asked) || rungs.back().not_attempted) return true;
  if (!asked.empty()) return false;
  double least = std::numeric_limits<double>::infinity();
  int worse = 0;
  for (std::size_t k = 0; k < rungs.size(); ++k) {
    const bool is_new = k == 0 || !way.controlled || rungs[k].evaluations > rungs[k - 1].evaluations;   // a tolerance that changes nothing tells nothing
    worse = rungs[k].error_m < least ? 0 : worse + (is_new ? 1 : 0);
    least = std::min(least, std::isfinite(rungs[k].error_m) ? rungs[k].error_m : least);
  }
  const int most_worse = scene.contact ? kMostWorseInSteps : kMostWorse;
  return rungs.back().error_m <= kNearFloor * truth.floor_m || (worse >= most_worse && least < kGood * truth.scale_m);
}

double next_price(const std::vector<CostRung>& rungs) {
  if (rungs.empty()) return 0.0;
  const double last = rungs.back().spent_s, most = kGrowth * last;
  if (rungs.size() < 2 || rungs.back().took_too_long || rungs[rungs.size() - 2].took_too_long) return most;
  return std::clamp(last + kGrowth * (last - rungs[rungs.size() - 2].spent_s), kLeastGrowth * last, most);   // some of the price may be the same at any step
}

void extend_ladder(const scene::Scene& scene, const CostWay& way, const CostTruth& truth, double budget_s, const CostOptions& options, const LadderWords& words, std::vector<CostRung>& rungs,
                   const std::function<void(const CostRung&)>& told) {
  const double until = cpu_seconds() + budget_s;
  const bool is_asked = !(way.controlled ? words.tolerances : words.steps_s).empty();
  if (!rungs.empty() && rungs.back().took_too_long) {
    if (options.most_of_rung_s < next_price(rungs)) return;
    rungs.pop_back();
  }
  while (!ladder_is_done(scene, way, truth, rungs, words)) {
    const std::size_t k = rungs.size();
    const double tolerance = !way.controlled ? kUnset : words.tolerances.empty() ? std::pow(10.0, -first_decade(scene) - static_cast<double>(k)) : words.tolerances[k];
    rungs.push_back(run_rung(scene, way, truth, steps_of(scene, way, truth, words, rungs), tolerance, options));
    told(rungs.back());
    if (rungs.back().took_too_long) return;
    if (!is_asked && cpu_seconds() + next_price(rungs) > until) return;
  }
}

std::vector<CostRung> run_ladder(const scene::Scene& scene, const CostWay& way, const CostTruth& truth, double budget_s, const CostOptions& options, const std::vector<double>& steps_s,
                                 const std::vector<double>& tolerances, const std::function<void(const CostRung&)>& told) {
  std::vector<CostRung> rungs;
  extend_ladder(scene, way, truth, budget_s, options, {steps_s, tolerances}, rungs, told);
  return rungs;
}

}  // namespace tumble::engines
