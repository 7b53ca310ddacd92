#include "framework/dynamics/world.h"

#include <cmath>

#include "framework/core/error.h"
#include "framework/dynamics/anchors.h"
#include "framework/dynamics/build_links.h"
#include "framework/scene/build_shape.h"
#include "framework/scene/check_scene.h"

namespace tumble {
namespace {

WorldBody build_body(const scene::BodySpec& spec, scene::Solid solid) {
  WorldBody body;
  body.name = spec.name;
  body.shape = std::move(solid.shape);
  body.restitution = spec.restitution;
  body.friction = spec.friction;
  body.collides = spec.collides;
  body.passes_movable = spec.passes_movable;
  body.com_at_0_world = spec.position_m;
  body.inertia = solid.is_immovable() ? infinite_inertia() : finite_inertia(solid.mass_kg, solid.inertia_body_kg_m2);
  if (spec.motion) body.motion = *spec.motion;
  body.state.com_world = spec.position_m;
  body.state.world_from_body = spec.world_from_body.normalized();
  if (solid.is_immovable()) {
    if (!spec.omega_world_rad_s.isZero(0.0))
      throw UserError("body '" + spec.name + "'", "is immovable and has an angular velocity", "immovable bodies do not turn: leave it out");
    body.state.momentum_world = body.state.angular_momentum_world = Vector3d::Zero();
    return body;
  }
  if (std::holds_alternative<HalfSpace>(body.shape))
    throw UserError("body '" + spec.name + "'", "is a plane without end that can move", "mark it \"immovable\", or use a box");
  body.state.momentum_world = body.inertia.mass * spec.velocity_m_s;
  body.state.angular_momentum_world = angular_momentum_of(spec.omega_world_rad_s, body.state.world_from_body, body.inertia);
  return body;
}

int find_body(const World& world, const std::string& name) {
  for (std::size_t i = 0; i < world.bodies.size(); ++i)
    if (world.bodies[i].name == name) return static_cast<int>(i);
  throw UserError("point force on '" + name + "'", "no body has that name", "name one of the scene's bodies");
}

}  // namespace

World build_world(const scene::Scene& scene) {
  World world;
  scene::check_ellipsoids(scene, [&](const std::string&, const std::string& problem, const std::string& remedy) { throw UserError(scene.name, problem, remedy); });
  std::vector<scene::Solid> solids = scene::build_solids(scene);
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) world.bodies.push_back(build_body(scene.bodies[i], std::move(solids[i])));
  world.gravity_world = scene.gravity_m_s2;
  for (const scene::PointForceSpec& spec : scene.point_forces) {
    const int body = find_body(world, spec.body);
    if (world.bodies[body].immovable())
      throw UserError("point force on '" + spec.body + "'", "the body is immovable", "push a movable body");
    world.point_forces.push_back({body, spec.force_n, spec.point_m, spec.start_s, spec.start_s + spec.duration_s});
  }
  build_links(scene, world);
  return world;
}

Vector3d prescribed_position(const WorldBody& body, double time) {
  const scene::PrescribedMotion& m = body.motion;
  Vector3d position = body.com_at_0_world + m.velocity_m_s * time;
  if (m.angular_frequency_rad_s != 0.0) position += m.amplitude_m * std::sin(m.angular_frequency_rad_s * time);
  return position;
}

Vector3d prescribed_velocity(const WorldBody& body, double time) {
  const scene::PrescribedMotion& m = body.motion;
  if (m.angular_frequency_rad_s == 0.0) return m.velocity_m_s;
  return m.velocity_m_s + m.amplitude_m * (m.angular_frequency_rad_s * std::cos(m.angular_frequency_rad_s * time));
}

Vector3d omega_of(const RigidBodyState& state, const Inertia& inertia) {
  // Through the body frame, where the inverse inertia is exact.
  const Matrix3d R = state.world_from_body.toRotationMatrix();
  return R * (inertia.inverse_inertia_body * (R.transpose() * state.angular_momentum_world));
}

Vector3d angular_momentum_of(const Vector3d& omega_world, const Quaterniond& world_from_body, const Inertia& inertia) {
  const Matrix3d R = world_from_body.toRotationMatrix();
  return R * (inertia.inertia_body * (R.transpose() * omega_world));
}

double kinetic_energy(const RigidBodyState& state, const Inertia& inertia) {
  return 0.5 * (state.momentum_world.squaredNorm() * inertia.inverse_mass + state.angular_momentum_world.dot(omega_of(state, inertia)));
}

Invariants invariants_of(const World& world, const std::vector<RigidBodyState>& states) {
  Invariants sums;
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    const WorldBody& body = world.bodies[i];
    if (body.immovable()) continue;
    const RigidBodyState& state = states[i];
    sums.kinetic_energy += kinetic_energy(state, body.inertia);
    if (world.gravity_world) sums.potential_energy -= body.inertia.mass * world.gravity_world->dot(state.com_world);
    sums.momentum_world += state.momentum_world;
    sums.angular_momentum_world += state.angular_momentum_world + state.com_world.cross(state.momentum_world);
  }
  for (const SpringLink& link : world.springs) {
    // E = k/2 (L - L0)^2
    const double stretch = (anchor_point(link.b, states) - anchor_point(link.a, states)).norm() - link.spring.rest_length;
    sums.potential_energy += 0.5 * link.spring.stiffness * stretch * stretch;
  }
  return sums;
}

}  // namespace tumble
