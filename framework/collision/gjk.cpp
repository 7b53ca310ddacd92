#include "framework/collision/gjk.h"

#include <algorithm>
#include <cmath>

#include "framework/core/numbers.h"

namespace tumble::collision {
namespace {

// Where the sine between a triangle's sides is smaller, its plane is no more accurate than the
// nearest point.
constexpr double kSliver = 1e-6;
constexpr int kMostIterations = 200;  // polytopes of a thousand vertices take about thirty

bool holds(const Simplex& simplex, const DifferencePoint& point) {
  for (int i = 0; i < simplex.size; ++i)
    if (simplex.points[i].vertex_a == point.vertex_a &&
        simplex.points[i].vertex_b == point.vertex_b)
      return true;
  return false;
}

// Direction and distance of the nearest point. Where it lies on a face, both are taken from the
// face's plane, which is accurate to all digits. The difference of two near points has a
// directional error of rounding / distance, with which the next search would find the wrong corner.
void settle(const Vector3d& nearest, GjkResult& result) {
  const Simplex& s = result.simplex;
  if (s.size == 3) {
    const Vector3d u = s.points[1].difference - s.points[0].difference,
                   v = s.points[2].difference - s.points[0].difference;
    const Vector3d across = u.cross(v);
    const double squared = across.squaredNorm();
    if (squared > kSliver * kSliver * u.squaredNorm() * v.squaredNorm()) {
      const double height = across.dot(s.points[0].difference), area = std::sqrt(squared);
      result.normal = across / (height < 0 ? -area : area);
      result.distance = std::abs(height) / area;
      return;
    }
  }
  result.distance = nearest.norm();
  result.normal = result.distance > 0 ? Vector3d(nearest / result.distance) : Vector3d::UnitZ();
}

}  // namespace

DifferencePoint lowest_difference(const PlacedPolytope& a, const PlacedPolytope& b,
                                  const Vector3d& direction) {
  const int i = a.lowest(direction), j = b.lowest(-direction);
  return {a.vertex(i) - b.vertex(j), i, j};
}

GjkResult gjk(const PlacedPolytope& a, const PlacedPolytope& b, double size, double limit) {
  GjkResult result, trial;
  Simplex& simplex = result.simplex;
  simplex.points[0] = lowest_difference(a, b, a.translation - b.translation);
  simplex.size = 1;
  settle(reduce_to_nearest(simplex), result);
  const double touching = 8 * kEpsilon * size;
  for (int round = 0; round < kMostIterations && result.distance > touching; ++round) {
    const DifferencePoint next = lowest_difference(a, b, result.normal);
    // The supporting plane through `next` is a lower bound of the distance; the search ends when it
    // reaches the upper bound.
    result.lower_bound = std::max(result.lower_bound, result.normal.dot(next.difference));
    if (result.lower_bound > limit) {
      result.verdict = Apartness::kBeyond;
      return result;
    }
    if (result.distance - result.lower_bound <= kEpsilon * size) break;
    if (holds(simplex, next)) break;
    Simplex& larger = trial.simplex;
    larger = simplex;
    larger.points[larger.size++] = next;
    const Vector3d nearest = reduce_to_nearest(larger);
    if (larger.size == 4) {
      result.simplex = larger;
      result.verdict = Apartness::kEnclosed;
      return result;
    }
    settle(nearest, trial);
    if (!(trial.distance < result.distance)) break;  // no progress above round-off
    simplex = larger;
    result.distance = trial.distance;
    result.normal = trial.normal;
  }
  result.verdict = result.distance > touching ? Apartness::kApart : Apartness::kTouching;
  return result;
}

}  // namespace tumble::collision
