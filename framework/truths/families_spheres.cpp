// newtons_cradle, hard_spheres, and the bullet of toi_tunnel: runs of the engine with the chosen
// laws.
#include <algorithm>
#include <cmath>

#include "framework/core/error.h"
#include "framework/engines/base/tolerances.h"
#include "framework/truths/families.h"
#include "framework/truths/memory_scene.h"

namespace tumble::truths {
namespace {

// ---- newtons_cradle ----------------------------------------------------------------------------

/// Equal balls in a row along x that just touch, the first k of them moving.
scene::Scene cradle(const Case& truth) {
  const int n = truth.input("N").integer(), moving = truth.input("k_moving").integer();
  scene::Scene scene = empty_scene(truth.id, 0.1, engines::kNegligibleSpeed);
  for (int i = 0; i < n; ++i) {
    const Vector3d velocity(i < moving ? truth.input("v").number() : 0.0, 0.0, 0.0);
    // a radius of 0.5 m: positions at whole metres are exact
    scene.bodies.push_back(ball("ball" + std::to_string(i), truth.input("mass").number(), 0.5,
                                Vector3d(i, 0, 0), velocity, truth.input("e").number()));
  }
  return scene;
}

// ---- hard_spheres ------------------------------------------------------------------------------

struct Spheres {
  scene::Scene scene;
  int count;
  double kinetic_energy = 0.0;
};

Spheres spheres_in_box(const Case& truth, double duration) {
  const VectorXd masses = truth.input("masses").vector();
  const Value& x = truth.input("x0");
  const Value& v = truth.input("v0");
  const Vector3d box = truth.input("box").vector3();
  Spheres spheres{empty_scene(truth.id, duration, engines::kNegligibleSpeed),
                  static_cast<int>(masses.size())};
  for (int i = 0; i < spheres.count; ++i) {
    const auto at = static_cast<std::size_t>(i);
    spheres.scene.bodies.push_back(ball("ball" + std::to_string(i), masses[i],
                                        truth.input("radii").at(at).number(), x.at(at).vector3(),
                                        v.at(at).vector3(), 1.0));
    spheres.kinetic_energy += 0.5 * masses[i] * v.at(at).vector3().squaredNorm();
  }
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3d inward = Vector3d::Unit(axis);
    spheres.scene.bodies.push_back(
        wall("low" + std::to_string(axis), Vector3d::Zero(), inward, 1.0));
    spheres.scene.bodies.push_back(
        wall("high" + std::to_string(axis), box[axis] * inward, -inward, 1.0));
  }
  return spheres;
}

/// Positions and velocities just after impact number `index`, from a frame halfway to the next one:
/// back-propagation of free flight is exact.
struct Flight {
  VectorXd positions, velocities;
};

Flight just_after(const Spheres& spheres, const Laws& laws, const std::vector<Event>& impacts,
                  std::size_t index) {
  const double t = impacts[index].time;
  const Frame frame = frame_at(spheres.scene, laws, 0.5 * (t + impacts[index + 1].time));
  Flight flight{VectorXd(3 * spheres.count), VectorXd(3 * spheres.count)};
  for (int i = 0; i < spheres.count; ++i) {
    const BodyPose& pose = frame.poses[static_cast<std::size_t>(i)];
    flight.velocities.segment<3>(3 * i) = pose.velocity_world;
    flight.positions.segment<3>(3 * i) = pose.com_world - pose.velocity_world * (frame.time - t);
  }
  return flight;
}

VectorXd flat(const Value& rows) {
  const auto& list = rows.list();
  VectorXd all(3 * static_cast<Eigen::Index>(list.size()));
  for (std::size_t i = 0; i < list.size(); ++i)
    all.segment<3>(3 * static_cast<Eigen::Index>(i)) = list[i].vector3();
  return all;
}

void compare_collision(const Value& row, const Flight& flight, const Event& impact, int wall_hits,
                       const std::string& name, Comparison& comparison) {
  const double floor = row.at("tolerance_floor").number();
  const Value& pair = row.at("pair");
  const bool same = pair.at(0).integer() == impact.body_a && pair.at(1).integer() == impact.body_b;
  comparison.agree(
      name + ".pair", same,
      "found " + std::to_string(impact.body_a) + " and " + std::to_string(impact.body_b));
  comparison.agree(name + ".wall_hits_so_far", wall_hits == row.at("wall_hits_so_far").integer(),
                   "found " + std::to_string(wall_hits));
  comparison.closed_form(name + ".t", std::abs(impact.time - row.at("t").number()), floor);
  comparison.closed_form(name + ".positions",
                         largest_difference(flight.positions, flat(row.at("positions"))), floor);
  comparison.closed_form(name + ".velocities_after",
                         largest_difference(flight.velocities, flat(row.at("velocities_after"))),
                         floor);
}

}  // namespace

void compare_cradle(const Case& truth, const Laws& laws, Comparison& comparison) {
  const scene::Scene scene = cradle(truth);
  const Trajectory run = run_in_memory(scene, laws, 1.0 / scene.duration_s);
  const Frame& before = run.frames.front();
  const Frame after = frame_at(scene, laws, scene.duration_s);
  VectorXd velocities(static_cast<Eigen::Index>(after.poses.size()));
  for (Eigen::Index i = 0; i < velocities.size(); ++i)
    velocities[i] = after.poses[static_cast<std::size_t>(i)].velocity_world.x();
  for (const auto& [name, output] : truth.outputs.members()) {
    if (name.rfind("velocities_after_sequential", 0) == 0)
      comparison.closed_form(truth, name, velocities);
    else if (name == "pair_impulses_used")
      comparison.closed_form(truth, name, static_cast<double>(impacts_of(run).size()));
    else if (name == "momentum")
      comparison.closed_form(truth, name, after.momentum_world.x());
    else if (name == "kinetic_energy_before")
      comparison.closed_form(truth, name, before.kinetic_energy);
    else if (name == "kinetic_energy_sequential")
      comparison.closed_form(truth, name, after.kinetic_energy);
    else
      comparison.not_compared(
          name, "another law: here pairs collide one after the other, not all at once");
  }
}

void compare_hard_spheres(const Case& truth, const Laws& laws, Comparison& comparison) {
  const auto& rows = truth.output("collisions").list();
  if (rows.empty())
    throw UserError(truth.output("collisions").place(), "lists no collision",
                    "A case needs at least one.");
  const int beyond = truth.output("first_collision_beyond_double").integer();
  const double duration = rows.back().at("t").number() + 1.0;
  const Spheres spheres = spheres_in_box(truth, duration);
  const Trajectory run = run_in_memory(spheres.scene, laws, kNoFrames);
  const std::vector<Event> impacts = impacts_of(run);

  std::size_t row = 0;
  int wall_hits = 0;
  for (std::size_t i = 0; i + 1 < impacts.size() && row < rows.size(); ++i) {
    if (impacts[i].body_b >= spheres.count) {
      ++wall_hits;
      continue;
    }
    if (rows[row].at("k").integer() >= beyond) break;
    compare_collision(rows[row], just_after(spheres, laws, impacts, i), impacts[i], wall_hits,
                      "collision" + rows[row].at("k").text(), comparison);
    ++row;
  }
  const bool all_met = row == rows.size() || rows[row].at("k").integer() >= beyond;
  if (!all_met)
    comparison.agree("collisions", false,
                     "only " + std::to_string(row) + " collisions of pairs were found");
  if (row < rows.size() && all_met)
    comparison.not_compared("collisions " + std::to_string(beyond) + " and later",
                            "rounding of the inputs alone changes them by more than a percent");

  // Energy is conserved to the end, up to a few roundings per impact (goal: 1e-12).
  const Frame end = frame_at(spheres.scene, laws, duration);
  comparison.check(
      "kinetic_energy", std::abs(end.kinetic_energy - truth.output("kinetic_energy").number()),
      truth.floor("kinetic_energy"),
      std::max(kClosedFormFactor * truth.floor("kinetic_energy"), 1e-12 * spheres.kinetic_energy),
      "after " + std::to_string(impacts.size()) + " impacts");
  for (const std::string name : {"lyapunov_per_pair_collision", "lyapunov_per_second"})
    if (truth.has_output(name))
      comparison.not_compared(name,
                              "an estimate of the growth of errors, from which the floors follow");
}

void compare_tunnel_run(const Case& truth, const Laws& laws, Comparison& comparison) {
  const double thickness = truth.input("wall_thickness").number(), e = truth.input("e").number();
  scene::Scene scene = empty_scene(truth.id, truth.input("T").number(), engines::kNegligibleSpeed);
  scene.step_s = truth.input("dt").number();
  scene.bodies.push_back(ball("bullet", 0.01, truth.input("R").number(),
                              Vector3d(truth.input("x_centre_0").number(), 0, 0),
                              Vector3d(truth.input("v").number(), 0, 0), e));
  scene::BodySpec slab;
  slab.name = "wall";
  slab.shape = scene::BoxSpec{Vector3d(0.5 * thickness, 1.0, 1.0)};
  slab.immovable = true;
  slab.position_m.x() = truth.input("wall_front_face_x").number() + 0.5 * thickness;
  slab.restitution = e;
  scene.bodies.push_back(slab);
  comparison.closed_form(truth, "x_centre_at_T",
                         frame_at(scene, laws, scene.duration_s).poses[0].com_world.x());
}

}  // namespace tumble::truths
