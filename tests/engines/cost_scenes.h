/// What tests of costs share: a box that turns freely, and the library's methods as ways to run it.
#pragma once

#include <string>

#include "framework/engines/cost/cost.h"
#include "framework/engines/truths/memory_scene.h"

namespace tumble::testing {

/// For a second, about no axis of its own.
inline scene::Scene free_top(const Vector3d& omega_rad_s) {
  scene::Scene scene = truths::empty_scene("free top", 1.0, 1e-3);
  scene::BodySpec top = truths::point_mass("top", 1.0, Vector3d::Zero(), Vector3d(1.0, 0.0, 0.0));
  top.inertia_body_kg_m2 = Vector3d(1.0, 2.0, 3.0).asDiagonal();
  top.omega_world_rad_s = omega_rad_s;
  scene.bodies = {top};
  return scene;
}

inline engines::CostWay way_of(const std::string& word) {
  const Method& method = method_named(word);
  engines::CostWay way;
  way.name = method.name;
  way.method = [method](double tolerance) { return step_of(method, tolerance); };
  way.order = method.order;
  way.controlled = method.controlled;
  way.laws = library_laws();
  return way;
}

}  // namespace tumble::testing
