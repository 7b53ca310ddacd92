#include "framework/dynamics/anchors.h"

namespace tumble {

Vector3d anchor_point(const Anchor& anchor, const std::vector<RigidBodyState>& states) {
  if (anchor.body < 0) return anchor.point_body;
  const RigidBodyState& state = states[static_cast<std::size_t>(anchor.body)];
  return state.com_world + state.world_from_body * anchor.point_body;
}

AnchorState anchor_state(const Anchor& anchor, const World& world,
                         const std::vector<RigidBodyState>& states, double time) {
  if (anchor.body < 0) return {anchor.point_body, Vector3d::Zero()};
  const WorldBody& body = world.bodies[static_cast<std::size_t>(anchor.body)];
  if (body.immovable())  // it does not turn
    return {prescribed_position(body, time) + body.state.world_from_body * anchor.point_body,
            prescribed_velocity(body, time)};
  const RigidBodyState& state = states[static_cast<std::size_t>(anchor.body)];
  // v_point = v + w x r
  const Vector3d r_world = state.world_from_body * anchor.point_body;
  const Vector3d velocity_world = body.inertia.inverse_mass * state.momentum_world +
                                  omega_of(state, body.inertia).cross(r_world);
  return {state.com_world + r_world, velocity_world};
}

std::pair<Vector6d, Vector6d> distance_jacobians(const Anchor& a, const Anchor& b,
                                                 const std::vector<RigidBodyState>& states) {
  const Vector3d at_a = anchor_point(a, states), at_b = anchor_point(b, states);
  const double length = (at_a - at_b).norm();
  const Vector3d along =
      length > 0 ? Vector3d((at_a - at_b) / length) : Vector3d(Vector3d::UnitZ());
  const auto of = [&](const Anchor& anchor, const Vector3d& point, double sign) {
    Vector6d jacobian = Vector6d::Zero();
    if (anchor.body >= 0)
      jacobian << sign * along,
          sign * (point - states[static_cast<std::size_t>(anchor.body)].com_world).cross(along);
    return jacobian;
  };
  return {of(a, at_a, 1.0), of(b, at_b, -1.0)};
}

}  // namespace tumble
