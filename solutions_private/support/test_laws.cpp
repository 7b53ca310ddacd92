// Impulse laws for tests of the engines: frictionless, as short as possible, independent of any
// assignment's solution. They are a solution of a1 in other words, hence private; tests that need
// them are built only where this folder is.
#include "tests/support/test_laws.h"

namespace tumble::testing {
namespace {

Vector3d velocity_at(const Body& body, const Vector3d& point_world) {
  return body.velocity_world + body.omega_world.cross(point_world - body.com_world);
}

Vector3d turn_by_unit_torque(const Body& body, const Vector3d& torque_world) {
  const Matrix3d R = body.world_from_body.toRotationMatrix();
  return R * (body.inertia.inverse_inertia_body * (R.transpose() * torque_world));
}

double normal_velocity(const Contact& contact, const Body& a, const Body& b) {
  return contact.normal_b_to_a_world.dot(velocity_at(a, contact.point_world) -
                                         velocity_at(b, contact.point_world));
}

double impulse(const Contact& contact, const Body& a, const Body& b, double restitution) {
  const double approach = normal_velocity(contact, a, b);
  if (approach >= 0) return 0.0;
  double compliance = 0.0;
  for (const Body* body : {&a, &b}) {
    const Vector3d moment =
        (contact.point_world - body->com_world).cross(contact.normal_b_to_a_world);
    compliance += body->inertia.inverse_mass + moment.dot(turn_by_unit_torque(*body, moment));
  }
  return -(1.0 + restitution) * approach / compliance;
}

}  // namespace

Laws test_laws() {
  Laws laws = library_laws();
  laws.impulse_source = "test";
  laws.relative_normal_velocity = normal_velocity;
  laws.collision_impulse = impulse;
  laws.apply_impulse = [](const Body& body, const Vector3d& impulse_world,
                          const Vector3d& point_world) {
    return Velocity{
        body.velocity_world + body.inertia.inverse_mass * impulse_world,
        body.omega_world +
            turn_by_unit_torque(body, (point_world - body.com_world).cross(impulse_world))};
  };
  laws.wrench_of_point_force = [](const Vector3d& force_world, const Vector3d& point_world,
                                  const Vector3d& com_world) {
    return Wrench{force_world, (point_world - com_world).cross(force_world)};
  };
  return laws;
}

}  // namespace tumble::testing
