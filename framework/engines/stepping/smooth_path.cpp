#include "framework/engines/stepping/smooth_path.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "framework/dynamics/world.h"

namespace tumble::engines {
namespace {

Quaterniond exponential(const Vector3d& rotation) {
  const double angle = rotation.norm();
  if (angle < 1e-8)
    return Quaterniond(1.0, 0.5 * rotation.x(), 0.5 * rotation.y(), 0.5 * rotation.z())
        .normalized();
  return Quaterniond(Eigen::AngleAxisd(angle, rotation / angle));
}

Vector3d logarithm(Quaterniond q) {
  if (q.w() < 0) q.coeffs() *= -1.0;
  const double sine = q.vec().norm();
  return sine < 1e-12 ? Vector3d(2.0 * q.vec())
                      : Vector3d(q.vec() * (2.0 * std::atan2(sine, q.w()) / sine));
}

// The angular velocity, in the turned frame, of exp(phi(t)) is turning(phi) phi' (the right
// Jacobian of SO(3)):
//   J = 1 - (1 - cos a) / a^2 [phi] + (a - sin a) / a^3 [phi]^2,   a = |phi|
Matrix3d skew(const Vector3d& v) {
  Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}
Matrix3d turning(const Vector3d& phi) {
  const double a = phi.norm();
  const Matrix3d s = skew(phi);
  if (a < 1e-4) return Matrix3d::Identity() - 0.5 * s + s * s / 6.0;
  return Matrix3d::Identity() - (1 - std::cos(a)) / (a * a) * s +
         (a - std::sin(a)) / (a * a * a) * s * s;
}

void hermite(const Vector3d& from, const Vector3d& slope_from, const Vector3d& to,
             const Vector3d& slope_to, Vector3d* c) {
  c[0] = from;
  c[1] = slope_from;
  const Vector3d way = to - from;
  c[2] = 3.0 * way - 2.0 * slope_from - slope_to;
  c[3] = slope_from + slope_to - 2.0 * way;
}
Vector3d value(const Vector3d* c, double s) { return c[0] + s * (c[1] + s * (c[2] + s * c[3])); }
Vector3d slope(const Vector3d* c, double s) { return c[1] + s * (2.0 * c[2] + s * 3.0 * c[3]); }

}  // namespace

SmoothPath::SmoothPath(const RigidBodyState& start, const RigidBodyState& end,
                       const Inertia& inertia, double t0, double t1, Momenta momenta)
    : t0_(t0),
      h_(t1 - t0),
      inertia_(inertia),
      is_worked_out_(false),
      from_(start),
      to_(end),
      start_(start.world_from_body),
      momenta_(momenta),
      momentum_{start.momentum_world, end.momentum_world},
      angular_momentum_{start.angular_momentum_world, end.angular_momentum_world} {}

double turning_speed_of(const RigidBodyState& state, const Inertia& inertia) {
  return (inertia.inverse_inertia_body *
          (state.world_from_body.conjugate() * state.angular_momentum_world))
      .norm();
}

double SmoothPath::turning_at_ends() const {
  return h_ * std::max(turning_speed_of(from_, inertia_), turning_speed_of(to_, inertia_));
}

void SmoothPath::find_polynomials() const {
  is_worked_out_ = true;
  const RigidBodyState &start = from_, &end = to_;
  const Inertia& inertia = inertia_;
  hermite(start.com_world, h_ * inertia.inverse_mass * start.momentum_world, end.com_world,
          h_ * inertia.inverse_mass * end.momentum_world, x_);

  const Vector3d turn_start = h_ * (start.world_from_body.conjugate() * omega_of(start, inertia));
  const Vector3d turn_end = h_ * (end.world_from_body.conjugate() * omega_of(end, inertia));
  Vector3d whole = logarithm(start.world_from_body.conjugate() * end.world_from_body);
  // More than half a turn in the step: the logarithm is some whole turns short.
  const Vector3d expected = 0.5 * (turn_start + turn_end);
  if (const double angle = whole.norm(); angle > 0) {
    const double turns = std::round((expected.dot(whole) / angle - angle) / (2 * std::numbers::pi));
    whole *= 1.0 + turns * 2 * std::numbers::pi / angle;
  }
  hermite(Vector3d::Zero(), turn_start, whole, turning(whole).inverse() * turn_end, phi_);

  // The second derivative of a cubic is linear, so its ends bound it; the first one lies in the
  // hull of its control points.
  const Vector3d a0 = 2.0 * x_[2] / (h_ * h_), a1 = (2.0 * x_[2] + 6.0 * x_[3]) / (h_ * h_);
  bounds_.acceleration_world = 0.5 * (a0 + a1);
  bounds_.acceleration_deviation = 0.5 * (a1 - a0).norm();
  const Vector3d p0 = phi_[1], p1 = phi_[1] + phi_[2], p2 = slope(phi_, 1.0);
  bounds_.angular_speed = std::max({p0.norm(), p1.norm(), p2.norm()}) / h_;  // |J phi'| <= |phi'|
  const double second =
      std::max((2.0 * phi_[2]).norm(), (2.0 * phi_[2] + 6.0 * phi_[3]).norm()) / (h_ * h_);
  // |J'| <= |phi'| / 2 + |phi'| / 3
  bounds_.angular_acceleration = second + bounds_.angular_speed * bounds_.angular_speed;
  at_start_ = motion_of(0.0);
}

Vector3d SmoothPath::omega_world(double s, Quaterniond& world_from_body) const {
  work_out();
  const Vector3d phi = value(phi_, s);
  world_from_body = (start_ * exponential(phi)).normalized();
  return world_from_body * (turning(phi) * slope(phi_, s) / h_);
}

RigidBodyState SmoothPath::at(double t) const {
  const double s = (t - t0_) / h_;
  work_out();
  RigidBodyState state;
  state.com_world = value(x_, s);
  const Vector3d omega = omega_world(s, state.world_from_body);
  if (momenta_ == Momenta::kEven) {
    state.momentum_world = (1 - s) * momentum_[0] + s * momentum_[1];
    state.angular_momentum_world = (1 - s) * angular_momentum_[0] + s * angular_momentum_[1];
    return state;
  }
  state.momentum_world = inertia_.mass * slope(x_, s) / h_;
  state.angular_momentum_world = angular_momentum_of(omega, state.world_from_body, inertia_);
  return state;
}

collision::MotionState SmoothPath::motion_of(double s) const {
  collision::MotionState motion;
  motion.pose.com_world = value(x_, s);
  motion.omega_world = omega_world(s, motion.pose.world_from_body);
  motion.velocity_world = slope(x_, s) / h_;
  return motion;
}

collision::MotionState SmoothPath::motion_at(double t) const {
  work_out();
  return t == t0_ ? at_start_ : motion_of((t - t0_) / h_);
}

}  // namespace tumble::engines
