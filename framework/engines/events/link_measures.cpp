#include "framework/engines/events/link_measures.h"

#include <algorithm>

namespace tumble::engines {

LinkMeasures::LinkMeasures(const FlightWorld& world, const Laws& laws) : world_(world), laws_(laws) {
  for (std::vector<int>& bodies : groups_of_linked_bodies(world.world()))
    groups_.emplace_back(world.world(), laws, uncounted_, [this](int body, const RigidBodyState& state) { return wrench_on(body, state); }, std::move(bodies));
}

Wrench LinkMeasures::wrench_on(int body, const RigidBodyState& state) const {
  Wrench sum{world_.world().gravity_world ? Vector3d(world_.inertia(body).mass * *world_.world().gravity_world) : Vector3d(Vector3d::Zero()), Vector3d::Zero()};
  for (const auto& [index, point_body] : *points_body_) {
    const PointForce& force = world_.world().point_forces[static_cast<std::size_t>(index)];
    if (force.body != body) continue;
    const Wrench wrench = laws_.wrench_of_point_force(force.force_world, state.com_world + state.world_from_body.normalized() * point_body, state.com_world);
    sum.force_world += wrench.force_world;
    sum.torque_world += wrench.torque_world;
  }
  return sum;
}

void LinkMeasures::measure(Frame& frame, const FlightOf& flight_of) {
  const World& world = world_.world();
  LinkForces forces{std::vector<double>(world.springs.size()), std::vector<double>(world.rods.size()), std::vector<double>(world.joints.size())};
  std::vector<RigidBodyState> states;
  for (int i = 0; i < world_.size(); ++i) states.push_back(world_.state(i, flight_of(i), frame.time));
  for (const int body : world_.movers()) {
    const Flight& flight = flight_of(body);
    if (flight.passage < 0 || world_.first_member(body, flight) != body) continue;
    const std::vector<ContactPoint>& contacts = world_.processes()->passages().step_at(flight.passage, frame.time).forces;
    frame.contacts.insert(frame.contacts.end(), contacts.begin(), contacts.end());
  }
  for (LinkedBodies& group : groups_) {
    const ProcessState& from = world_.processes()->passages().step_at(flight_of(group.bodies().front()).passage, frame.time).from;
    std::vector<double> torques, looks;
    for (const int motor : group.motors()) {
      const auto held = from.motors.find(motor);
      torques.push_back(held == from.motors.end() ? 0.0 : held->second.torque);
      looks.push_back(0.0);
    }
    group.remember(std::move(torques), std::move(looks));
    points_body_ = &from.force_points_body;
    group.measure(states, frame.time, frame.contacts, forces);
  }
  frame.spring_forces = std::move(forces.springs);
  frame.rod_tensions = std::move(forces.rods);
  frame.joint_forces = std::move(forces.joints);
}

std::vector<Event> force_switches(const World& world, double until) {
  std::vector<Event> events;
  for (const PointForce& force : world.point_forces)
    for (const auto& [time, kind] : {std::pair{force.start, EventKind::kForceOn}, std::pair{force.end, EventKind::kForceOff}}) {
      if (!(time <= until) || !(force.start < force.end)) continue;
      const double size = force.force_world.norm();
      events.push_back({time, kind, force.body, -1, force.point_world, size > 0 ? Vector3d(force.force_world / size) : Vector3d(Vector3d::UnitZ()), 0.0, 0.0});
    }
  std::stable_sort(events.begin(), events.end(), [](const Event& a, const Event& b) { return a.time < b.time; });
  return events;
}

}  // namespace tumble::engines
