#include "framework/dynamics/world.h"

#include <cmath>

namespace tumble {

bool is_driven(const scene::PrescribedMotion& motion) {
  return !motion.velocity_m_s.isZero(0.0) ||
         (motion.angular_frequency_rad_s != 0.0 && !motion.amplitude_m.isZero(0.0));
}

Vector3d prescribed_position(const WorldBody& body, double time) {
  const scene::PrescribedMotion& m = body.motion;
  Vector3d position = body.com_at_0_world + m.velocity_m_s * time;
  if (m.angular_frequency_rad_s != 0.0)
    position += m.amplitude_m * std::sin(m.angular_frequency_rad_s * time);
  return position;
}

Vector3d prescribed_velocity(const WorldBody& body, double time) {
  const scene::PrescribedMotion& m = body.motion;
  if (m.angular_frequency_rad_s == 0.0) return m.velocity_m_s;
  return m.velocity_m_s +
         m.amplitude_m * (m.angular_frequency_rad_s * std::cos(m.angular_frequency_rad_s * time));
}

Vector3d omega_of(const RigidBodyState& state, const Inertia& inertia) {
  // Through the body frame, where the inverse inertia is exact.
  const Matrix3d R = state.world_from_body.toRotationMatrix();
  return R * (inertia.inverse_inertia_body * (R.transpose() * state.angular_momentum_world));
}

bool is_finite(const RigidBodyState& state) {
  return state.com_world.allFinite() && state.world_from_body.coeffs().allFinite() &&
         state.momentum_world.allFinite() && state.angular_momentum_world.allFinite();
}

Vector3d angular_momentum_of(const Vector3d& omega_world, const Quaterniond& world_from_body,
                             const Inertia& inertia) {
  const Matrix3d R = world_from_body.toRotationMatrix();
  return R * (inertia.inertia_body * (R.transpose() * omega_world));
}

double kinetic_energy(const RigidBodyState& state, const Inertia& inertia) {
  return 0.5 * (state.momentum_world.squaredNorm() * inertia.inverse_mass +
                state.angular_momentum_world.dot(omega_of(state, inertia)));
}

}  // namespace tumble
