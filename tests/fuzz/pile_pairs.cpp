#include "tests/fuzz/pile_pairs.h"

#include <algorithm>
#include <cmath>

#include "framework/core/numbers.h"
#include "framework/engines/run.h"
#include "framework/engines/timewarp/fast_timewarp.h"

namespace tumble::fuzz {
namespace {

double apart(const Frame& a, const Frame& b) {
  double most = 0.0;
  for (std::size_t body = 0; body < a.poses.size(); ++body)
    most = std::max(most, (a.poses[body].com_world - b.poses[body].com_world).norm());
  return most;
}

}  // namespace

Trajectory run_pile(const scene::Scene& pile, const Laws& laws, const PileRun& run) {
  scene::Scene scene = pile;
  const auto first = std::find_if(scene.bodies.begin(), scene.bodies.end(),
                                  [](const auto& body) { return !body.immovable; });
  first->position_m.x() += run.shift_m;
  engines::RunOptions options;
  options.engine = run.engine;
  options.step_s = scene.step_s / run.steps;
  options.duration_s = run.until_s;
  options.frame_rate_hz = kPileFrames;
  options.timewarp = engines::fast_timewarp();
  TrajectoryRecorder recorder;
  engines::run_scene(scene, laws, options, recorder);
  return recorder.trajectory();
}

double apart_at(const Trajectory& a, const Trajectory& b, double time) {
  const auto frame = static_cast<std::size_t>(std::lround(time * kPileFrames));
  if (frame >= a.frames.size() || frame >= b.frames.size()) return kUnset;
  return apart(a.frames[frame], b.frames[frame]);
}

double parted_at(const Trajectory& a, const Trajectory& b, double distance) {
  for (std::size_t k = 0; k < std::min(a.frames.size(), b.frames.size()); ++k)
    if (!(apart(a.frames[k], b.frames[k]) <= distance)) return a.frames[k].time;
  return kInfinity;
}

}  // namespace tumble::fuzz
