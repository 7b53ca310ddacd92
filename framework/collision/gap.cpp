#include "framework/collision/gap.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "framework/collision/axes.h"
#include "framework/collision/ellipsoid.h"
#include "framework/collision/piece_pairs.h"
#include "framework/collision/touching_normal.h"
#include "framework/core/error.h"
#include "framework/core/numbers.h"

namespace tumble::collision {
namespace {

// relative to the query's size: error of a search against its limit
constexpr double kRoundingOfGaps = 1e-14;
// likewise: far above the error of any search
constexpr double kCertain = 1e-11;
// likewise: what rounding of places and of times of impact leaves
constexpr double kApartAsWell = 1e-12;

Gap flipped(Gap gap) {
  std::swap(gap.point_a_world, gap.point_b_world);
  gap.normal_b_to_a_world = -gap.normal_b_to_a_world;
  return gap;
}

Gap gap_of_ellipsoid(const CollisionShape& a, const Pose& pose_a, const Pose& plane) {
  const Matrix3d rotation = pose_a.world_from_body.toRotationMatrix();
  const Vector3d n = plane.world_from_body.toRotationMatrix().col(2),
                 up_body = rotation.transpose() * n;
  Gap gap;
  gap.distance = n.dot(pose_a.com_world - plane.com_world) + lowest_height(*a.ellipsoid(), up_body);
  gap.normal_b_to_a_world = n;
  gap.point_a_world = pose_a.com_world + rotation * lowest_point(*a.ellipsoid(), up_body);
  gap.point_b_world = gap.point_a_world - gap.distance * n;
  return gap;
}

// Against a half-space the nearest point is the vertex that lies lowest along the normal.
Gap gap_to_half_space(const CollisionShape& a, const Pose& pose_a, const Pose& plane) {
  if (a.ellipsoid()) return gap_of_ellipsoid(a, pose_a, plane);
  const Matrix3d rotation = pose_a.world_from_body.toRotationMatrix();
  const Vector3d n = plane.world_from_body.toRotationMatrix().col(2);
  const Vector3d offset = pose_a.com_world - plane.com_world;
  double lowest;
  const int nearest = a.corners().lowest(rotation.transpose() * n, lowest);
  const Vector3d arm = rotation * a.vertices()[nearest];
  Gap gap;
  gap.distance = (n.dot(offset) + lowest) - a.radius();
  gap.normal_b_to_a_world = n;
  gap.point_a_world = pose_a.com_world + arm - a.radius() * n;
  gap.point_b_world = gap.point_a_world - gap.distance * n;
  return gap;
}

Vector3d upward(const Pose& half_space) {
  return half_space.world_from_body.toRotationMatrix().col(2);
}

Gap gap_of_balls(const CollisionShape& a, const Pose& pose_a, const CollisionShape& b,
                 const Pose& pose_b) {
  const Vector3d between = pose_a.com_world - pose_b.com_world;
  const double distance = between.norm();
  Gap gap;
  gap.normal_b_to_a_world = distance > 0 ? Vector3d(between / distance) : Vector3d::UnitZ();
  gap.distance = distance - (a.radius() + b.radius());
  gap.point_a_world = pose_a.com_world - a.radius() * gap.normal_b_to_a_world;
  gap.point_b_world = pose_b.com_world + b.radius() * gap.normal_b_to_a_world;
  return gap;
}

Gap gap_of_pieces(const CollisionShape& a, const CollisionShape& b, const Query& query,
                  const Vector3d& com_b_world, PairCache* cache) {
  const NearestPieces nearest = nearest_pieces(query, kInfinity, cache, Points::kWanted);
  const bool of_balls = a.is_ball() || b.is_ball(),
             of_several = a.is_closed_surface() || b.is_closed_surface();
  const PolytopeGap best =
      of_several && !of_balls ? with_common_normal(query, nearest, cache) : nearest.gap;
  Gap gap;
  gap.distance = best.distance - (a.radius() + b.radius());
  gap.normal_b_to_a_world = best.normal_b_to_a;
  gap.point_a_world = com_b_world + best.point_a - a.radius() * best.normal_b_to_a;
  gap.point_b_world = com_b_world + best.point_b + b.radius() * best.normal_b_to_a;
  return gap;
}

// Some points inside a solid, body frame. Not its corners: they may lie on the other's surface.
std::vector<Vector3d> points_inside(const CollisionShape& solid) {
  constexpr double kBelow = 1e-6;  // of the solid's radius: under a face, far above rounding
  std::vector<Vector3d> points;
  const auto middle_of = [](const Polytope& piece) {
    Vector3d sum = Vector3d::Zero();
    for (const Vector3d& v : piece.vertices) sum += v;
    return Vector3d(sum / static_cast<double>(piece.vertices.size()));
  };
  const auto& pieces = solid.pieces();
  if (!solid.is_closed_surface()) {
    points.push_back(middle_of(pieces[0]));
    return points;
  }
  for (const std::size_t i : {std::size_t{0}, pieces.size() / 2, pieces.size() - 1})
    if (!pieces[i].face_normals.empty())
      points.push_back(middle_of(pieces[i]) -
                       kBelow * solid.bounding_radius() * pieces[i].face_normals.front());
  return points;
}

bool holds_some_point_of(const CollisionShape& outer, const Pose& outer_pose,
                         const CollisionShape& inner, const Pose& inner_pose) {
  if (!outer.is_closed_surface() || inner.is_half_space()) return false;
  const std::vector<Vector3d> points = points_inside(inner);
  return std::any_of(points.begin(), points.end(), [&](const Vector3d& p) {
    const Vector3d point_world = inner_pose.com_world + inner_pose.world_from_body * p;
    return outer.holds_point(outer_pose.world_from_body.conjugate() *
                             (point_world - outer_pose.com_world));
  });
}

}  // namespace

Gap compute_gap(const CollisionShape& a, const Pose& pose_a, const CollisionShape& b,
                const Pose& pose_b, PairCache* cache) {
  if (a.is_half_space() && b.is_half_space())
    return {kInfinity, Vector3d::Zero(), Vector3d::Zero(), Vector3d::UnitZ()};
  if (b.is_half_space()) return gap_to_half_space(a, pose_a, pose_b);
  if (a.is_half_space()) return flipped(gap_to_half_space(b, pose_b, pose_a));
  if (a.is_ball() && b.is_ball()) return gap_of_balls(a, pose_a, b, pose_b);
  return gap_of_pieces(a, b, Query(a, pose_a, b, pose_b), pose_b.com_world, cache);
}

double gap_distance(const CollisionShape& a, const Pose& pose_a, const CollisionShape& b,
                    const Pose& pose_b, PairCache* cache, double limit) {
  if (a.is_half_space() || b.is_half_space() || (a.is_ball() && b.is_ball()))
    return compute_gap(a, pose_a, b, pose_b).distance;
  if (cache && cache->measured_at(pose_a, pose_b) &&
      (cache->measured <= cache->measured_up_to || limit <= cache->measured_up_to))
    return cache->measured;
  const Query query(a, pose_a, b, pose_b);
  const double radii = a.radius() + b.radius(),
               widened_limit = std::max(limit, 0.0) + radii + kRoundingOfGaps * query.size;
  double distance =
      nearest_pieces(query, widened_limit, cache, Points::kUnwanted).gap.distance - radii;
  if (!(distance <= limit)) distance = std::nextafter(limit, kInfinity);
  if (cache) cache->note(pose_a, pose_b, distance, limit);
  return distance;
}

bool is_within(const CollisionShape& a, const Pose& pose_a, const CollisionShape& b,
               const Pose& pose_b, double reach, PairCache* cache) {
  if (cache && !a.is_half_space() && !b.is_half_space()) {
    // No gap is larger than the distance of two points, however it is rounded.
    const Vector3d offset = pose_a.com_world - pose_b.com_world;
    const Vector3d between = offset + pose_a.world_from_body * cache->near_body_a -
                             pose_b.world_from_body * cache->near_body_b;
    const double radii = a.radius() + b.radius(),
                 size = offset.norm() + a.bounding_radius() + b.bounding_radius();
    if (between.norm() - radii <= reach - kCertain * size) return true;
  }
  return gap_distance(a, pose_a, b, pose_b, cache, reach) <= reach;
}

bool has_separations(const CollisionShape& a, const CollisionShape& b) {
  if (a.is_half_space() && b.is_half_space()) return false;
  const auto is_convex = [](const CollisionShape& shape) {
    return !shape.is_closed_surface() && shape.ellipsoid() == nullptr;
  };
  return is_convex(a) && is_convex(b);
}

std::optional<Separation> largest_separation(const CollisionShape& a, const Pose& pose_a,
                                             const CollisionShape& b, const Pose& pose_b,
                                             PairCache* cache, double limit) {
  require(has_separations(a, b), "largest_separation is of convex solids and half-spaces");
  Separation found;
  if (a.is_half_space() || b.is_half_space()) {
    found.normal_b_to_a_world = b.is_half_space() ? upward(pose_b) : Vector3d(-upward(pose_a));
    found.distance = separation_along(a, pose_a, b, pose_b, found.normal_b_to_a_world);
  } else {
    const Query query(a, pose_a, b, pose_b);
    const double radii = a.radius() + b.radius();
    const PolytopeGap gap =
        nearest_pieces(query, std::max(limit, 0.0) + radii + kRoundingOfGaps * query.size, cache,
                       Points::kUnwanted)
            .gap;
    found = {gap.distance - radii, gap.normal_b_to_a};
  }
  if (!(found.distance <= limit)) return std::nullopt;
  return found;
}

std::vector<Vector3d> normals_apart(const CollisionShape& a, const Pose& pose_a,
                                    const CollisionShape& b, const Pose& pose_b, const Gap& gap) {
  // pairs of edge directions: those of boxes and tetrahedra
  constexpr std::size_t kMostPairs = 36;
  const auto is_asked = [](const CollisionShape& shape) {
    return !shape.is_half_space() && !shape.ellipsoid() && !shape.is_closed_surface() &&
           shape.radius() == 0.0;
  };
  if (!is_asked(a) || !is_asked(b) ||
      a.pieces()[0].edge_directions.size() * b.pieces()[0].edge_directions.size() > kMostPairs)
    return {};
  const Query query(a, pose_a, b, pose_b);
  if (gap.distance > kApartAsWell * query.size) return {};
  BarredAxes barred;
  barred.first = gap.normal_b_to_a_world;
  const Axis other = best_axis(query.piece_of_a(0), query.piece_of_b(0), query.size, &barred);
  constexpr double kAnother = 1e-2;  // rad: of the impulse, nearer ones change a hundredth
  if (!(other.separation >= -kApartAsWell * query.size) ||
      (other.normal_b_to_a - gap.normal_b_to_a_world).norm() < kAnother)
    return {};
  return axes_apart(query.piece_of_a(0), query.piece_of_b(0), -kApartAsWell * query.size);
}

double separation_along(const CollisionShape& a, const Pose& pose_a, const CollisionShape& b,
                        const Pose& pose_b, const Vector3d& normal_b_to_a_world) {
  const Vector3d& n = normal_b_to_a_world;
  // how far a solid reaches from its centre against a direction, < 0; a half-space ends there
  const auto lowest = [](const CollisionShape& shape, const Pose& pose, const Vector3d& direction) {
    if (shape.is_half_space()) return 0.0;
    return shape.corners().lowest_height(pose.world_from_body.conjugate() * direction) -
           shape.radius();
  };
  return n.dot(pose_a.com_world - pose_b.com_world) + lowest(a, pose_a, n) + lowest(b, pose_b, -n);
}

bool overlapping(const CollisionShape& a, const Pose& pose_a, const CollisionShape& b,
                 const Pose& pose_b, double allowance) {
  if (gap_distance(a, pose_a, b, pose_b) < -allowance) return true;
  return holds_some_point_of(a, pose_a, b, pose_b) || holds_some_point_of(b, pose_b, a, pose_a);
}

double gap_scale(const CollisionShape& a, const Pose& pose_a, const CollisionShape& b,
                 const Pose& pose_b) {
  double scale =
      std::max(pose_a.com_world.cwiseAbs().maxCoeff(), pose_b.com_world.cwiseAbs().maxCoeff());
  if (!a.is_half_space()) scale += a.bounding_radius();
  if (!b.is_half_space()) scale += b.bounding_radius();
  return scale;
}

}  // namespace tumble::collision
