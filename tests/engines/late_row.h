/// A row of balls whose first impact is taken back after the last: the longest chain of rollbacks
/// that one late event can cause.
#pragma once

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "tests/engines/event_scenes.h"

namespace tumble::testing {

/// A ball hits the next one, that one the next, and so on; when the last has been hit, a callback
/// turns the first back before it began. All of it is rolled back.
/// @param n         balls
/// @param duration  [s]; shorter than the callback's time: only what is set up
inline Trajectory taken_back_row(int n, double duration = kUnset) {
  std::vector<scene::BodySpec> bodies;
  for (int i = 0; i < n; ++i)
    bodies.push_back(
        ball("ball" + std::to_string(i), 0.1, 1.0, {0.25 * i, 0, 0}, Vector3d::Zero()));
  bodies[0].velocity_m_s.x() = 1.0;
  engines::RunOptions options;
  options.engine = "tw";
  options.faults.late_callbacks = true;
  options.frame_rate_hz = 1e-6;
  options.callbacks = {
      {0.01, {0}, [](int, RigidBodyState& state) { state.momentum_world.x() = -1.0; }}};
  if (std::isnan(duration)) duration = 0.05 * n + 0.1;
  if (duration < options.callbacks.front().time) options.callbacks.clear();
  return run_as_told(std::move(options), scene_of(std::move(bodies), duration), test_laws());
}

}  // namespace tumble::testing
