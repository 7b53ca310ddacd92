// A right solution after the textbooks: Numerical Recipes' rtsafe, its bracket closed at the end;
// (A2.7) in the printed order, rotations as products of three matrices, pitch by atan2, the
// derivative by the matrix of (0, w).
#include "assignments/a2_integration/a2_integration.h"

#include <array>
#include <cmath>

namespace tumble::a2 {

VectorXd euler_step(const OdeFunction& f, double t, const VectorXd& y, double h) {
  VectorXd next = f(t, y);
  next *= h;
  next += y;
  return next;
}

VectorXd rk4_step(const OdeFunction& f, double t, const VectorXd& y, double h) {
  const VectorXd d1 = h * f(t, y);
  const VectorXd d2 = h * f(t + 0.5 * h, y + 0.5 * d1);
  const VectorXd d3 = h * f(t + 0.5 * h, y + 0.5 * d2);
  const VectorXd d4 = h * f(t + h, y + d3);
  return y + d1 / 6.0 + d2 / 3.0 + d3 / 3.0 + d4 / 6.0;
}

Matrix3d inertia_in_world(const Matrix3d& inertia_body, const Quaterniond& world_from_body) {
  // Column by column: turn the tensor's columns, then its rows.
  Matrix3d half, whole;
  for (int k = 0; k < 3; ++k) half.col(k) = world_from_body * Vector3d(inertia_body.col(k));
  for (int k = 0; k < 3; ++k) whole.col(k) = world_from_body * Vector3d(half.row(k));
  return whole;
}

VectorXd rigid_body_derivative(const RigidBodyState& state, const Inertia& inertia,
                               const Wrench& wrench) {
  const Quaterniond& q = state.world_from_body;
  const Vector3d w =
      q * Vector3d(inertia.inverse_inertia_body * (q.conjugate() * state.angular_momentum_world));
  Eigen::Matrix4d turning;  // of (w x y z), from the left
  turning << 0, -w.x(), -w.y(), -w.z(), w.x(), 0, -w.z(), w.y(), w.y(), w.z(), 0, -w.x(), w.z(),
      -w.y(), w.x(), 0;
  VectorXd rate(13);
  rate << state.momentum_world * inertia.inverse_mass,
      0.5 * (turning * Eigen::Vector4d(q.w(), q.x(), q.y(), q.z())), wrench.force_world,
      wrench.torque_world;
  return rate;
}

Quaterniond renormalize(const Quaterniond& world_from_body) {
  const double length = world_from_body.coeffs().stableNorm();
  Quaterniond q;
  q.coeffs() = world_from_body.coeffs() / length;
  return q;
}

Matrix3d orthonormalize(const Matrix3d& drifted_world_from_body) {
  const Vector3d a = drifted_world_from_body.col(0), b = drifted_world_from_body.col(1),
                 c = drifted_world_from_body.col(2);
  const Vector3d x = a / std::sqrt(a.dot(a));
  Vector3d y = b - x.dot(b) * x;
  y /= std::sqrt(y.dot(y));
  Vector3d z = c - x.dot(c) * x - y.dot(c) * y;
  z /= std::sqrt(z.dot(z));
  Matrix3d R;
  for (int i = 0; i < 3; ++i) R.row(i) << x[i], y[i], z[i];
  return R;
}

Matrix3d rotation_from_euler_angles(double yaw, double pitch, double roll) {
  const auto c = [](double a) { return std::cos(a); };
  const auto s = [](double a) { return std::sin(a); };
  Matrix3d z, y, x;
  z << c(yaw), -s(yaw), 0, s(yaw), c(yaw), 0, 0, 0, 1;
  y << c(pitch), 0, s(pitch), 0, 1, 0, -s(pitch), 0, c(pitch);
  x << 1, 0, 0, 0, c(roll), -s(roll), 0, s(roll), c(roll);
  return z * (y * x);
}

EulerAngles euler_angles_from_rotation(const Matrix3d& R) {
  EulerAngles e;
  const double c = std::hypot(R(1, 0), R(0, 0));
  const bool locked = c < 1e-8;
  e.yaw = locked ? std::atan2(-R(0, 1), R(1, 1)) : std::atan2(R(1, 0), R(0, 0));
  e.pitch = std::atan2(-R(2, 0), c);
  e.roll = locked ? 0 : std::atan2(R(2, 1), R(2, 2));
  return e;
}

namespace {

struct Seen {
  double t, g;
};

/// Looks at g, and counts.
struct Counted {
  const ScalarFunction& gap;
  int calls = 0;
  Seen at(double t) {
    ++calls;
    return {t, gap(t)};
  }
};

RootResult answer(RootStatus status, const Seen& seen, int calls) {
  return {status, seen.t, seen.g, calls};
}

/// What the two ends alone decide; kConverged with NaN for a time: nothing, search on.
RootResult at_the_ends(const Seen& a, const Seen& b, int calls) {
  const Seen nowhere{kUnset, kUnset};
  if (std::isnan(a.g)) return answer(RootStatus::kNotConverged, nowhere, calls);
  if (a.g < 0) return answer(RootStatus::kNoSignChange, nowhere, calls);
  if (a.g == 0) return answer(RootStatus::kConverged, a, calls);
  if (std::isnan(b.g)) return answer(RootStatus::kNotConverged, a, calls);
  if (b.g > 0) return answer(RootStatus::kNoSignChange, nowhere, calls);
  if (b.g == 0) return answer(RootStatus::kConverged, b, calls);
  return answer(RootStatus::kConverged, nowhere, calls);
}

RootResult halve(Counted& g, Seen a, Seen b, double tolerance) {
  while (b.t - a.t > tolerance) {
    const double t = 0.5 * (a.t + b.t);
    if (t == a.t || t == b.t) break;
    const Seen m = g.at(t);
    if (std::isnan(m.g)) return answer(RootStatus::kNotConverged, a, g.calls);
    if (m.g == 0) return answer(RootStatus::kConverged, m, g.calls);
    (m.g > 0 ? a : b) = m;
  }
  return answer(RootStatus::kConverged, a, g.calls);
}

}  // namespace

RootResult impact_time_bisection(const ScalarFunction& gap, double t_low, double t_high,
                                 double tolerance) {
  Counted g{gap};
  const Seen a = g.at(t_low), b = g.at(t_high);
  const RootResult ends = at_the_ends(a, b, g.calls);
  if (ends.status != RootStatus::kConverged || !std::isnan(ends.time)) return ends;
  return halve(g, a, b, tolerance);
}

RootResult impact_time_newton(const ScalarFunction& gap, const ScalarFunction& gap_rate,
                              double t_low, double t_high, double tolerance) {
  Counted g{gap};
  Seen a = g.at(t_low), b = g.at(t_high);
  const RootResult ends = at_the_ends(a, b, g.calls);
  if (ends.status != RootStatus::kConverged || !std::isnan(ends.time)) return ends;

  // rtsafe: from the middle; Newton where it stays inside and its steps halve, else bisection.
  Seen t = g.at(0.5 * (a.t + b.t));
  double step_before = b.t - a.t, step = step_before;
  for (int i = 0; i < 100; ++i) {
    if (std::isnan(t.g)) return answer(RootStatus::kNotConverged, a, g.calls);
    if (t.g == 0) return answer(RootStatus::kConverged, t, g.calls);
    (t.g > 0 ? a : b) = t;
    if (b.t - a.t <= tolerance) return answer(RootStatus::kConverged, a, g.calls);
    const double slope = gap_rate(t.t), newton = t.t - t.g / slope;
    const bool good =
        newton > a.t && newton < b.t && std::abs(newton - t.t) <= 0.5 * std::abs(step_before);
    const double next = good ? newton : 0.5 * (a.t + b.t);
    step_before = step;
    step = next - t.t;
    // Small enough: where it would go is the root, and what is left is to see it from either side.
    if (std::abs(step) <= 0.25 * tolerance || next == a.t || next == b.t || next == t.t) break;
    t = g.at(next);
  }
  // Past the root by a hair, and by more and more, from the side that has come near.
  const bool from_open = t.t == a.t;
  for (double hair = std::max(0.5 * tolerance, 4e-16 * std::abs(t.t));
       b.t - a.t > tolerance && hair < b.t - a.t; hair *= 8) {
    const double probe = from_open ? t.t + hair : t.t - hair;
    if (!(probe > a.t && probe < b.t)) break;
    const Seen seen = g.at(probe);
    if (std::isnan(seen.g)) return answer(RootStatus::kNotConverged, a, g.calls);
    if (seen.g == 0) return answer(RootStatus::kConverged, seen, g.calls);
    const bool other_side = (seen.g > 0) != from_open;
    (seen.g > 0 ? a : b) = seen;
    if (other_side) break;
  }
  return halve(g, a, b, tolerance);
}

}  // namespace tumble::a2
