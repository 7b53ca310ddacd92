#include "framework/core/shortest_turn.h"

#include <cmath>

namespace tumble {
namespace {

// Below this cosine, 1 + cosine (from which the half angle is computed) loses more than two bits.
constexpr double kNearlyOpposite = -0.5;
// A cross product of unit vectors that is shorter than this has no reliable direction.
constexpr double kNoAxis = 1e-9;

Vector3d axis_across(const Vector3d& unit) {
  const Vector3d other = std::abs(unit.y()) < 0.9 ? Vector3d::UnitY() : Vector3d::UnitX();
  return unit.cross(other).normalized();
}

}  // namespace

Quaterniond shortest_turn(const Vector3d& from, const Vector3d& to) {
  const Vector3d a = from.normalized();
  const Vector3d b = to.normalized();
  const double cosine = b.dot(a);
  const Vector3d across = a.cross(b);
  if (cosine < kNearlyOpposite) {
    // In two rotations: half a turn to -a, then the small rotation from -a to b.
    const Vector3d axis = across.norm() < kNoAxis ? axis_across(a) : across.normalized();
    return shortest_turn(-a, b) * Quaterniond(0.0, axis.x(), axis.y(), axis.z());
  }
  const double s = std::sqrt((1.0 + cosine) * 2.0);
  const double inverse = 1.0 / s;
  return {s * 0.5, across.x() * inverse, across.y() * inverse, across.z() * inverse};
}

}  // namespace tumble
