// Reference solution of assignment 2. Equations (A2.n) stand in a2_integration.h and in the
// handout.
#include "assignments/a2_integration/a2_integration.h"

#include <algorithm>
#include <cmath>

namespace tumble::a2 {

VectorXd euler_step(const OdeFunction& f, double t, const VectorXd& y, double h) {
  return y + h * f(t, y);
}

VectorXd rk4_step(const OdeFunction& f, double t, const VectorXd& y, double h) {
  const VectorXd k1 = f(t, y);
  const VectorXd k2 = f(t + h / 2, y + h / 2 * k1);
  const VectorXd k3 = f(t + h / 2, y + h / 2 * k2);
  const VectorXd k4 = f(t + h, y + h * k3);
  return y + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
}

Matrix3d inertia_in_world(const Matrix3d& inertia_body, const Quaterniond& world_from_body) {
  const Matrix3d R = world_from_body.toRotationMatrix();
  return R * inertia_body * R.transpose();
}

VectorXd rigid_body_derivative(const RigidBodyState& state, const Inertia& inertia,
                               const Wrench& wrench) {
  // (A2.5), multiplied from the right, so that no world inverse inertia is ever formed.
  const Quaterniond& q = state.world_from_body;
  const Matrix3d R = q.toRotationMatrix();
  const Vector3d omega_world =
      R * (inertia.inverse_inertia_body * (R.transpose() * state.angular_momentum_world));

  // (A2.4). Eigen's constructor takes w first, its product is Hamilton's.
  const Quaterniond two_q_rate =
      Quaterniond(0.0, omega_world.x(), omega_world.y(), omega_world.z()) * q;
  RigidBodyState rate;
  rate.com_world = inertia.inverse_mass * state.momentum_world;
  rate.world_from_body.coeffs() = 0.5 * two_q_rate.coeffs();
  rate.momentum_world = wrench.force_world;
  rate.angular_momentum_world = wrench.torque_world;
  return pack(rate);
}

Quaterniond renormalize(const Quaterniond& world_from_body) { return world_from_body.normalized(); }

Matrix3d orthonormalize(const Matrix3d& drifted_world_from_body) {
  const Vector3d b = drifted_world_from_body.col(1), c = drifted_world_from_body.col(2);
  const Vector3d x = drifted_world_from_body.col(0).normalized();
  const Vector3d y = (b - x.dot(b) * x).normalized();
  // The projection on y is taken off what is left of c: with b nearly along a this loses less than
  // the textbook's order.
  const Vector3d c_without_x = c - x.dot(c) * x;
  Matrix3d R;
  R << x, y, (c_without_x - y.dot(c_without_x) * y).normalized();
  return R;
}

Matrix3d rotation_from_euler_angles(double yaw, double pitch, double roll) {
  using Eigen::AngleAxisd;
  return (AngleAxisd(yaw, Vector3d::UnitZ()) * AngleAxisd(pitch, Vector3d::UnitY()) *
          AngleAxisd(roll, Vector3d::UnitX()))
      .toRotationMatrix();
}

EulerAngles euler_angles_from_rotation(const Matrix3d& world_from_body) {
  const Matrix3d& R = world_from_body;
  // of cos(pitch): below it, rounding has eaten half the digits of yaw and roll
  constexpr double kGimbalLock = 1e-8;
  const double cos_pitch = std::hypot(R(0, 0), R(1, 0));
  EulerAngles angles;
  angles.pitch = std::atan2(-R(2, 0), cos_pitch);
  if (cos_pitch < kGimbalLock) {
    angles.yaw = std::atan2(-R(0, 1), R(1, 1));
    angles.roll = 0.0;
  } else {
    angles.yaw = std::atan2(R(1, 0), R(0, 0));
    angles.roll = std::atan2(R(2, 1), R(2, 2));
  }
  return angles;
}

namespace {

/// The interval in which the gap closes: open at one end, closed at the other, shrinking with each
/// look at the gap.
class Bracket {
 public:
  Bracket(const ScalarFunction& gap, double t_low, double t_high, double tolerance)
      : gap_(gap),
        tolerance_(tolerance),
        open_{t_low, look(t_low)},
        closed_{t_high, look(t_high)} {}

  struct End {
    double time, gap;
  };
  const End& open() const { return open_; }
  const End& closed() const { return closed_; }
  double width() const { return closed_.time - open_.time; }
  double middle() const { return open_.time + width() / 2; }
  bool contains(double t) const { return open_.time < t && t < closed_.time; }  // false for NaN
  bool has_no_impact() const { return open_.gap < 0 || (open_.gap > 0 && closed_.gap > 0); }
  bool is_searched() const {
    return saw_nan_ || open_.gap == 0 || closed_.gap == 0 || width() <= tolerance_ ||
           !contains(middle());
  }

  /// Looks at the gap at t inside, and keeps the part in which it closes.
  void cut(double t) {
    const End end{t, look(t)};
    if (end.gap >= 0)
      open_ = end;
    else
      closed_ = end;
  }

  RootResult result() const {
    if (saw_nan_)
      return {RootStatus::kNotConverged, open_.gap >= 0 ? open_.time : kUnset,
              open_.gap >= 0 ? open_.gap : kUnset, looks_};
    if (has_no_impact()) return {RootStatus::kNoSignChange, kUnset, kUnset, looks_};
    const End& end = closed_.gap == 0 && open_.gap != 0 ? closed_ : open_;
    return {RootStatus::kConverged, end.time, end.gap, looks_};
  }

 private:
  double look(double t) {
    ++looks_;
    const double gap = gap_(t);
    saw_nan_ = saw_nan_ || std::isnan(gap);
    return gap;
  }

  const ScalarFunction& gap_;
  double tolerance_;
  int looks_ = 0;  // before the ends, whose initialisation counts looks
  bool saw_nan_ = false;
  End open_, closed_;
};

}  // namespace

RootResult impact_time_bisection(const ScalarFunction& gap, double t_low, double t_high,
                                 double tolerance) {
  Bracket bracket(gap, t_low, t_high, tolerance);
  if (bracket.has_no_impact()) return bracket.result();
  while (!bracket.is_searched()) bracket.cut(bracket.middle());
  return bracket.result();
}

RootResult impact_time_newton(const ScalarFunction& gap, const ScalarFunction& gap_rate,
                              double t_low, double t_high, double tolerance) {
  constexpr int kPatience = 3;  // looks in which the bracket has to halve, or else it is halved
  Bracket bracket(gap, t_low, t_high, tolerance);
  if (bracket.has_no_impact()) return bracket.result();
  double width_to_beat = bracket.width() / 2;
  int looks_left = kPatience;
  int looks_on_one_side = 0;
  while (!bracket.is_searched()) {
    // Newton from the end that is nearer to the root.
    const bool from_open = std::abs(bracket.open().gap) <= std::abs(bracket.closed().gap);
    const auto& [t, g] = from_open ? bracket.open() : bracket.closed();
    const double newton = t - g / gap_rate(t);

    // A hair further, so that the root lies between t and the next t and the bracket can close from
    // both sides. The hair doubles while the root is still beyond it: rounding may have moved it by
    // several spacings of doubles.
    const double spacing = std::nextafter(std::abs(t), INFINITY) - std::abs(t);
    const double hair = std::max(tolerance / 2, std::ldexp(spacing, looks_on_one_side));
    const double next = from_open ? newton + hair : newton - hair;

    const bool trusted = bracket.contains(next) && looks_left > 0;
    const double open_before = bracket.open().time;
    bracket.cut(trusted ? next : bracket.middle());
    const bool stayed = (bracket.open().time != open_before) == from_open;
    if (trusted) looks_on_one_side = stayed ? looks_on_one_side + 1 : 0;
    --looks_left;
    if (bracket.width() <= width_to_beat) {
      width_to_beat = bracket.width() / 2;
      looks_left = kPatience;
    }
  }
  return bracket.result();
}

}  // namespace tumble::a2
