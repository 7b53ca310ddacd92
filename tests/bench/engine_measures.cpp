#include "tests/bench/engine_measures.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>

#include "framework/core/error.h"
#include "framework/effects/joint/joint.h"
#include "framework/effects/rod/rod.h"
#include "framework/engines/base/run_counters.h"
#include "framework/engines/run.h"
#include "framework/engines/timewarp/fast_timewarp.h"
#include "framework/scene/sized_scenes.h"
#include "tests/engines/reference_laws.h"

namespace tumble::testing {
namespace {

constexpr double kShort = 1.0;  // [s]: longer runs are not repeated
constexpr int kShortRuns = 5;   // at least, and
// until this much time is spent [s]: for runs of milliseconds an undisturbed one comes late
constexpr double kLongEnough = 0.3;
constexpr int kMostRuns = 200;
constexpr double kNothing = 1e-9;   // [s], simulated
constexpr double kOneFrame = 1e-3;  // [1/s]

double seconds_by(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// Springs, rods and contacts need a3.
const Laws& laws_for(const scene::Scene& scene) {
  static const Laws plain = test_laws();
  if (!scene.contact && scene.effects.of<effects::JointSpec>().empty() &&
      scene.effects.of<effects::RodSpec>().empty())
    return plain;
  static const Laws reference = reference_laws();
  return reference;
}

struct Once {
  double seconds, cpu;
  Tally tally;
};

Once run_once(const scene::Scene& scene, const std::string& engine, double duration, Clock by) {
  engines::RunOptions options;
  options.engine = engine == "rd_auto" ? "rd" : engine.starts_with("tw") ? "tw" : engine;
  options.threads =
      engine.size() > 2 && engine.starts_with("tw") ? std::atoi(engine.c_str() + 2) : 1;
  options.propagator = engine == "rd_auto" ? "auto" : "";
  options.timewarp = engines::fast_timewarp();
  options.duration_s = duration;
  options.frame_rate_hz = kOneFrame;
  // the former has a coarse resolution after samples were taken
  const clockid_t of_cpu = options.threads > 1 ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_THREAD_CPUTIME_ID;
  const clockid_t clock = by == Clock::kWall ? CLOCK_MONOTONIC : of_cpu;
  Once once;
  const double begin = seconds_by(clock), cpu_begin = seconds_by(of_cpu);
  engines::run_scene(scene, laws_for(scene), options, once.tally);
  once.seconds = seconds_by(clock) - begin;
  once.cpu = seconds_by(of_cpu) - cpu_begin;
  if (!once.tally.stopped_by.empty())
    std::printf("    stopped: %s\n", once.tally.stopped_by.c_str());
  return once;
}

// Other programs on the machine must not count.
Once best_of(const scene::Scene& scene, const std::string& engine, double duration, Clock clock,
             StackSamples& samples) {
  // While samples are taken, the system's clock of CPU time has a resolution of milliseconds: short
  // runs are timed without samples.
  samples.begin();
  Once best = run_once(scene, engine, duration, clock);
  for (int k = 1; k < kShortRuns && best.seconds < kShort; ++k)
    run_once(scene, engine, duration, clock);
  samples.end();
  if (best.seconds >= kShort) return best;
  best = run_once(scene, engine, duration, clock);
  double spent = best.seconds;
  for (int k = 1;
       (k < kShortRuns || (spent < kLongEnough && k < kMostRuns)) && best.seconds < kShort; ++k) {
    Once next = run_once(scene, engine, duration, clock);
    spent += next.seconds;
    next.seconds = std::min(next.seconds, best.seconds);
    next.cpu = std::min(next.cpu, best.cpu);
    best = std::move(next);
  }
  return best;
}

}  // namespace

void Tally::frame(const Frame& frame) {
  const double energy = frame.kinetic_energy + frame.potential_energy;
  if (!(energy_at_0 > 0)) energy_at_0 = energy;
  energy_error = std::max(energy_error, std::abs(energy - energy_at_0) / energy_at_0);
}

void Tally::end(const Counters& counters, const std::string& stopped) {
  counts = counters.counts;
  stages = counters.stage_seconds;
  stopped_by = stopped;
}

double Measured::count(const char* what) const {
  const auto found = tally.counts.find(what);
  return found == tally.counts.end() ? 0.0 : static_cast<double>(found->second);
}

double Measured::undone() const {
  return count("undone_integrations") / std::max(1.0, count("integrations"));
}

double Measured::w_h() const {
  return engines::discontinuities_a_body_and_step(
      static_cast<std::uint64_t>(count("discontinuities")), bodies, simulated, step);
}

scene::Scene at_a_later_time(const scene::Scene& scene, double at) {
  engines::RunOptions options;
  options.engine = "tw";
  options.timewarp = engines::fast_timewarp();
  options.duration_s = at;
  options.frame_rate_hz = 1.0 / at;  // the first and the last
  TrajectoryRecorder recorder;
  engines::run_scene(scene, laws_for(scene), options, recorder);
  require(
      recorder.trajectory().stopped_by.empty() && recorder.trajectory().frames.back().time == at,
      "timewarp goes as far as it is asked to");
  scene::Scene later = scene;
  for (std::size_t k = 0; k < later.bodies.size(); ++k) {
    if (later.bodies[k].immovable) continue;
    const BodyPose& pose = recorder.trajectory().frames.back().poses[k];
    later.bodies[k].position_m = pose.com_world;
    later.bodies[k].world_from_body = pose.world_from_body;
    later.bodies[k].velocity_m_s = pose.velocity_world;
    later.bodies[k].omega_world_rad_s = pose.omega_world;
  }
  return later;
}

Measured measure(const std::string& name, int n, const std::string& engine, double duration,
                 Clock clock) {
  return measure(scene::make_sized_scene(name, n), engine, duration, clock);
}

Measured measure(const scene::Scene& scene, const std::string& engine, double duration,
                 Clock clock) {
  Measured measured;
  for (const scene::BodySpec& body : scene.bodies) measured.bodies += body.immovable ? 0 : 1;
  measured.simulated = duration;
  measured.step = scene.step_s;
  StackSamples unused, samples;
  // reading models, building shapes
  const Once building = best_of(scene, engine, kNothing, clock, unused);
  Once once = best_of(scene, engine, duration, clock, samples);
  measured.shares = engines::time_shares(samples);
  measured.seconds = std::max(1e-6, once.seconds - building.seconds);
  measured.cpu = std::max(1e-6, once.cpu - building.cpu);
  measured.tally = std::move(once.tally);
  measured.building = building.tally;
  return measured;
}

}  // namespace tumble::testing
