#include "framework/dynamics/point_impact.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "framework/core/numbers.h"

namespace tumble {
namespace {

using Eigen::Matrix2d;

// Of the largest inverse mass: what rounding leaves of a direction in which nothing can be moved.
// Links of some hundred bodies leave 1e-14.
constexpr double kRigid = 1e-12;
constexpr double kNoSlip = 1e-12;  // of the speed: what rounding leaves of no slip
// of bisection in the logarithm; Newton's method takes about 6
constexpr int kMostSteps = 200;

/// (I.1) with the normal impulse eliminated, in the contact's frame: S p_t = wanted is sticking, S
/// = K_tt - k k^T / K_nn, k = K_tn. Components along the eigenvectors of S, in which S is diagonal.
struct Tangents {
  Vector2d stiffness;  // eigenvalues of S, 0 where nothing can be moved [1/kg]
  Vector2d coupling;   // k [1/kg]
  // change of the slip that would end it, if there were no friction before [m/s]
  Vector2d wanted;
  double normal, rise;  // K_nn [1/kg], [m/s]

  double normal_impulse(const Vector2d& p) const { return (rise - coupling.dot(p)) / normal; }
};

/// p_t of (S + s I) p_t = wanted.
Vector2d sliding_impulse(const Tangents& t, double s) {
  Vector2d p;
  for (int i = 0; i < 2; ++i) p[i] = t.wanted[i] == 0.0 ? 0.0 : t.wanted[i] / (t.stiffness[i] + s);
  return p;
}

/// |p_t| - mu p_n, over |p_t|: its zero is where the slip slides.
double excess(const Tangents& t, double friction, double s) {
  const Vector2d p = sliding_impulse(t, s);
  const double length = p.norm();
  return length > 0 ? 1.0 - friction * t.normal_impulse(p) / length : -1.0;
}

/// The impulse along the tangents that obeys (I.2); nothing where none does.
std::optional<Vector2d> coulomb(const Tangents& t, double friction) {
  const bool can_stick =
      (t.stiffness[0] > 0 || t.wanted[0] == 0.0) && (t.stiffness[1] > 0 || t.wanted[1] == 0.0);
  if (can_stick) {
    const Vector2d p = sliding_impulse(t, 0.0);
    const double normal = t.normal_impulse(p);
    if (normal > 0 && p.norm() <= friction * normal) return p;
  }
  // Beyond `high` friction is certainly less than its bound; near 0 it is more, or (jammed) never.
  const double highest =
      t.wanted.norm() * (t.normal + friction * t.coupling.norm()) / (friction * t.rise);
  double high = highest, low = highest;
  while (!(excess(t, friction, low) > 0) && low > kRigid * highest) {
    high = low;
    low *= 0.25;
  }
  if (!(excess(t, friction, low) > 0)) {
    if (!can_stick || !(excess(t, friction, 0.0) > 0)) return std::nullopt;
    low = 0.0;
  }
  // The zero, kept in its bracket: secant steps, bisection where they leave it.
  double at_low = excess(t, friction, low), at_high = excess(t, friction, high);
  for (int k = 0; k < kMostSteps && high - low > 2 * kEpsilon * high; ++k) {
    const double secant = low + (high - low) * at_low / (at_low - at_high);
    const double next = k % 3 != 2 && secant > low && secant < high ? secant : 0.5 * (low + high);
    if (!(next > low && next < high)) break;
    const double at_next = excess(t, friction, next);
    if (at_next == 0.0) {
      low = high = next;
    } else if (at_next > 0) {
      low = next;
      at_low = at_next;
    } else {
      high = next;
      at_high = at_next;
    }
  }
  return sliding_impulse(t, high);
}

}  // namespace

// The larger root of  start - allowed + slope x + bend x^2 = 0,  in the form that does not cancel.
double share_without_gain(double start, double slope, double bend) {
  const double left = std::min(0.0, start);
  if (left + slope + bend <= 0) return 1.0;
  const double root = std::sqrt(std::max(0.0, slope * slope - 4 * bend * left));
  return std::clamp(slope > 0 ? -2 * left / (slope + root) : (root - slope) / (2 * bend), 0.0, 1.0);
}

double energy_of(const Vector3d& impulse, const Vector3d& velocity, const Matrix3d& K) {
  return impulse.dot(velocity + 0.5 * (K * impulse));
}

PointImpulse impulse_of(const PointImpact& impact) {
  const Vector3d& n = impact.normal_b_to_a_world;
  const Matrix3d& K = impact.inverse_mass_world;
  const double normal = n.dot(K * n);
  const Vector3d first = impact.rise / normal * n;
  if (!(impact.friction > 0) || !(impact.rise > 0)) return {first, 1.0};

  // The frame of the contact, turned to the eigenvectors of S.
  const Vector3d t1 = n.unitOrthogonal(), t2 = n.cross(t1);
  Eigen::Matrix<double, 3, 2> across;
  across << t1, t2;
  const Vector2d k = across.transpose() * K * n;
  const Matrix2d S = across.transpose() * K * across - k * k.transpose() / normal;
  const double half = 0.5 * (S(0, 0) - S(1, 1)), radius = std::hypot(half, S(0, 1)),
               angle = radius > 0 ? 0.5 * std::atan2(S(0, 1), half) : 0.0;
  Matrix2d turn;
  turn << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
  const Vector2d eigenvalues(0.5 * S.trace() + radius, 0.5 * S.trace() - radius);
  const Eigen::Matrix<double, 3, 2> axes = across * turn;
  Tangents t;
  t.normal = normal;
  t.rise = impact.rise;
  t.coupling = turn.transpose() * k;
  t.wanted = -(axes.transpose() * impact.velocity_world + t.coupling * (impact.rise / normal));
  const double speed =
      impact.velocity_world.norm() + impact.rise + t.coupling.norm() * impact.rise / normal;
  for (int i = 0; i < 2; ++i) {
    t.stiffness[i] = eigenvalues[i] > kRigid * K.trace() ? eigenvalues[i] : 0.0;
    if (std::abs(t.wanted[i]) <= kNoSlip * speed && t.stiffness[i] == 0.0) t.wanted[i] = 0.0;
  }
  const std::optional<Vector2d> tangential = coulomb(t, impact.friction);
  if (!tangential) return {first, 0.0};
  const Vector3d whole = t.normal_impulse(*tangential) * n + axes * *tangential;
  // What rounding makes of energies that cancel is no gain.
  const Vector3d more = whole - first;
  const double start = energy_of(first, impact.velocity_world, K),
               slope = more.dot(impact.velocity_world + K * first), bend = 0.5 * more.dot(K * more);
  const double rounding = 16 * kEpsilon *
                          (std::abs(first.dot(impact.velocity_world)) +
                           std::abs(more.dot(impact.velocity_world)) + bend);
  const double share = share_without_gain(start, slope - rounding, bend);
  return {first + share * more, share};
}

}  // namespace tumble
