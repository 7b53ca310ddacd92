// The reference solution: a closed form, or two runs finer than all others.
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

#include "framework/core/cpu_time.h"
#include "framework/core/error.h"
#include "framework/core/text.h"
#include "framework/dynamics/world.h"
#include "framework/effects/build_world.h"
#include "framework/engines/base/guarded_laws.h"
#include "framework/engines/base/tolerances.h"
#include "framework/cost/cost.h"
#include "framework/truths/memory_scene.h"
#include "framework/scene/words.h"

namespace tumble::cost {
namespace {

// of the scale: for a worse floor than engines::kSixDigits the duration is shortened
// of the scale: where half the step lowers the floor 16-fold it is lowered to this, because runs
// reach it
constexpr double kFineFloor = 1e-12;
constexpr double kPoorFloor = 1e-4;  // of the scale: still accepted
// two runs that agree to the last bit may both be wrong by some roundings
constexpr double kRoundings = 16.0;
constexpr int kMostHalvings = 7;
constexpr long kFewestSamples = 4, kMostSamples = 24;
constexpr double kStepsASample = 8.0;    // of the scene's own steps
constexpr double kFramesASecond = 60.0;  // rate of frames for judgement by numbers
constexpr double kFinerSteps = 4.0;      // per step of the scene, of the coarser of two fine runs
// the same where steps are free: the finer run has the scene's own
constexpr double kOwnSteps = 0.5;
// of the floor: half the step must lower it at least to this
constexpr double kHelps = 0.7;
// difference of a run with four times the step, relative to one with twice: of first order, C h (4
// - 1) over C h (2 - 1)
constexpr double kOlder = 3.0;
constexpr double kShareLeft = 0.4;  // of the time: kept for a shorter duration
constexpr double kTellEvery = 1.0;  // s of CPU between progress reports
constexpr int kLookEach = 32;       // evaluations between readings of the clock
// of the available time: a run that is expected to take longer is given up
constexpr double kHopeless = 2.0;

bool is_smooth(const scene::Scene& scene) {
  return std::count_if(scene.bodies.begin(), scene.bodies.end(),
                       [](const scene::BodySpec& body) { return body.collides; }) < 2;
}

long samples_of(const scene::Scene& scene, double duration, std::optional<double> frame_rate_hz) {
  if (frame_rate_hz) return std::max(1L, std::lround(std::ceil(duration * *frame_rate_hz - 1e-9)));
  return std::clamp(std::lround(duration / (kStepsASample * scene.step_s)), kFewestSamples,
                    kMostSamples);
}

/// The compared duration, and the CPU time of one run.
struct Window {
  double duration_s;
  long samples;
  double most_s, until;  // of one run; process CPU time at which the search ends
  const std::function<void(const std::string&)>& progress;
};

const std::string kTooLong = "it took too long";

/// Records, reports progress, and ends a run that cannot finish in its time.
class WatchedRecorder final : public TrajectorySink {
 public:
  explicit WatchedRecorder(const Window& window)
      : window_(window),
        begun_(cpu_seconds()),
        until_(std::min(begun_ + window.most_s, window.until)),
        next_(begun_ + kTellEvery) {}
  void begin(const TrajectoryInfo& info, const std::vector<TrajectoryBody>& bodies) override {
    recorder.begin(info, bodies);
  }
  void frame(const Frame& frame) override {
    recorder.frame(frame);
    const double now = cpu_seconds(), spent = now - begun_;
    // contacts at the end of a fall make the rest costlier
    const double expected = frame.time > 0.0 ? spent * window_.duration_s / frame.time : 0.0;
    if (now > until_ || (spent > kTellEvery && expected > kHopeless * (until_ - begun_)))
      throw StoppedRun(kTooLong);
    if (!window_.progress || now < next_) return;
    next_ = now + kTellEvery;
    window_.progress(
        fmt::format("  {:.3g} of {:.3g} s simulated, at most {:.0f} s left for this run",
                    frame.time, window_.duration_s, std::max(0.0, until_ - now)));
  }
  void event(const Event& event) override {
    recorder.event(event);
    if (++events_ % kLookEachEvents == 0 && cpu_seconds() > until_) throw StoppedRun(kTooLong);
  }
  void end(const Counters& counters, const std::string& stopped_by) override {
    recorder.end(counters, stopped_by);
  }
  double until() const { return until_; }
  TrajectoryRecorder recorder;

 private:
  static constexpr int kLookEachEvents = 256;
  const Window& window_;
  double begun_, until_, next_;
  long events_ = 0;
};

struct FinerRun {
  std::vector<Frame> frames;
  std::string stopped_by;
  double cpu_s;
};

/// @param steps  per sample
FinerRun run_finely(const scene::Scene& scene, const Laws& laws, const Window& window, long steps,
                    const engines::RunOptions& how) {
  const truths::SteppedScene stepped =
      truths::in_equal_steps(scene, window.duration_s, window.samples * steps, window.samples);
  engines::RunOptions options = how;
  options.frame_rate_hz = stepped.frame_rate_hz;
  const double begun = cpu_seconds();
  WatchedRecorder watched(window);
  Laws timed = laws;
  timed.integrate_step = [step = laws.integrate_step, until = watched.until(), calls = 0](
                             const OdeFunction& f, double t, const VectorXd& y, double h) mutable {
    // a step may take many evaluations
    const OdeFunction counted = [&](double at, const VectorXd& state) -> VectorXd {
      if (++calls % kLookEach == 0 && cpu_seconds() > until) throw OutOfTime(kTooLong);
      return f(at, state);
    };
    return step(counted, t, y, h);
  };
  std::string stopped_by;
  try {
    engines::run_scene(stepped.scene, timed, options, watched);
  } catch (const StoppedRun& stop) {  // before the engine reports it
    stopped_by = stop.what();
  }
  const Trajectory& run = watched.recorder.trajectory();
  return {run.frames, stopped_by + run.stopped_by, cpu_seconds() - begun};
}

double farthest(const std::vector<Frame>& found, const std::vector<Frame>& expected,
                const std::vector<double>& radii) {
  if (found.size() != expected.size()) return kUnset;
  double most = 0.0;
  for (std::size_t k = 0; k < found.size(); ++k)
    most = std::max(most, distance_between(found[k], expected[k], radii));
  return most;
}

Laws with_method(Laws laws, const std::string& word) {
  const Method& method = method_named(word);
  laws.integrate_step = step_of(method, engines::kSolverRounding);  // below, no method improves
  laws.steps_in_units = needs_units(method);
  return laws;
}

/// Two runs, each valid by itself for as long as it goes.
struct Pair {
  FinerRun run, other{};
  std::string what;
  std::vector<Frame> older{};  // of a third run, with twice the step of `other`; empty: none
};

Pair run_closed(const scene::Scene& scene, const Laws& laws, const Window& window) {
  engines::RunOptions ordered, stepped;
  ordered.engine = "ordered";
  stepped.propagator = "auto";
  return {run_finely(scene, laws, window, 1, ordered), run_finely(scene, laws, window, 4, stepped),
          "closed form (parabola, free rotation by elliptic functions) from one impact to the "
          "next; its error floor is the difference of two engines that use it"};
}

/// Of the coarser of two fine runs. Where nothing happens once per step, the tolerance alone makes
/// them fine.
long steps_a_sample(const scene::Scene& scene, const Window& window) {
  const double finer = steps_are_free(scene) ? kOwnSteps : kFinerSteps;
  return std::max(1L, std::lround(finer * window.duration_s / scene.step_s /
                                  static_cast<double>(window.samples)));
}

std::string two_steps_in_words(long steps, const Window& window) {
  return fmt::format(
      "a run by Fehlberg 7(8) with tolerance {} at steps of {} s; its error floor is the "
      "difference to twice the step",
      few_digits(engines::kSolverRounding),
      step_in_words(window.duration_s / static_cast<double>(steps * window.samples)));
}

Pair run_converged(const scene::Scene& scene, const Laws& laws, const Window& window) {
  const long steps = steps_a_sample(scene, window);
  Pair pair{run_finely(scene, with_method(laws, "fehlberg78"), window, 2 * steps, {}), {}, ""};
  if (!pair.run.stopped_by.empty()) return pair;
  pair.what = two_steps_in_words(2 * steps, window);
  pair.other =
      run_finely(scene, with_method(laws, is_smooth(scene) ? "bulirsch-stoer" : "fehlberg78"),
                 window, steps, {});
  if (is_smooth(scene))
    pair.what = fmt::format(
        "a run by Fehlberg 7(8) with tolerance {}; its error floor is the difference to "
        "Bulirsch-Stoer with twice the step",
        few_digits(engines::kSolverRounding));
  return pair;
}

std::vector<double> radii_of(const scene::Scene& scene) {
  std::vector<double> radii;
  for (const WorldBody& body : build_world(scene).bodies)
    radii.push_back(body.immovable()
                        ? kUnset
                        : std::sqrt(body.inertia.inertia_body.trace() / (2.0 * body.inertia.mass)));
  return radii;
}

/// Keeps the samples up to which the pair agrees within a fraction of the motion. @return whether
/// they are enough
bool take(const Pair& pair, double agreement, const Window& window, CostReference& reference) {
  reference.what = pair.what;
  reference.floor_m = reference.scale_m = 0.0;
  // also for scenes in which only the start moves
  for (const double radius : reference.radii)
    reference.scale_m = radius > reference.scale_m ? radius : reference.scale_m;
  std::size_t agreed = 0;
  double floor = 0.0, scale = reference.scale_m;
  for (std::size_t k = 0; k < std::min(pair.run.frames.size(), pair.other.frames.size()); ++k) {
    scale = std::max(
        scale, distance_between(pair.run.frames[k], pair.run.frames.front(), reference.radii));
    // keeps NaN
    floor = std::max({distance_between(pair.other.frames[k], pair.run.frames[k], reference.radii),
                      floor, kRoundings * std::numeric_limits<double>::epsilon() * scale});
    if (k < pair.older.size())
      floor = std::max(
          floor, distance_between(pair.older[k], pair.run.frames[k], reference.radii) / kOlder);
    if (!(floor <= kPoorFloor * scale)) break;
    if (!(floor <= agreement * scale)) continue;  // a larger motion later may allow it
    agreed = k + 1;
    reference.floor_m = floor;
    reference.scale_m = scale;
  }
  if (agreed <= static_cast<std::size_t>(kFewestSamples)) return false;
  reference.samples.assign(pair.run.frames.begin(),
                           pair.run.frames.begin() + static_cast<std::ptrdiff_t>(agreed));
  reference.intervals = static_cast<long>(agreed) - 1;
  reference.duration_s = window.duration_s * static_cast<double>(reference.intervals) /
                         static_cast<double>(window.samples);
  return true;
}

std::string why_not(const Pair& pair, const CostReference& reference) {
  if (const std::string stopped = pair.run.stopped_by + pair.other.stopped_by; !stopped.empty())
    return stopped;
  return fmt::format(
      "two fine runs of it diverge ({} m apart at the end): errors grow too fast in it, or "
      "rounding decides an impact",
      few_digits(farthest(pair.other.frames, pair.run.frames, reference.radii)));
}

const std::string kNoTruthRemedy =
    "Leave --accuracy and --budget-s out and judge the scene by its numbers, or see what its steps "
    "cost with tumble cost ";

/// Rounded down to two decimals.
double holds_for(const CostReference& reference) {
  return std::floor(100.0 * reference.duration_s) / 100.0;
}

}  // namespace

double distance_between(const Frame& found, const Frame& expected,
                        const std::vector<double>& radii) {
  double most = 0.0;
  for (std::size_t i = 0; i < radii.size(); ++i) {
    if (std::isnan(radii[i])) continue;
    const BodyPose &a = found.poses[i], &b = expected.poses[i];
    const Quaterniond turn = a.world_from_body * b.world_from_body.conjugate();
    const double angle = 2.0 * std::atan2(turn.vec().norm(), std::abs(turn.w()));
    const double distance = (a.com_world - b.com_world).norm() + radii[i] * angle;
    if (!(distance <= most)) most = distance;  // keeps NaN
    if (std::isnan(most)) return most;
  }
  return most;
}

namespace {

bool is_whole(const CostReference& reference, const Window& window) {
  return reference.intervals == window.samples;
}

/// Keeps what the pair gives: a coarse reference for all of the scene is worth more than a fine one
/// for a part.
bool take_either(const Pair& pair, const Window& window, CostReference& reference) {
  CostReference poor = reference;
  const bool is_poor = take(pair, kPoorFloor, window, poor);
  if (take(pair, engines::kSixDigits, window, reference) &&
      (is_whole(reference, window) || !is_whole(poor, window)))
    return true;
  reference = poor;
  return is_poor;
}

/// Where contacts, rods or motors act once per step, the step is the largest error: it is halved as
/// long as that helps and time is left. For contacts that begin, two runs may agree by chance: then
/// a third must agree, if there is time for it; a contradicted reference is discarded.
void refine(const scene::Scene& scene, const Laws& laws, const Window& window, double until,
            Pair pair, bool& found, CostReference& reference) {
  double price = pair.run.cpu_s;
  const bool by_chance = scene.contact.has_value();
  // Between impacts the tolerance alone makes a run fine; the time of an impact depends on the path
  // within a step, whose error is of fourth order in the step. So a reference with impacts can be
  // worse than the runs that it judges; a few halvings correct that.
  const bool pushed_once_a_step =
      by_chance || scene::asks_for(scene, [](const scene::Traits& traits) {
        return traits.looks || traits.constrains;
      });
  const double good_floor = pushed_once_a_step ? engines::kSixDigits : kFineFloor;
  bool confirmed = !by_chance;
  for (long steps = 4 * steps_a_sample(scene, window);; steps *= 2) {
    const bool is_good = confirmed && found && is_whole(reference, window) &&
                         reference.floor_m <= good_floor * reference.scale_m;
    if (is_good || !pair.run.stopped_by.empty() || cpu_seconds() + kGrowth * price > until) return;
    pair.older = std::move(pair.other.frames);
    pair.other = std::move(pair.run);
    pair.run = run_finely(scene, with_method(laws, "fehlberg78"), window, steps, {});
    pair.what = two_steps_in_words(steps, window);
    price = pair.run.cpu_s;
    if (!pair.run.stopped_by.empty()) return;
    CostReference finer = reference;
    confirmed = true;
    if (!take_either(pair, window, finer)) {
      if (found && !by_chance) return;
      found = false;
      continue;
    }
    const bool helps =
        !found || finer.intervals > reference.intervals ||
        (finer.intervals == reference.intervals && finer.floor_m < kHelps * reference.floor_m);
    if (helps || by_chance) reference = finer;
    found = true;
    if (!helps) return;
  }
}

}  // namespace

bool goes_in_closed_form(const scene::Scene& scene) {
  return !scene.contact &&
         !scene::asks_for(scene, [](const scene::Traits& traits) { return !traits.leaves_flight; });
}

std::optional<CostReference> try_reference(const scene::Scene& scene, const Laws& laws,
                                           const CostOptions& options, std::string& why) {
  CostReference reference;
  reference.asked_s = options.duration_s.value_or(scene.duration_s);
  reference.radii = radii_of(scene);
  const bool closed = goes_in_closed_form(scene);
  const double until = cpu_seconds() + options.most_of_search_s;
  double duration = reference.asked_s;
  for (int halving = 0; halving <= kMostHalvings && cpu_seconds() < until &&
                        duration >= options.least_share * reference.asked_s;
       ++halving, duration *= 0.5) {
    const Window window{duration, samples_of(scene, duration, options.frame_rate_hz),
                        options.most_of_reference_s, until, options.progress};
    if (options.progress)
      options.progress(
          fmt::format("the reference solution of {} over {:.3g} s{}", scene.name, duration,
                      closed ? ", in closed form"
                             : fmt::format(": two fine runs, at most {:.0f} s of CPU time",
                                           until - cpu_seconds())));
    Pair pair = closed ? run_closed(scene, laws, window) : run_converged(scene, laws, window);
    const std::string here = why_not(pair, reference);
    bool found = take_either(pair, window, reference);
    if (!closed && !is_smooth(scene))
      refine(scene, laws, window, until - kShareLeft * (until - cpu_seconds()), std::move(pair),
             found, reference);
    if (why.empty()) why = here;
    if (!found || reference.duration_s < options.least_share * reference.asked_s) continue;
    if (reference.duration_s < (1.0 - 1e-9) * reference.asked_s) reference.shortened_by = why;
    return reference;
  }
  return std::nullopt;
}

CostReference find_reference(const scene::Scene& scene, const Laws& laws,
                             const CostOptions& options) {
  std::string why;
  const std::optional<CostReference> reference = try_reference(scene, laws, options, why);
  if (!reference)
    throw UserError(scene.name, "it has no reference solution, not even for a short time: " + why,
                    options.shorten
                        ? "Compare its judged numbers: tumble cost " + scene.name + " does."
                        : kNoTruthRemedy + scene.name + ".");
  if (reference->shortened_by.empty() || options.shorten) return *reference;
  throw UserError(scene.name,
                  fmt::format("this scene has no reference solution for {:.4g} s: {}",
                              reference->asked_s, reference->shortened_by),
                  fmt::format("It holds for {0:.4g} s: request these with --duration-s {0:.4g}; or "
                              "leave --accuracy and --budget-s out and judge the scene by its "
                              "numbers; or see its error with tumble cost {1}.",
                              holds_for(*reference), scene.name));
}

void check_reference(const scene::Scene& scene, const Laws& laws,
                     const std::vector<truths::KnownPosition>& places, const std::string& source,
                     CostReference& reference) {
  const Laws fine = with_method(laws, "fehlberg78");
  std::optional<Frame> frame;
  double off = 0.0;
  int instants = 0;
  for (const truths::KnownPosition& place : places) {
    if (place.time_s > reference.duration_s * (1.0 + 1e-12)) continue;
    if (!frame || frame->time != place.time_s) {
      frame = truths::frame_at(scene, fine, place.time_s);
      frame->time = place.time_s;  // without its rounding
      ++instants;
    }
    off = std::max(off, (frame->poses.at(place.body).com_world - place.com_world).norm());
  }
  if (instants == 0) return;
  reference.floor_m = std::max(reference.floor_m, off);
  reference.what += fmt::format(", or the difference to {} ({} instant{}: {} m)", source, instants,
                                instants == 1 ? "" : "s", few_digits(off));
}

CostReference by_numbers(const scene::Scene& scene, const CostOptions& options,
                         const std::string& why) {
  CostReference reference;
  reference.asked_s = reference.duration_s = options.duration_s.value_or(scene.duration_s);
  reference.intervals = samples_of(scene, reference.duration_s, kFramesASecond);
  reference.by_numbers = true;
  reference.why_by_numbers = why;
  reference.what = "the scene's own numbers";
  reference.floor_m = 0.0;
  reference.scale_m = std::numeric_limits<double>::infinity();
  return reference;
}

}  // namespace tumble::cost
