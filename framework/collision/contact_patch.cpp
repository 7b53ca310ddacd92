#include "framework/collision/contact_patch.h"

#include "framework/collision/piece_pairs.h"

namespace tumble::collision {
namespace {

// Pieces whose normal differs by more than this (rad) from the pair's normal belong to another
// contact.
constexpr double kSamePlane = 1e-6;

std::vector<Vector3d> lowest_vertices(const CollisionShape& shape, const Pose& pose,
                                      const Vector3d& n, double tolerance) {
  const Matrix3d R = pose.world_from_body.toRotationMatrix();
  double lowest = std::numeric_limits<double>::infinity();
  for (const Vector3d& v : shape.vertices()) lowest = std::min(lowest, n.dot(R * v));
  std::vector<Vector3d> points;
  for (const Vector3d& v : shape.vertices())
    if (n.dot(R * v) <= lowest + tolerance)
      points.push_back(pose.com_world + R * v - shape.radius() * n);
  return points;
}

}  // namespace

FlatHull contact_patch(const CollisionShape& a, const Pose& pose_a, const CollisionShape& b,
                       const Pose& pose_b, const Gap& gap, double tolerance) {
  const Vector3d& n = gap.normal_b_to_a_world;
  std::vector<Vector3d> points;
  if (a.ellipsoid() || b.ellipsoid()) {
    points = {gap.point_a_world};
  } else if (b.is_half_space()) {
    points = lowest_vertices(a, pose_a, n, tolerance);
  } else if (a.is_half_space()) {
    points = lowest_vertices(b, pose_b, -n, tolerance);
  } else if (!a.is_ball() && !b.is_ball()) {
    const Query query(a, pose_a, b, pose_b);
    const double reach = std::max(gap.distance, 0.0) + tolerance;
    const auto pairs = pieces_within(query, reach, nullptr);
    // The middle of many normals is that of no pair: then the pairs that it separates.
    for (const bool of_any_normal : {false, true}) {
      if (!points.empty()) break;
      for (const auto& [i, j] : pairs) {
        const PlacedPolytope placed_a = query.piece_of_a(i), placed_b = query.piece_of_b(j);
        const PolytopeGap found =
            surface_gap(placed_a, placed_b, query.size, reach, Points::kUnwanted);
        if (found.beyond || found.distance > reach) continue;
        if (of_any_normal ? separation_along(placed_a, placed_b, n) < -tolerance
                          : (found.normal_b_to_a - n).norm() > kSamePlane)
          continue;
        for (const Vector3d& p : facing_region(placed_a, placed_b, n, tolerance))
          points.push_back(pose_b.com_world + p);
      }
    }
  }
  if (points.empty()) points.push_back(gap.point_a_world);
  return flat_hull(points, n);
}

}  // namespace tumble::collision
