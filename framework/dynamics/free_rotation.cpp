// Inside, numbers are `long double` (64 bits of mantissa or more where Debian runs): the closed
// forms lose nothing to large angles (1e7 rad), and the rounding of thousands of Taylor steps stays
// below that of the double answer.
#include "framework/dynamics/free_rotation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "framework/core/decompositions.h"
#include "framework/core/error.h"

namespace tumble {
namespace {

using Real = long double;
using Real3 = Eigen::Matrix<Real, 3, 1>;
using RealQuaternion = Eigen::Quaternion<Real>;

/// Spin in the frame of the principal axes.
struct RealSpin {
  RealQuaternion q;
  Real3 w;
};

/// Turn by `rate` * t about it.
RealQuaternion turn(const Real3& rate, Real t) {
  const Real speed = rate.norm();
  const Real half = 0.5L * speed * t;
  if (speed == 0.0L) return RealQuaternion::Identity();
  const Real3 v = rate * (std::sin(half) / speed);
  return {std::cos(half), v.x(), v.y(), v.z()};
}

// ---- Symmetric top ------------------------------------------------------------------------------

// With It twice, Is about the axis of symmetry s, and lam = w_s (It - Is) / It:
//   R(t) = exp(t [L / It]) R(0) exp(t lam [s])       L = R(0) I w, world                      (F.2)
//   w(t) = exp(-t lam [s]) w(0)
//       the body sees its own spin precess about s                                            (F.3)
// Source: Landau and Lifshitz, section 33 (regular precession).
RealSpin turn_symmetric(const Real3& moments, int axis, const RealSpin& start, Real t) {
  const Real transverse = 0.5L * (moments[(axis + 1) % 3] + moments[(axis + 2) % 3]);
  const Real lam = start.w[axis] * (transverse - moments[axis]) / transverse;
  Real3 I_w = moments.cwiseProduct(start.w);
  I_w[(axis + 1) % 3] = transverse * start.w[(axis + 1) % 3];
  I_w[(axis + 2) % 3] = transverse * start.w[(axis + 2) % 3];
  const RealQuaternion about_axis = turn(lam * Real3::Unit(axis), t);
  return {turn(start.q * (I_w / transverse), t) * start.q * about_axis,
          about_axis.conjugate() * start.w};
}

// ---- Asymmetric top: Taylor series --------------------------------------------------------------

// (F.1) in the principal frame: the right-hand side is quadratic, so the coefficients follow from
// sums of products.
//   (k+1) w1[k+1] = (I2 - I3) / I1  sum_j w2[j] w3[k-j]      and cyclic                       (F.4)
//   (k+1) q[k+1]  = 1/2  sum_j q[j] (0, w[k-j])                                               (F.5)
// Source: A. Jorba, M. Zou, "A software package for the numerical integration of ODEs by means of
// high-order Taylor methods", Experimental Mathematics 14, 2005 (also for the step and the order).
// -ln(kTaylorError) / 2, where the cost a unit of time is smallest
constexpr int kOrder = 24;
constexpr Real kTaylorError = 1e-20L;  // of a step, relative: below the rounding of `long double`

using Series = std::array<std::array<Real, kOrder + 1>, 7>;  // w1 w2 w3, q as w x y z

Real convolve(const std::array<Real, kOrder + 1>& a, const std::array<Real, kOrder + 1>& b, int k) {
  Real sum = 0.0L;
  for (int j = 0; j <= k; ++j)
    sum += a[static_cast<std::size_t>(j)] * b[static_cast<std::size_t>(k - j)];
  return sum;
}

Series series_at(const Real3& coefficient, const RealSpin& spin) {
  Series s{};
  auto& [w1, w2, w3, qw, qx, qy, qz] = s;
  w1[0] = spin.w.x(), w2[0] = spin.w.y(), w3[0] = spin.w.z();
  qw[0] = spin.q.w(), qx[0] = spin.q.x(), qy[0] = spin.q.y(), qz[0] = spin.q.z();
  for (int k = 0; k < kOrder; ++k) {
    const auto next = static_cast<std::size_t>(k + 1);
    const Real n = 1.0L / (k + 1);
    w1[next] = n * coefficient.x() * convolve(w2, w3, k);
    w2[next] = n * coefficient.y() * convolve(w3, w1, k);
    w3[next] = n * coefficient.z() * convolve(w1, w2, k);
    qw[next] = -0.5L * n * (convolve(qx, w1, k) + convolve(qy, w2, k) + convolve(qz, w3, k));
    qx[next] = 0.5L * n * (convolve(qw, w1, k) + convolve(qy, w3, k) - convolve(qz, w2, k));
    qy[next] = 0.5L * n * (convolve(qw, w2, k) + convolve(qz, w1, k) - convolve(qx, w3, k));
    qz[next] = 0.5L * n * (convolve(qw, w3, k) + convolve(qx, w2, k) - convolve(qy, w1, k));
  }
  return s;
}

/// Longest step whose last two terms stay below kTaylorError of |w| and of |q| = 1.
Real step_of(const Series& s, Real speed) {
  Real step = INFINITY;
  for (const int k : {kOrder - 1, kOrder}) {
    Real size = 0.0L;
    for (std::size_t i = 0; i < 7; ++i)
      size = std::max(size, std::abs(s[i][static_cast<std::size_t>(k)]) / (i < 3 ? speed : 1.0L));
    if (size > 0.0L) step = std::min(step, std::pow(kTaylorError / size, 1.0L / k));
  }
  return step;
}

RealSpin evaluate(const Series& s, Real t) {
  std::array<Real, 7> sum{};
  for (std::size_t i = 0; i < 7; ++i) {
    for (std::size_t k = kOrder + 1; k-- > 0;) sum[i] = sum[i] * t + s[i][k];
  }
  return {RealQuaternion(sum[3], sum[4], sum[5], sum[6]).normalized(),
          Real3(sum[0], sum[1], sum[2])};
}

RealSpin turn_by_series(const Real3& I, RealSpin spin, Real t) {
  const Real3 coefficient((I.y() - I.z()) / I.x(), (I.z() - I.x()) / I.y(),
                          (I.x() - I.y()) / I.z());
  const Real direction = t < 0.0L ? -1.0L : 1.0L;
  Real left = std::abs(t);
  while (left > 0.0L) {
    const Real speed = spin.w.norm();
    if (speed == 0.0L) break;
    const Series s = series_at(coefficient, spin);
    const Real step = std::min(step_of(s, speed), left);
    spin = evaluate(s, direction * step);
    left -= step;
  }
  return spin;
}

// ---- Asymmetric top: whole periods --------------------------------------------------------------

/// pi / (2 AGM(1, k')) = K, the complete elliptic integral, from the complementary modulus k' =
/// sqrt(1 - m).
Real complete_elliptic(Real complementary) {
  // Digits double each time: from the smallest k' of all, 1e-4932, it takes 17. Arithmetic narrower
  // than 64 bits (other machines, valgrind) may never come as near as is asked for.
  constexpr int kMost = 20;
  Real a = 1.0L, b = complementary;
  for (int i = 0; i < kMost && std::abs(a - b) > 1e-18L * a; ++i) {
    const Real mean = 0.5L * (a + b);
    b = std::sqrt(a * b);
    a = mean;
  }
  return std::acos(-1.0L) / (a + b);
}

struct RealTumbling {
  Real modulus_m, period;
};

/// Modulus, and the time after which w is the same again in the principal frame; infinite on the
/// separatrix. With I1 < I2 < I3 and the constants of (F.1) A = I3 (I3-I1) w3^2 + I2 (I2-I1) w2^2 =
/// L^2 - 2 E I1 and B = I1 (I3-I1) w1^2 + I2 (I3-I2) w2^2 = 2 E I3 - L^2, in which nothing cancels:
///   larger = max(A (I3-I2), B (I2-I1)),  smaller = min(...),  m = smaller / larger,  T
///       = 4 K(m) sqrt(I1 I2 I3 / larger)                                                     (F.6)
/// Source: Landau and Lifshitz, section 37.
RealTumbling tumbling_of(const Real3& moments, const Real3& omega) {
  std::array<int, 3> order{0, 1, 2};
  std::sort(order.begin(), order.end(), [&](int a, int b) { return moments[a] < moments[b]; });
  const auto [i, j, k] = order;
  const Real I1 = moments[i], I2 = moments[j], I3 = moments[k];
  const Real w1 = omega[i] * omega[i], w2 = omega[j] * omega[j], w3 = omega[k] * omega[k];
  // 1 - m = |A (I3-I2) - B (I2-I1)| / larger, and the w2 terms of the difference drop out.
  const Real from_major = (I3 - I2) * (I3 * (I3 - I1) * w3),
             from_minor = (I2 - I1) * (I1 * (I3 - I1) * w1);
  const Real shared = I2 * (I2 - I1) * (I3 - I2) * w2;
  const Real larger = std::max(from_major, from_minor) + shared;
  if (larger == 0.0L) return {0.0L, INFINITY};  // at rest, or a spherical top
  const Real modulus = (std::min(from_major, from_minor) + shared) / larger;
  const Real complementary = std::sqrt(std::abs(from_major - from_minor) / larger);
  if (complementary == 0.0L) return {modulus, INFINITY};
  return {modulus, 4.0L * complete_elliptic(complementary) * std::sqrt(I1 * I2 * I3 / larger)};
}

/// After one period the body has turned about L by some angle; n periods turn it n times as far. So
/// a long time costs one period and a rest, where the rest of the work is in the series.
RealSpin turn_asymmetric(const Real3& I, const RealSpin& start, Real t) {
  constexpr Real kFewPeriods = 3.0L;  // below, going straight is no dearer
  const Real period = tumbling_of(I, start.w).period;
  if (!(std::abs(t) > kFewPeriods * period)) return turn_by_series(I, start, t);

  const Real periods = std::floor(t / period);
  RealSpin rest = turn_by_series(I, start, t - periods * period);
  const RealQuaternion after_one = turn_by_series(I, start, period).q;
  const RealQuaternion once = after_one * start.q.conjugate();  // world: a turn about L
  const Real3 L_world = start.q * Real3(I.cwiseProduct(start.w));
  const Real half_angle = std::atan2(once.vec().dot(L_world.normalized()), once.w());
  rest.q = turn(2.0L * half_angle * L_world.normalized(), periods) * rest.q;
  return rest;
}

RealQuaternion widen(const Quaterniond& q) { return q.cast<Real>(); }

}  // namespace

FreeRotation::FreeRotation(const Matrix3d& inertia_body)
    : moments_(inertia_body.diagonal()), body_from_principal_(Quaterniond::Identity()) {
  require(inertia_body.allFinite() && inertia_body.isApprox(inertia_body.transpose(), 1e-12),
          "FreeRotation: the inertia tensor must be symmetric and finite");
  if (!inertia_body.isDiagonal(0.0)) {
    const SymmetricEigen3 eigen = symmetric_eigen(inertia_body);
    Matrix3d axes = eigen.vectors;
    if (axes.determinant() < 0.0) axes.col(2) = -axes.col(2);
    moments_ = eigen.values;
    body_from_principal_ = Quaterniond(axes).normalized();
  }
  require((moments_.array() > 0.0).all(), "FreeRotation: the principal moments must be positive");

  const auto same = [&](int a, int b) {
    return std::abs(moments_[a] - moments_[b]) <= kSameMoment * moments_.maxCoeff();
  };
  if (same(0, 1) && same(1, 2) && same(0, 2))
    kind_ = Kind::kSpherical;
  else if (same(0, 1))
    kind_ = Kind::kSymmetric, axis_ = 2;
  else if (same(1, 2))
    kind_ = Kind::kSymmetric, axis_ = 0;
  else if (same(2, 0))
    kind_ = Kind::kSymmetric, axis_ = 1;
}

Spin FreeRotation::after(const Spin& start, double t) const {
  require(start.omega_body.allFinite() && start.world_from_body.coeffs().allFinite() &&
              std::isfinite(t),
          "FreeRotation: spin and time must be finite");
  const Spin principal{start.world_from_body * body_from_principal_,
                       body_from_principal_.conjugate() * start.omega_body};
  const Spin later = after_in_principal_frame(principal, t);
  return {(later.world_from_body * body_from_principal_.conjugate()).normalized(),
          body_from_principal_ * later.omega_body};
}

Tumbling FreeRotation::tumbling(const Vector3d& omega_body) const {
  const RealTumbling found = tumbling_of(
      moments_.cast<Real>(), (body_from_principal_.conjugate() * omega_body).cast<Real>());
  return {static_cast<double>(found.modulus_m), static_cast<double>(found.period)};
}

Spin FreeRotation::after_in_principal_frame(const Spin& start, double t) const {
  const Real3 I = moments_.cast<Real>();
  const RealSpin from{widen(start.world_from_body).normalized(), start.omega_body.cast<Real>()};
  RealSpin to = from;
  switch (kind_) {
    case Kind::kSpherical: to = {from.q * turn(from.w, t), from.w}; break;
    case Kind::kSymmetric: to = turn_symmetric(I, axis_, from, t); break;
    case Kind::kAsymmetric: to = turn_asymmetric(I, from, t); break;
  }
  return {to.q.cast<double>(), to.w.cast<double>()};
}

RigidBodyState advance_freely(const RigidBodyState& state, const Inertia& inertia, double t) {
  require(inertia.inverse_mass > 0.0, "advance_freely: the body must be movable");
  const Vector3d angular_momentum_body =
      state.world_from_body.conjugate() * state.angular_momentum_world;
  const FreeRotation rotation(inertia.inertia_body);
  RigidBodyState later = state;
  later.com_world = state.com_world + t * inertia.inverse_mass * state.momentum_world;
  later.world_from_body =
      rotation
          .after({state.world_from_body, inertia.inverse_inertia_body * angular_momentum_body}, t)
          .world_from_body;
  return later;
}

Quaterniond turned(const Quaterniond& q, const Vector3d& turn) {
  const double angle = turn.norm();
  return angle > 0 ? (Quaterniond(Eigen::AngleAxisd(angle, turn / angle)) * q).normalized() : q;
}

}  // namespace tumble
