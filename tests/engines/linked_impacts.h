/// Impacts on bodies that rods and joints hold: scenes of them under every law of impacts, and one
/// impact alone.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "framework/effects/build_world.h"
#include "framework/engines/contact/impact_detection.h"
#include "framework/engines/contact/sequential_impacts.h"
#include "tests/engines/event_scenes.h"
#include "tests/engines/reference_laws.h"

namespace tumble::testing::linked_impacts {

inline const Laws& laws() {
  static const Laws all = reference_laws();
  return all;
}

/// A scene under every law of impacts.
inline std::vector<std::pair<std::string, scene::Scene>> under_all_laws(const scene::Scene& scene) {
  scene::Scene sequential = scene, simultaneous = scene;
  sequential.contact = scene::ContactSpec{};
  simultaneous.contact = scene::ContactSpec{};
  simultaneous.contact->impact_law = scene::ImpactLaw::kSimultaneous;
  return {{"without contact", scene}, {"sequential", sequential}, {"simultaneous", simultaneous}};
}

inline scene::Scene linked_scene(std::vector<scene::BodySpec> bodies, double e,
                                 double friction = 0.0) {
  for (scene::BodySpec& body : bodies) {
    body.restitution = e;
    body.friction = friction;
  }
  scene::Scene scene = scene_of(std::move(bodies), 0.01);
  scene.step_s = 0.001;
  scene.stabilisation = scene::StabilisationSpec{};
  return scene;
}

/// One impact in a world that stands still in time.
struct OneImpact {
  scene::Scene scene;
  Laws guarded_laws = laws();
  engines::RunCounters counters;
  engines::MovingWorld moving;
  engines::ImpactDetection meetings;
  engines::SequentialImpacts impacts;

  explicit OneImpact(const scene::Scene& asked)
      : scene(asked),
        moving(build_world(scene), guarded_laws, counters),
        meetings(moving, guarded_laws, counters),
        impacts(guarded_laws, {1e-6, 1e-5}, counters) {
    if (scene.contact) impacts.use_contact_rules(1e-6, scene.contact->impact_law);
  }

  engines::Resolution strike(int a, int b) {
    const collision::Gap gap = meetings.gap({a, b});
    const std::vector<engines::TouchingPair> pairs{
        engines::TouchingPair{a, b, gap, meetings.touching_points({a, b}, gap)}};
    return impacts.resolve(moving, pairs, 0);
  }

  double kinetic_energy() const {
    double sum = 0.0;
    for (int i = 0; i < moving.size(); ++i) {
      if (moving.world().bodies[static_cast<std::size_t>(i)].immovable()) continue;
      const RigidBodyState& state = moving.state(i);
      const Inertia& inertia = moving.world().bodies[static_cast<std::size_t>(i)].inertia;
      sum += 0.5 * inertia.inverse_mass * state.momentum_world.squaredNorm() +
             0.5 * omega_of(state, inertia).dot(state.angular_momentum_world);
    }
    return sum;
  }

  std::pair<Vector3d, Vector3d> momenta() const {
    Vector3d P = Vector3d::Zero(), L = Vector3d::Zero();
    for (int i = 0; i < moving.size(); ++i) {
      if (moving.world().bodies[static_cast<std::size_t>(i)].immovable()) continue;
      P += moving.state(i).momentum_world;
      L += moving.state(i).angular_momentum_world +
           moving.state(i).com_world.cross(moving.state(i).momentum_world);
    }
    return {P, L};
  }

  double largest_rate() {
    double rate = 0.0;
    for (engines::LinkedBodies& group : moving.linked_groups())
      for (const Constraint& row : group.constraint_rows(moving.states(), moving.time()))
        rate = std::max(rate, std::abs(row.row.rate));
    return rate;
  }

  void set_velocity(int body, const Vector3d& velocity, const Vector3d& omega) {
    RigidBodyState state = moving.state(body);
    const Inertia& inertia = moving.world().bodies[static_cast<std::size_t>(body)].inertia;
    state.momentum_world = inertia.mass * velocity;
    state.angular_momentum_world = angular_momentum_of(omega, state.world_from_body, inertia);
    moving.set_state(body, state);
  }
};

}  // namespace tumble::testing::linked_impacts
