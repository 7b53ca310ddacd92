// A submission as they come in the evening before the deadline: Euler and the matrices right, k3
// built on the wrong slope, the angular velocity on the wrong side of the quaternion, a search that
// never ends when asked for the last digit, Newton without a safeguard, and the way back from a
// matrix to its angles not begun.
#include "assignments/a2_integration/a2_integration.h"

#include <cmath>

namespace tumble::a2 {

VectorXd euler_step(const OdeFunction& f, double t, const VectorXd& y, double h) {
  VectorXd next = y;
  next += h * f(t, y);
  return next;
}

VectorXd rk4_step(const OdeFunction& f, double t, const VectorXd& y, double h) {
  VectorXd k1 = f(t, y);
  VectorXd k2 = f(t + 0.5 * h, y + 0.5 * h * k1);
  VectorXd k3 = f(t + 0.5 * h, y + 0.5 * h * k1);  // copied from the line above
  VectorXd k4 = f(t + h, y + h * k3);
  return y + (h / 6.0) * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
}

Matrix3d inertia_in_world(const Matrix3d& inertia_body, const Quaterniond& world_from_body) {
  Matrix3d R = world_from_body.matrix();
  return R * inertia_body * R.transpose();
}

VectorXd rigid_body_derivative(const RigidBodyState& state, const Inertia& inertia,
                               const Wrench& wrench) {
  const Quaterniond& q = state.world_from_body;
  // a rotated inverse tensor, as on the slides
  Matrix3d inverse_inertia_world = inertia_in_world(inertia.inverse_inertia_body, q);
  Vector3d omega_world = inverse_inertia_world * state.angular_momentum_world;
  Quaterniond w(0, omega_world.x(), omega_world.y(), omega_world.z());
  Quaterniond spin = q * w;
  VectorXd rate(13);
  rate << state.momentum_world * inertia.inverse_mass, 0.5 * spin.w(), 0.5 * spin.x(),
      0.5 * spin.y(), 0.5 * spin.z(), wrench.force_world, wrench.torque_world;
  return rate;
}

Quaterniond renormalize(const Quaterniond& world_from_body) {
  double length = std::sqrt(world_from_body.coeffs().squaredNorm());
  return Quaterniond(world_from_body.coeffs() / length);
}

Matrix3d orthonormalize(const Matrix3d& drifted_world_from_body) {
  Matrix3d R = drifted_world_from_body;
  R.col(0).normalize();
  R.col(1) -= R.col(0).dot(R.col(1)) * R.col(0);
  R.col(1).normalize();
  R.col(2) -= R.col(0).dot(R.col(2)) * R.col(0);  // and the other one?
  R.col(2).normalize();
  return R;
}

Matrix3d rotation_from_euler_angles(double yaw, double pitch, double roll) {
  Matrix3d z, y, x;
  z << std::cos(yaw), -std::sin(yaw), 0, std::sin(yaw), std::cos(yaw), 0, 0, 0, 1;
  y << std::cos(pitch), 0, std::sin(pitch), 0, 1, 0, -std::sin(pitch), 0, std::cos(pitch);
  x << 1, 0, 0, 0, std::cos(roll), -std::sin(roll), 0, std::sin(roll), std::cos(roll);
  return z * y * x;
}

EulerAngles euler_angles_from_rotation(const Matrix3d&) {
  throw NotImplemented("euler_angles_from_rotation", "handouts/a2_integration.md#hint-gimbal-lock");
}

RootResult impact_time_bisection(const ScalarFunction& gap, double t_low, double t_high,
                                 double tolerance) {
  RootResult result;
  double a = t_low, b = t_high;
  double at_a = gap(a), at_b = gap(b);
  result.evaluations = 2;
  if (at_a < 0 || (at_a > 0 && at_b > 0)) {
    result.status = RootStatus::kNoSignChange;
    return result;
  }
  while (b - a > tolerance) {
    double m = (a + b) / 2;
    double at_m = gap(m);
    ++result.evaluations;
    if (at_m >= 0) {
      a = m;
      at_a = at_m;
    } else {
      b = m;
    }
  }
  result.status = RootStatus::kConverged;
  result.time = a;
  result.residual = at_a;
  return result;
}

RootResult impact_time_newton(const ScalarFunction& gap, const ScalarFunction& gap_rate,
                              double t_low, double t_high, double tolerance) {
  RootResult result;
  result.evaluations = 2;
  if (gap(t_low) < 0 || (gap(t_low) > 0 && gap(t_high) > 0)) {
    result.status = RootStatus::kNoSignChange;
    return result;
  }
  double t = t_low;
  for (int i = 0; i < 50; ++i) {
    double step = gap(t) / gap_rate(t);
    ++result.evaluations;
    t -= step;
    if (std::abs(step) <= tolerance) break;
  }
  result.status = RootStatus::kConverged;
  result.time = t;
  result.residual = gap(t);
  return result;
}

}  // namespace tumble::a2
