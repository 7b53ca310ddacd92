#include "framework/collision/ellipsoid.h"

#include <algorithm>

namespace tumble::collision {
namespace {

constexpr int kMostBisections = 60;          // to the last bit
constexpr double kBisectionAccuracy = 1e-3;  // relative: the advancement continues from the result

}  // namespace

double duration_of_ellipsoid(const Ellipsoid& e, const Vector3d& up, const Vector3d& turn,
                             const Approach& approach, double horizon) {
  const double half_acceleration = std::min(approach.half_acceleration, 0.0),
               lowest = lowest_height(e, up);
  const auto height = [&](double t) {
    return approach.gap + (lowest_height(e, up + t * turn) - lowest) +
           (approach.rate + half_acceleration * t) * t;
  };
  double apart = 0.0, touching = horizon;
  if (height(horizon) > 0) return horizon;
  for (int round = 0; round < kMostBisections && touching - apart > kBisectionAccuracy * touching;
       ++round) {
    const double middle = 0.5 * (apart + touching);
    (height(middle) > 0 ? apart : touching) = middle;
  }
  return apart;
}

}  // namespace tumble::collision
