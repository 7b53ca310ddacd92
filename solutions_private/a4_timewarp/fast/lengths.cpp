#include "solutions_private/a4_timewarp/fast/lengths.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "framework/engines/timewarp/active_pairs.h"

namespace tumble::a4 {
namespace {

using engines::Box;
using engines::FlightWorld;

constexpr double kCells = 1.4;     // of the mean distance of bodies
constexpr double kInABin = 100.0;  // events

}  // namespace

Lengths lengths_for(const FlightWorld& world) {
  if (world.movers().empty()) return {1.0, 1.0};
  Box all;
  std::vector<double> radii;
  for (const int i : world.movers()) {
    all.take_in({world.first_flight(i).com_world, world.first_flight(i).com_world});
    radii.push_back(world.radius(i));
  }
  std::nth_element(radii.begin(),
                   radii.begin() + static_cast<std::ptrdiff_t>(radii.size() * 9 / 10), radii.end());
  const double size = 2 * radii[radii.size() * 9 / 10];
  const Vector3d extent = (all.high - all.low).cwiseMax(Vector3d::Constant(size));
  const double apart = std::cbrt(extent.prod() / static_cast<double>(world.movers().size()));
  const double advance = std::max(apart - size, 0.25 * size),
               cell = std::max(1.5 * size, kCells * apart);
  // a single point without size
  return advance > 0 && cell > 0 ? Lengths{advance, cell} : Lengths{1.0, 1.0};
}

double bin_for(const FlightWorld& world, double advance, double duration) {
  double speed = 0.0;
  for (const int i : world.movers())
    speed += world.first_flight(i).velocity_world.norm() +
             std::sqrt(0.5 * world.gravity_world().norm() * advance);
  const double bin = kInABin * advance / speed;  // speed: of all together
  return bin > 0 && bin < duration ? bin : std::max(1e-3 * duration, 1e-12);
}

}  // namespace tumble::a4
