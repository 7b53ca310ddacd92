/// The families of cases that the framework computes itself, with the laws of the chosen modules.
/// Families about a module's own functions are registered by its assignment (modules/registry.h).
#pragma once

#include <map>
#include <string>

#include "framework/dynamics/laws.h"
#include "framework/truths/comparison.h"
#include "framework/truths/truth_case.h"
#include "framework/trajectory/trajectory.h"

namespace tumble::truths {

using FrameworkFamily = void (*)(const Case& truth, const Laws& laws, Comparison& comparison);

/// By name of the family.
const std::map<std::string, FrameworkFamily>& framework_families();

// One per family; each compares every output of the case, or gives the reason for no comparison.
void compare_mass_properties(const Case& truth, const Laws& laws, Comparison& comparison);
void compare_free_top(const Case& truth, const Laws& laws, Comparison& comparison);
void compare_times_of_impact(const Case& truth, const Laws& laws, Comparison& comparison);
void compare_bouncing_ball(const Case& truth, const Laws& laws, Comparison& comparison);
void compare_moving_floor(const Case& truth, const Laws& laws, Comparison& comparison);
void compare_shaken_floor(const Case& truth, const Laws& laws, Comparison& comparison);
void compare_cradle(const Case& truth, const Laws& laws, Comparison& comparison);
void compare_hard_spheres(const Case& truth, const Laws& laws, Comparison& comparison);
void compare_spring_mass(const Case& truth, const Laws& laws, Comparison& comparison);
void compare_elastic_pendulum(const Case& truth, const Laws& laws, Comparison& comparison);
void compare_two_body_spring(const Case& truth, const Laws& laws, Comparison& comparison);
void compare_chain(const Case& truth, const Laws& laws, Comparison& comparison);
void compare_compound_pendulum(const Case& truth, const Laws& laws, Comparison& comparison);
void compare_heavy_top(const Case& truth, const Laws& laws, Comparison& comparison);
void compare_friction_incline(const Case& truth, const Laws& laws, Comparison& comparison);
void compare_roll_incline(const Case& truth, const Laws& laws, Comparison& comparison);
void compare_slip_to_roll(const Case& truth, const Laws& laws, Comparison& comparison);
/// The part of toi_tunnel that runs a scene.
void compare_tunnel_run(const Case& truth, const Laws& laws, Comparison& comparison);

inline double energy_of(const Frame& frame) {
  return frame.kinetic_energy + frame.potential_energy;
}

}  // namespace tumble::truths
