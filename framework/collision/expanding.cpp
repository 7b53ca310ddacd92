#include "framework/collision/expanding.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "framework/core/numbers.h"

namespace tumble::collision {
namespace {

// A tetrahedron with a smaller fraction of the volume that its edges could span is too flat to
// expand.
constexpr double kFlat = 1e-9;
constexpr int kMostPoints = 96, kMostFacets = 192;  // facets alive at any time: 2 x points - 4

// Completes the simplex to a tetrahedron of corners of A - B that are far from each other,
// searching across the span of the present ones.
bool complete(const PlacedPolytope& a, const PlacedPolytope& b, std::array<Vector3d, 4>& p,
              int size) {
  const auto farthest = [&](auto&& directions, auto&& measure) {
    double best = 0.0;
    Vector3d corner = Vector3d::Zero();
    for (const Vector3d& d : directions)
      for (const double side : {1.0, -1.0}) {
        const Vector3d candidate = lowest_difference(a, b, side * d).difference;
        if (const double value = measure(candidate); value > best) {
          best = value;
          corner = candidate;
        }
      }
    p[size++] = corner;
    return best > 0.0;
  };
  if (size == 1) {
    const std::array<Vector3d, 3> axes{Vector3d::UnitX(), Vector3d::UnitY(), Vector3d::UnitZ()};
    if (!farthest(axes, [&](const Vector3d& c) { return (c - p[0]).norm(); })) return false;
  }
  if (size == 2) {
    const Vector3d along = p[1] - p[0];
    int flattest = 0;
    along.cwiseAbs().minCoeff(&flattest);
    const Vector3d u = along.cross(Vector3d::Unit(flattest)), v = along.cross(u);
    const std::array<Vector3d, 2> across{u.normalized(), v.normalized()};
    if (!farthest(across, [&](const Vector3d& c) { return (c - p[0]).cross(along).norm(); }))
      return false;
  }
  const Vector3d n = (p[1] - p[0]).cross(p[2] - p[0]);
  if (size == 3) {
    const std::array<Vector3d, 1> across{n.normalized()};
    if (!farthest(across, [&](const Vector3d& c) { return std::abs(n.dot(c - p[0])); }))
      return false;
  }
  return std::abs(n.dot(p[3] - p[0])) >
         kFlat * (p[1] - p[0]).norm() * (p[2] - p[0]).norm() * (p[3] - p[0]).norm();
}

class Expansion {
 public:
  explicit Expansion(std::array<Vector3d, 4> p) {
    // then the normal of (0, 1, 2) points away from 3
    if ((p[1] - p[0]).cross(p[2] - p[0]).dot(p[3] - p[0]) > 0) std::swap(p[0], p[1]);
    for (int i = 0; i < 4; ++i) points_[i] = p[i];
    point_count_ = 4;
    whole_ = add_facet(0, 1, 2) && add_facet(0, 3, 1) && add_facet(1, 3, 2) && add_facet(2, 3, 0);
  }

  std::optional<Axis> run(const PlacedPolytope& a, const PlacedPolytope& b, double size) {
    const double rounding = 8 * kEpsilon * size;
    while (whole_) {
      const Facet nearest =
          *std::min_element(facets_.begin(), facets_.begin() + facet_count_,
                            [](const Facet& f, const Facet& g) { return f.height < g.height; });
      const Vector3d corner = lowest_difference(a, b, -nearest.outward).difference;
      if (nearest.outward.dot(corner) - nearest.height <= rounding)
        return Axis{-nearest.height, -nearest.outward};
      if (point_count_ == kMostPoints) return std::nullopt;
      grow(corner, 0.5 * rounding);
    }
    return std::nullopt;
  }

 private:
  struct Facet {
    std::array<int, 3> at;
    Vector3d outward;  // unit
    double height;     // of the plane above the origin, along `outward` [m]
  };
  struct Side {
    int from, to;
  };

  bool add_facet(int i, int j, int k) {
    if (facet_count_ == kMostFacets) return false;
    const Vector3d across = (points_[j] - points_[i]).cross(points_[k] - points_[i]);
    const double area = across.norm();
    if (!(area > 0)) return false;
    const Vector3d outward = across / area;
    // The largest of the three heights: the plane of a sliver is inaccurate, and must not hide the
    // surface beyond it.
    const double height =
        std::max({outward.dot(points_[i]), outward.dot(points_[j]), outward.dot(points_[k])});
    facets_[facet_count_++] = {{i, j, k}, outward, height};
    return true;
  }

  // Facets visible from the new corner are replaced by facets that join it to their horizon.
  void grow(const Vector3d& corner, double rounding) {
    std::array<Side, 3 * kMostFacets> rim;
    int rim_size = 0;
    int kept = 0;
    for (int f = 0; f < facet_count_; ++f) {
      if (facets_[f].outward.dot(corner) - facets_[f].height <= rounding) {
        facets_[kept++] = facets_[f];
        continue;
      }
      for (int s = 0; s < 3; ++s) {
        const Side side{facets_[f].at[s], facets_[f].at[(s + 1) % 3]};
        int twin = 0;
        while (twin < rim_size && !(rim[twin].from == side.to && rim[twin].to == side.from)) ++twin;
        if (twin < rim_size) {
          rim[twin] = rim[--rim_size];
        } else {
          rim[rim_size++] = side;
        }
      }
    }
    facet_count_ = kept;
    const int at = point_count_;
    points_[point_count_++] = corner;
    for (int k = 0; k < rim_size && whole_; ++k) {
      // a horizon with a corner twice is broken by rounding
      for (int m = 0; m < k; ++m) whole_ = whole_ && rim[m].from != rim[k].from;
      whole_ = whole_ && add_facet(rim[k].from, rim[k].to, at);
    }
    whole_ = whole_ && rim_size >= 3;
  }

  std::array<Vector3d, kMostPoints> points_;
  std::array<Facet, kMostFacets> facets_;
  int point_count_ = 0, facet_count_ = 0;
  bool whole_ = true;
};

}  // namespace

std::optional<Axis> expand(const PlacedPolytope& a, const PlacedPolytope& b, const Simplex& start,
                           double size) {
  std::array<Vector3d, 4> corners;
  corners.fill(Vector3d::Zero());
  for (int i = 0; i < start.size; ++i) corners[i] = start.points[i].difference;
  if (!complete(a, b, corners, start.size) && (start.size == 1 || !complete(a, b, corners, 1)))
    return std::nullopt;
  return Expansion(corners).run(a, b, size);
}

}  // namespace tumble::collision
