/// Shared by tests of costs: a box in free rotation, and the library's methods of integration as
/// methods of the comparison.
#pragma once

#include <string>

#include "framework/cost/cost.h"
#include "framework/truths/memory_scene.h"

namespace tumble::testing {

/// For a second, not about a principal axis.
inline scene::Scene free_top(const Vector3d& omega_rad_s) {
  scene::Scene scene = truths::empty_scene("free top", 1.0, 1e-3);
  scene::BodySpec top = truths::point_mass("top", 1.0, Vector3d::Zero(), Vector3d(1.0, 0.0, 0.0));
  top.inertia_body_kg_m2 = Vector3d(1.0, 2.0, 3.0).asDiagonal();
  top.omega_world_rad_s = omega_rad_s;
  scene.bodies = {top};
  return scene;
}

inline cost::CostMethod method_of(const std::string& word) {
  const Method& integrator = method_named(word);
  cost::CostMethod method;
  method.name = integrator.name;
  method.step_function = [integrator](double tolerance) { return step_of(integrator, tolerance); };
  method.steps_in_units = needs_units(integrator);
  method.order = integrator.order;
  method.controlled = integrator.controlled;
  method.laws = library_laws();
  return method;
}

}  // namespace tumble::testing
