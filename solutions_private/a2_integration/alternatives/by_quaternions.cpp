// A right solution in other words: turns by quaternions instead of matrices, angles that keep the
// rotation in gimbal lock to round-off, and one loop for both searches, which is told how to choose
// the next time.
#include "assignments/a2_integration/a2_integration.h"

#include <array>
#include <cmath>
#include <numeric>

namespace tumble::a2 {

VectorXd euler_step(const OdeFunction& f, double t, const VectorXd& y, double h) {
  VectorXd end = f(t, y);
  end *= h;
  end += y;
  return end;
}

VectorXd rk4_step(const OdeFunction& f, double t, const VectorXd& y, double h) {
  std::array<VectorXd, 4> k;
  k[0] = h * f(t, y);
  k[1] = h * f(t + 0.5 * h, y + 0.5 * k[0]);
  k[2] = h * f(t + 0.5 * h, y + 0.5 * k[1]);
  k[3] = h * f(t + h, y + k[2]);
  return y + k[0] / 6.0 + k[1] / 3.0 + k[2] / 3.0 + k[3] / 6.0;
}

Matrix3d inertia_in_world(const Matrix3d& inertia_body, const Quaterniond& q) {
  Matrix3d inertia_world;
  for (int i = 0; i < 3; ++i)
    inertia_world.col(i) =
        q * Vector3d(inertia_body * (q.conjugate() * Vector3d(Vector3d::Unit(i))));
  return inertia_world;
}

VectorXd rigid_body_derivative(const RigidBodyState& state, const Inertia& inertia,
                               const Wrench& wrench) {
  const Quaterniond& q = state.world_from_body;
  const Vector3d omega_body =
      inertia.inverse_inertia_body * (q.conjugate() * state.angular_momentum_world);
  const Vector3d w = q * omega_body, v = q.vec();
  VectorXd rate(13);
  rate << inertia.inverse_mass * state.momentum_world, -0.5 * w.dot(v),
      0.5 * (q.w() * w + w.cross(v)), wrench.force_world, wrench.torque_world;
  return rate;
}

Quaterniond renormalize(const Quaterniond& q) {
  return Quaterniond(q.coeffs() / q.coeffs().norm());
}

Matrix3d orthonormalize(const Matrix3d& drifted) {
  // The modified order: as soon as a column is ready, its share is taken off all that follow.
  Matrix3d R = drifted;
  for (int i = 0; i < 3; ++i) {
    R.col(i).normalize();
    for (int j = i + 1; j < 3; ++j) R.col(j) -= R.col(i).dot(R.col(j)) * R.col(i);
  }
  return R;
}

Matrix3d rotation_from_euler_angles(double yaw, double pitch, double roll) {
  const Quaterniond turn_z(std::cos(yaw / 2), 0, 0, std::sin(yaw / 2));
  const Quaterniond turn_y(std::cos(pitch / 2), 0, std::sin(pitch / 2), 0);
  const Quaterniond turn_x(std::cos(roll / 2), std::sin(roll / 2), 0, 0);
  return (turn_z * turn_y * turn_x).toRotationMatrix();
}

EulerAngles euler_angles_from_rotation(const Matrix3d& R) {
  const double cos_pitch = std::hypot(R(0, 0), R(1, 0));
  const double pitch = std::atan2(-R(2, 0), cos_pitch);
  if (cos_pitch < 1e-8) return {.yaw = std::atan2(-R(0, 1), R(1, 1)), .pitch = pitch, .roll = 0.0};
  // Roll is what is left after yaw is undone: whatever rounding did to yaw, the two together are
  // right.
  const double yaw = std::atan2(R(1, 0), R(0, 0)), c = std::cos(yaw), s = std::sin(yaw);
  return {.yaw = yaw,
          .pitch = pitch,
          .roll = std::atan2(s * R(0, 2) - c * R(1, 2), c * R(1, 1) - s * R(0, 1))};
}

namespace {

/// Cuts [a, b] at times that `propose` names, as long as they lie inside, and at the middle
/// otherwise.
template <class Propose>
RootResult close_bracket(const ScalarFunction& gap, double a, double b, double tolerance,
                         Propose&& propose) {
  RootResult r{RootStatus::kConverged, kUnset, kUnset, 2};
  double g_a = gap(a), g_b = gap(b);
  if (std::isnan(g_a) || std::isnan(g_b)) {
    r.status = RootStatus::kNotConverged;
    if (g_a >= 0) r.time = a, r.residual = g_a;
    return r;
  }
  if (g_a < 0 || (g_a > 0 && g_b > 0)) {
    r.status = RootStatus::kNoSignChange;
    return r;
  }
  if (g_a != 0 && g_b == 0) {
    r.time = b;
    r.residual = 0;
    return r;
  }
  while (g_a != 0 && b - a > tolerance) {
    const double middle = std::midpoint(a, b);
    if (middle <= a || middle >= b) break;
    double t = propose(a, g_a, b, g_b);
    if (!(t > a && t < b)) t = middle;
    const double g = gap(t);
    ++r.evaluations;
    if (std::isnan(g)) {
      r.status = RootStatus::kNotConverged;
      break;
    }
    if (g >= 0)
      a = t, g_a = g;
    else
      b = t, g_b = g;
  }
  r.time = a;
  r.residual = g_a;
  return r;
}

}  // namespace

RootResult impact_time_bisection(const ScalarFunction& gap, double t_low, double t_high,
                                 double tolerance) {
  return close_bracket(gap, t_low, t_high, tolerance,
                       [](double, double, double, double) { return kUnset; });
}

RootResult impact_time_newton(const ScalarFunction& gap, const ScalarFunction& gap_rate,
                              double t_low, double t_high, double tolerance) {
  // In turn: Newton from the better end, the same and a hair beyond, the middle. Newton's own
  // convergence makes the first two close the bracket from both sides; the third guarantees that it
  // closes at all.
  int turn = 0;
  const auto propose = [&](double a, double g_a, double b, double g_b) {
    if (turn++ % 4 == 3) return kUnset;
    const bool from_a = g_a <= -g_b;
    const double t = from_a ? a : b, step = -(from_a ? g_a : g_b) / gap_rate(t);
    const double spacing = 2.3e-16 * std::abs(t) * (1 << (turn % 4));
    const double hair = std::max(0.4 * tolerance, spacing);
    return t + step + (from_a ? hair : -hair);
  };
  return close_bracket(gap, t_low, t_high, tolerance, propose);
}

}  // namespace tumble::a2
