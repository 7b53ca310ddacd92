/// Rigid bodies that turn freely, for tests of what turns them.
#pragma once

#include <cmath>

#include "framework/core/random.h"
#include "framework/dynamics/body.h"

namespace tumble::testing {

inline constexpr double kEps = 2.220446049250313e-16;  // spacing of doubles at 1

inline Vector3d random_vector(Random& random, double size) {
  const double x = random.between(-size, size), y = random.between(-size, size),
               z = random.between(-size, size);
  return {x, y, z};
}

inline Quaterniond random_rotation(Random& random) {
  for (;;) {
    const Vector3d v = random_vector(random, 1);
    const Quaterniond q(random.between(-1, 1), v.x(), v.y(), v.z());
    if (q.norm() > 0.1 && q.norm() < 1) return q.normalized();
  }
}

/// Moments of a solid: sums of two of three second moments of its mass, which differ by up to 100
/// times.
inline Vector3d random_moments(Random& random) {
  const double x = std::pow(10.0, random.between(-1, 1)), y = std::pow(10.0, random.between(-1, 1)),
               z = std::pow(10.0, random.between(-1, 1));
  return {y + z, x + z, x + y};
}

/// q and -q are one orientation.
inline double difference(const Quaterniond& a, const Quaterniond& b) {
  return std::min((a.coeffs() - b.coeffs()).cwiseAbs().maxCoeff(),
                  (a.coeffs() + b.coeffs()).cwiseAbs().maxCoeff());
}

}  // namespace tumble::testing
