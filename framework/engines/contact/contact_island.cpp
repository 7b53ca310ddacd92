#include "framework/engines/contact/contact_island.h"

#include <algorithm>

namespace tumble::engines {
namespace {

Matrix3d inverse_inertia_world(const WorldBody& body, const Quaterniond& q) {
  const Matrix3d R = q.normalized().toRotationMatrix();
  return R * body.inertia.inverse_inertia_body * R.transpose();
}

}  // namespace

int place_body(const MovingWorld& moving, int body, double t, BodyPlaces& places,
               const std::vector<RigidBodyState>& states, const RigidBodyState* velocities,
               ContactProblem& problem) {
  const int next = static_cast<int>(problem.bodies.size()), place = places.enter(body, next);
  if (place != next) return place;
  const WorldBody& b = moving.world().bodies[body];
  PushedBody pushed;
  pushed.com_world = states[body].com_world;
  pushed.velocity_world = pushed.omega_world = Vector3d::Zero();
  if (b.immovable()) {
    if (velocities) pushed.velocity_world = prescribed_velocity(b, t);
  } else {
    pushed.inverse_mass = b.inertia.inverse_mass;
    pushed.inverse_inertia_world = inverse_inertia_world(
        b, velocities ? velocities->world_from_body : states[body].world_from_body);
    if (velocities) {
      pushed.velocity_world = b.inertia.inverse_mass * velocities->momentum_world;
      pushed.omega_world = omega_of(*velocities, b.inertia);
    }
  }
  problem.bodies.push_back(pushed);
  return place;
}

void add_island_rows(MovingWorld& moving, const ContactIsland& island,
                     const std::vector<RigidBodyState>& states, double t, const BodyPlaces& places,
                     bool of_places, ContactProblem& problem) {
  for (const int index : island.linked)
    engines::add_rows(moving.linked_groups()[static_cast<std::size_t>(index)], states, t, places,
                      problem);
  if (!of_places) return keep_rates(problem);
  problem.row_targets.resize(static_cast<Eigen::Index>(problem.rows.size()));
  for (std::size_t k = 0; k < problem.rows.size(); ++k)
    problem.row_targets[static_cast<Eigen::Index>(k)] = -problem.rows[k].row.value;
}

double fastest_speed(const MovingWorld& moving, const ContactIsland& island) {
  double fastest = 0.0;
  for (const int index : island.bodies) {
    const Body body = moving.body_at_impact(index);
    fastest =
        std::max(fastest, body.velocity_world.norm() +
                              body.omega_world.norm() * moving.shape(index).bounding_radius());
  }
  return fastest;
}

}  // namespace tumble::engines
