// A right solution, written with loops and components where the reference uses Eigen's words;
// Newton as in textbooks: an iterate, the last steps, and a bracket closed at the end.
#include "assignments/a2_integration/a2_integration.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace tumble::a2 {
namespace {

VectorXd moved(VectorXd y, double h, const VectorXd& slope) {
  for (Eigen::Index i = 0; i < y.size(); ++i) y[i] += h * slope[i];
  return y;
}

Matrix3d matrix_of(const Quaterniond& q) {
  const double w = q.w(), x = q.x(), y = q.y(), z = q.z();
  Matrix3d R;
  R << 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y), 2 * (x * y + w * z),
      1 - 2 * (x * x + z * z), 2 * (y * z - w * x), 2 * (x * z - w * y), 2 * (y * z + w * x),
      1 - 2 * (x * x + y * y);
  return R;
}

}  // namespace

VectorXd euler_step(const OdeFunction& f, double t, const VectorXd& y, double h) {
  return moved(y, h, f(t, y));
}

VectorXd rk4_step(const OdeFunction& f, double t, const VectorXd& y, double h) {
  const double where[] = {0, 0.5, 0.5, 1}, weight[] = {1, 2, 2, 1};
  VectorXd slope = VectorXd::Zero(y.size()), sum = slope;
  for (int i = 0; i < 4; ++i) {
    slope = f(t + where[i] * h, moved(y, where[i] * h, slope));
    sum = moved(sum, weight[i], slope);
  }
  return moved(y, h / 6, sum);
}

Matrix3d inertia_in_world(const Matrix3d& inertia_body, const Quaterniond& world_from_body) {
  const Matrix3d R = matrix_of(world_from_body);
  Matrix3d inertia_world = Matrix3d::Zero();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k)
        for (int l = 0; l < 3; ++l) inertia_world(i, j) += R(i, k) * inertia_body(k, l) * R(j, l);
  return inertia_world;
}

VectorXd rigid_body_derivative(const RigidBodyState& state, const Inertia& inertia,
                               const Wrench& wrench) {
  const Quaterniond& q = state.world_from_body;
  const Vector3d momentum_body = matrix_of(q).transpose() * state.angular_momentum_world;
  // body frame: q' = 1/2 q (0, w_body)
  const Vector3d w = inertia.inverse_inertia_body * momentum_body;
  VectorXd rate(kStateSize);
  rate.segment<3>(0) = state.momentum_world * inertia.inverse_mass;
  rate[3] = -0.5 * (q.x() * w.x() + q.y() * w.y() + q.z() * w.z());
  rate[4] = 0.5 * (q.w() * w.x() + q.y() * w.z() - q.z() * w.y());
  rate[5] = 0.5 * (q.w() * w.y() + q.z() * w.x() - q.x() * w.z());
  rate[6] = 0.5 * (q.w() * w.z() + q.x() * w.y() - q.y() * w.x());
  rate.segment<3>(7) = wrench.force_world;
  rate.segment<3>(10) = wrench.torque_world;
  return rate;
}

Quaterniond renormalize(const Quaterniond& q) {
  const double length = std::sqrt(q.w() * q.w() + q.x() * q.x() + q.y() * q.y() + q.z() * q.z());
  return {q.w() / length, q.x() / length, q.y() / length, q.z() / length};
}

Matrix3d orthonormalize(const Matrix3d& drifted) {
  Matrix3d R;
  R.col(0) = drifted.col(0) / drifted.col(0).norm();
  R.col(1) = drifted.col(1) - R.col(0).dot(drifted.col(1)) * R.col(0);
  R.col(1) /= R.col(1).norm();
  R.col(2) = R.col(0).cross(R.col(1));
  return R;
}

Matrix3d rotation_from_euler_angles(double yaw, double pitch, double roll) {
  const double cy = std::cos(yaw), sy = std::sin(yaw), cp = std::cos(pitch), sp = std::sin(pitch),
               cr = std::cos(roll), sr = std::sin(roll);
  Matrix3d R;
  R << cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr, sy * cp, sy * sp * sr + cy * cr,
      sy * sp * cr - cy * sr, -sp, cp * sr, cp * cr;
  return R;
}

EulerAngles euler_angles_from_rotation(const Matrix3d& R) {
  const double c = std::sqrt(R(0, 0) * R(0, 0) + R(1, 0) * R(1, 0));
  if (c < 1e-8) return {std::atan2(-R(0, 1), R(1, 1)), std::atan2(-R(2, 0), c), 0.0};
  return {std::atan2(R(1, 0), R(0, 0)), std::atan2(-R(2, 0), c), std::atan2(R(2, 1), R(2, 2))};
}

RootResult impact_time_bisection(const ScalarFunction& gap, double t_low, double t_high,
                                 double tolerance) {
  RootResult r;
  const double g_low = gap(t_low), g_high = gap(t_high);
  r.evaluations = 2;
  if (std::isnan(g_low) || std::isnan(g_high)) {  // as not converged, from the start of it
    if (g_low >= 0) r.time = t_low, r.residual = g_low;
    return r;
  }
  if (g_low < 0 || (g_low > 0 && g_high > 0)) {
    r.status = RootStatus::kNoSignChange;
    return r;
  }
  r.status = RootStatus::kConverged;
  r.time = g_low == 0 || g_high < 0 ? t_low : t_high;
  r.residual = g_low == 0 || g_high < 0 ? g_low : g_high;
  while (r.residual != 0 && t_high - r.time > tolerance) {
    const double m = 0.5 * (r.time + t_high);
    if (m == r.time || m == t_high) break;
    const double g = gap(m);
    ++r.evaluations;
    if (std::isnan(g)) {
      r.status = RootStatus::kNotConverged;
      break;
    }
    if (g < 0) {
      t_high = m;
    } else {
      r.time = m;
      r.residual = g;
    }
  }
  return r;
}

RootResult impact_time_newton(const ScalarFunction& gap, const ScalarFunction& gap_rate,
                              double t_low, double t_high, double tolerance) {
  int evaluations = 0;
  bool saw_nan = false;
  const auto g = [&](double t) {
    ++evaluations;
    const double value = gap(t);
    saw_nan = saw_nan || std::isnan(value);
    return value;
  };
  double a = t_low, b = t_high, g_a = g(a), g_b = g(b);
  const auto done = [&](RootStatus status, double t, double residual) {
    return RootResult{status, t, residual, evaluations};
  };
  const auto not_converged = [&] {
    return done(RootStatus::kNotConverged, g_a >= 0 ? a : kUnset, g_a >= 0 ? g_a : kUnset);
  };
  if (saw_nan) return not_converged();
  if (g_a < 0 || (g_a > 0 && g_b > 0)) return done(RootStatus::kNoSignChange, kUnset, kUnset);
  if (g_a == 0) return done(RootStatus::kConverged, a, 0.0);
  if (g_b == 0) return done(RootStatus::kConverged, b, 0.0);
  const auto cut = [&](double t, double g_t) {
    if (saw_nan) return;
    g_t >= 0 ? (a = t, g_a = g_t) : (b = t, g_b = g_t);
  };

  // Newton's iterate, until its step is small; a midpoint where the step is no good or not half the
  // one before last.
  double t = a + (b - a) / 2, last = b - a, before_last = b - a;
  for (int i = 0; i < 200 && b - a > tolerance; ++i) {
    const double g_t = g(t);
    if (saw_nan) return not_converged();
    if (g_t == 0) return done(RootStatus::kConverged, t, 0.0);
    cut(t, g_t);
    double next = t - g_t / gap_rate(t);
    // t is the root, as well as Newton knows
    if (std::abs(next - t) <= std::max(tolerance / 8, 4e-16 * std::abs(t))) break;
    if (!(next > a && next < b) || !(std::abs(next - t) <= before_last / 2)) next = a + (b - a) / 2;
    before_last = last;
    last = std::abs(next - t);
    t = next;
  }
  // Close the bracket around it: look a little to either side, further and further, then halve what
  // is left.
  for (double reach = std::max(tolerance / 4, 4e-16 * std::abs(t));
       b - a > tolerance && reach < b - a && !saw_nan; reach *= 4) {
    const double before = a, after = b;
    for (const double probe : {t - reach, t + reach})
      if (!saw_nan && probe > a && probe < b) cut(probe, g(probe));
    if (a != before && b != after) break;
  }
  while (b - a > tolerance && g_a != 0 && !saw_nan) {
    const double m = a + (b - a) / 2;
    if (m <= a || m >= b) break;
    cut(m, g(m));
  }
  return saw_nan ? not_converged() : done(RootStatus::kConverged, a, g_a);
}

}  // namespace tumble::a2
