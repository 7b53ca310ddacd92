/// Swings that steps may damp, and what their runs tell of energy that is lost.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "framework/effects/spring/spring.h"
#include "tests/engines/watched_runs.h"

namespace tumble::testing {

inline const Vector3d kDown(0, 0, -9.81);

inline std::optional<RunFault> lost_in(const std::vector<RunFault>& faults) {
  for (const RunFault& fault : faults)
    if (fault.kind == "energy_lost") return fault;
  return std::nullopt;
}
inline std::optional<RunFault> lost_in(const Trajectory& run) {
  return lost_in(run.counters.faults);
}

inline effects::SpringSpec spring_between(const std::string& a, const Vector3d& point,
                                          const std::string& b, double stiffness,
                                          double rest_length, double damping = 0.0) {
  effects::SpringSpec spring;
  spring.name = "spring";
  spring.a = {a, point};
  spring.b = {b, Vector3d::Zero()};
  spring.stiffness_n_m = stiffness;
  spring.damping_n_s_m = damping;
  spring.rest_length_m = rest_length;
  return spring;
}

/// A ball that swings on an undamped spring along x.
inline scene::Scene swing(double mass, double stiffness, double amplitude, double step,
                          double duration) {
  scene::Scene scene =
      scene_of({ball("bob", 0.01, mass, {1.0 + amplitude, 0, 0}, Vector3d::Zero())}, duration);
  scene.effects.of<effects::SpringSpec>().push_back(
      spring_between("", Vector3d::Zero(), "bob", stiffness, 1.0));
  scene.step_s = step;
  return scene;
}

}  // namespace tumble::testing
