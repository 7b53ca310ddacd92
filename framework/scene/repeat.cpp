#include "framework/scene/repeat.h"

#include <cmath>
#include <numbers>

#include "framework/core/random.h"

namespace tumble::scene {
namespace {

/// Uniform over the circle of a plane, or over the sphere (height and azimuth are uniform there:
/// Archimedes).
Vector3d random_direction(Random& random, const std::string& directions) {
  const double azimuth = random.between(0.0, 2.0 * std::numbers::pi);
  const double c = std::cos(azimuth), s = std::sin(azimuth);
  if (directions == "xy") return {c, s, 0};
  if (directions == "xz") return {c, 0, s};
  if (directions == "yz") return {0, c, s};
  const double height = random.between(-1.0, 1.0);
  const double radius = std::sqrt(1.0 - height * height);
  return {radius * c, radius * s, height};
}

}  // namespace

std::vector<BodySpec> write_out(const RepeatSpec& repeat) {
  Random random(repeat.seed);
  std::vector<BodySpec> copies;
  const Vector3d middle(0.5 * (repeat.counts[0] - 1), 0.5 * (repeat.counts[1] - 1),
                        0.5 * (repeat.counts[2] - 1));
  for (int k = 0; k < repeat.counts[2]; ++k)
    for (int j = 0; j < repeat.counts[1]; ++j)
      for (int i = 0; i < repeat.counts[0]; ++i) {
        BodySpec copy = repeat.body;
        copy.name += '_' + std::to_string(copies.size() + 1);
        copy.position_m += (Vector3d(i, j, k) - middle).cwiseProduct(repeat.spacing_m);
        for (int axis = 0; axis < 3; ++axis)
          copy.position_m[axis] += repeat.jitter_m[axis] * random.between(-1.0, 1.0);
        if (repeat.speed_m_s > 0)
          copy.velocity_m_s += repeat.speed_m_s * random_direction(random, repeat.directions);
        if (!repeat.colors.empty())
          copy.color = repeat.colors[copies.size() % repeat.colors.size()];
        copies.push_back(std::move(copy));
      }
  return copies;
}

}  // namespace tumble::scene
