// What runs are compared with: a closed form, or two runs that are finer than all others.
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

#include "framework/core/cpu_time.h"
#include "framework/core/error.h"
#include "framework/dynamics/world.h"
#include "framework/engines/cost/cost.h"
#include "framework/engines/truths/memory_scene.h"

namespace tumble::engines {
namespace {

constexpr double kTight = 1e-13;          // tolerance of the truth: a hundred roundings, below which no method gets better
constexpr double kGoodFloor = 1e-6;       // of the scale: a truth worse than this is looked for over half the time
constexpr double kRoundings = 16.0;       // two runs that agree to the last bit may both be off by some
constexpr int kMostHalvings = 7;
constexpr long kFewestSamples = 4, kMostSamples = 24;
constexpr double kStepsASample = 8.0;     // of the scene's own steps

bool is_smooth(const scene::Scene& scene) {
  return std::count_if(scene.bodies.begin(), scene.bodies.end(), [](const scene::BodySpec& body) { return body.collides; }) < 2;
}

long samples_of(const scene::Scene& scene, double duration, std::optional<double> frame_rate_hz) {
  if (frame_rate_hz) return std::max(1L, std::lround(std::ceil(duration * *frame_rate_hz - 1e-9)));
  return std::clamp(std::lround(duration / (kStepsASample * scene.step_s)), kFewestSamples, kMostSamples);
}

/// What is looked at, and how much CPU time a run of it may take.
struct Window {
  double duration_s;
  long samples;
  double most_s;
};

struct FinerRun {
  std::vector<Frame> frames;
  std::string stopped_by;
};

/// @param steps  per sample
FinerRun run_finely(const scene::Scene& scene, const Laws& laws, const Window& window, long steps, const RunOptions& how) {
  const truths::SteppedScene stepped = truths::in_equal_steps(scene, window.duration_s, window.samples * steps, window.samples);
  RunOptions options = how;
  options.frame_rate_hz = stepped.frame_rate_hz;
  Laws timed = laws;
  timed.integrate_step = [step = laws.integrate_step, until = cpu_seconds() + window.most_s](const OdeFunction& f, double t, const VectorXd& y, double h) {
    if (cpu_seconds() > until) throw std::runtime_error("it took too long");
    return step(f, t, y, h);
  };
  TrajectoryRecorder recorder;
  run_scene(stepped.scene, timed, options, recorder);
  return {recorder.trajectory().frames, recorder.trajectory().stopped_by};
}

double farthest(const std::vector<Frame>& found, const std::vector<Frame>& expected, const std::vector<double>& radii) {
  if (found.size() != expected.size()) return kUnset;
  double most = 0.0;
  for (std::size_t k = 0; k < found.size(); ++k) most = std::max(most, distance_between(found[k], expected[k], radii));
  return most;
}

/// How far bodies get from where they were.
double scale_of(const std::vector<Frame>& frames, const std::vector<double>& radii) {
  double most = 0.0;
  for (const Frame& frame : frames) most = std::max(most, distance_between(frame, frames.front(), radii));
  return most;
}

Laws with_method(Laws laws, const std::string& word) {
  laws.integrate_step = step_of(method_named(word), kTight);
  return laws;
}

/// Two runs of which each is right, as far as it goes, by itself.
struct Pair {
  FinerRun run, other;
  std::string what;
};

bool knows_closed_forms(const scene::Scene& scene, const Laws& laws) {
  RunOptions options;
  options.engine = "ordered";
  options.duration_s = 1e-9 * scene.step_s;
  TrajectoryRecorder recorder;
  try {
    run_scene(scene, laws, options, recorder);
  } catch (const UserError&) {
    return false;   // it names what it cannot follow
  }
  return true;
}

Pair run_closed(const scene::Scene& scene, const Laws& laws, const Window& window) {
  RunOptions ordered, stepped;
  ordered.engine = "ordered";
  stepped.propagator = "auto";
  return {run_finely(scene, laws, window, 1, ordered), run_finely(scene, laws, window, 4, stepped),
          "closed form (parabola, free rotation by elliptic functions) from one impact to the next; its floor is what two engines that use it differ by"};
}

Pair run_converged(const scene::Scene& scene, const Laws& laws, const Window& window) {
  const long steps = std::max(1L, std::lround(4.0 * window.duration_s / scene.step_s / static_cast<double>(window.samples)));
  Pair pair{run_finely(scene, with_method(laws, "fehlberg78"), window, 2 * steps, {}), {}, ""};
  if (is_smooth(scene) && pair.run.stopped_by.empty()) {
    pair.other = run_finely(scene, with_method(laws, "bulirsch-stoer"), window, steps, {});
    pair.what = fmt::format("a run by Fehlberg 7(8) with tolerance {:.0e}; its floor is what Bulirsch-Stoer with twice the step differs by", kTight);
  } else if (pair.run.stopped_by.empty()) {
    pair.other = run_finely(scene, with_method(laws, "fehlberg78"), window, steps, {});
    pair.what = fmt::format("a run by Fehlberg 7(8) with tolerance {:.0e} at steps of 1/{:.0f} s; its floor is what twice the step differs by", kTight, 2.0 * static_cast<double>(steps * window.samples) / window.duration_s);
  }
  return pair;
}

std::vector<double> radii_of(const scene::Scene& scene) {
  std::vector<double> radii;
  for (const WorldBody& body : build_world(scene).bodies) radii.push_back(body.immovable() ? kUnset : std::sqrt(body.inertia.inertia_body.trace() / (2.0 * body.inertia.mass)));
  return radii;
}

/// Takes the pair's samples and floor. @return why these are no truth; empty where they are
std::string judge_pair(const Pair& pair, CostTruth& truth) {
  if (const std::string why = pair.run.stopped_by + pair.other.stopped_by; !why.empty()) return why;
  truth.what = pair.what;
  truth.samples = pair.run.frames;
  truth.scale_m = scale_of(truth.samples, truth.radii);
  for (const double radius : truth.radii) truth.scale_m = radius > truth.scale_m ? radius : truth.scale_m;   // of what only rests
  truth.floor_m = farthest(pair.other.frames, pair.run.frames, truth.radii);
  truth.floor_m = std::max(truth.floor_m, kRoundings * std::numeric_limits<double>::epsilon() * truth.scale_m);   // NaN stays
  if (truth.floor_m <= kGoodFloor * truth.scale_m) return "";
  return fmt::format("two fine runs of it differ by {:.1e} m where bodies move or measure {:.1e} m: errors grow too fast in it, or an impact hangs on the last digit", truth.floor_m, truth.scale_m);
}

std::string refused_remedy(const scene::Scene& scene, double duration_s) {
  return fmt::format("It holds for {0:.4g} s: ask for these with --duration-s {0:.4g}; or leave --accuracy and --budget-s out and judge the scene by its numbers; or see how its error goes with tumble cost {1}.", duration_s, scene.name);
}

}  // namespace

double distance_between(const Frame& found, const Frame& expected, const std::vector<double>& radii) {
  double most = 0.0;
  for (std::size_t i = 0; i < radii.size(); ++i) {
    if (std::isnan(radii[i])) continue;
    const BodyPose &a = found.poses[i], &b = expected.poses[i];
    const Quaterniond turn = a.world_from_body * b.world_from_body.conjugate();
    const double angle = 2.0 * std::atan2(turn.vec().norm(), std::abs(turn.w()));
    const double distance = (a.com_world - b.com_world).norm() + radii[i] * angle;
    if (!(distance <= most)) most = distance;   // NaN stays
    if (std::isnan(most)) return most;
  }
  return most;
}

CostTruth find_truth(const scene::Scene& scene, const Laws& laws, const CostOptions& options) {
  CostTruth truth;
  truth.asked_s = truth.duration_s = options.duration_s.value_or(scene.duration_s);
  truth.radii = radii_of(scene);
  const bool closed = knows_closed_forms(scene, laws);
  std::string why;
  for (int halving = 0; halving <= kMostHalvings; ++halving, truth.duration_s *= 0.5) {
    const Window window{truth.duration_s, samples_of(scene, truth.duration_s, options.frame_rate_hz), options.most_of_truth_s};
    if (options.told) options.told(fmt::format("looking for the truth of {} over {:.3g} s{}", scene.name, truth.duration_s, closed ? ", in closed form" : fmt::format(" (two fine runs, at most {:.0f} s of CPU time each)", window.most_s)));
    const Pair pair = closed ? run_closed(scene, laws, window) : run_converged(scene, laws, window);
    if (std::string here = judge_pair(pair, truth); !here.empty()) {
      if (why.empty()) why = here;
      continue;
    }
    if (halving > 0 && !options.shorten) throw UserError(scene.name, fmt::format("there is no truth for {:.4g} s of this scene: {}", truth.asked_s, why), refused_remedy(scene, truth.duration_s));
    return truth;
  }
  throw UserError(scene.name, fmt::format("no truth to compare with, even over {:.2g} s: {}", 2.0 * truth.duration_s, why), "Give a shorter --duration-s, or a scene in which less happens at once.");
}

}  // namespace tumble::engines
