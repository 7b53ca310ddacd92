#include "tests/support/overlap.h"

#include <algorithm>
#include <limits>
#include <set>

namespace tumble::testing {
namespace {

/// A convex solid where it stands. World frame.
struct Placed {
  std::vector<Vector3d> corners, normals, edges;  // edges and normals unit
};

/// Directions that differ by more than roundings, either sign.
void add_direction(const Vector3d& direction, std::vector<Vector3d>& directions) {
  constexpr double kSame = 1e-9;
  const Vector3d unit = direction.normalized();
  const bool known = std::any_of(directions.begin(), directions.end(), [&](const Vector3d& other) {
    return unit.cross(other).norm() < kSame;
  });
  if (!known) directions.push_back(unit);
}

Placed outline_of(const TriangleMesh& mesh) {
  Placed outline{mesh.vertices, {}, {}};
  for (const Face& face : mesh.faces) {
    const Vector3d &a = mesh.vertices[face[0]], &b = mesh.vertices[face[1]],
                   &c = mesh.vertices[face[2]];
    add_direction((b - a).cross(c - a), outline.normals);
    for (const Vector3d& edge : {Vector3d(b - a), Vector3d(c - b), Vector3d(a - c)})
      add_direction(edge, outline.edges);
  }
  return outline;
}

Placed placed(const Placed& outline, const BodyPose& pose) {
  const Matrix3d rotation = pose.world_from_body.toRotationMatrix();
  Placed there = outline;
  for (Vector3d& corner : there.corners) corner = pose.com_world + rotation * corner;
  for (Vector3d& normal : there.normals) normal = rotation * normal;
  for (Vector3d& edge : there.edges) edge = rotation * edge;
  return there;
}

double least_overlap(const Placed& a, const Placed& b) {
  double least = std::numeric_limits<double>::infinity();
  const auto parts = [&](const Vector3d& axis) {
    double low_a = 1e300, high_a = -1e300, low_b = 1e300, high_b = -1e300;
    for (const Vector3d& corner : a.corners)
      low_a = std::min(low_a, axis.dot(corner)), high_a = std::max(high_a, axis.dot(corner));
    for (const Vector3d& corner : b.corners)
      low_b = std::min(low_b, axis.dot(corner)), high_b = std::max(high_b, axis.dot(corner));
    least = std::min(least, std::min(high_a - low_b, high_b - low_a));
    return least <= 0;
  };
  for (const Placed* solid : {&a, &b})
    for (const Vector3d& normal : solid->normals)
      if (parts(normal)) return 0.0;
  constexpr double kParallel = 1e-6;  // rad: such an axis is a face's as well
  for (const Vector3d& u : a.edges)
    for (const Vector3d& v : b.edges)
      if (const Vector3d across = u.cross(v);
          across.norm() > kParallel && parts(across.normalized()))
        return 0.0;
  return least;
}

/// Lowest point of a solid over a half-space, negative below it. [m]
double height_above(const Shape& shape, const BodyPose& pose, const Vector3d& normal,
                    const Vector3d& point) {
  const double middle = normal.dot(pose.com_world - point);
  if (const auto* sphere = std::get_if<Sphere>(&shape)) return middle - sphere->radius;
  double lowest = 1e300;
  for (const Vector3d& corner : surface_of(shape).vertices)
    lowest = std::min(lowest, middle + normal.dot(pose.world_from_body * corner));
  return lowest;
}

}  // namespace

double deepest_overlap(const World& world, const std::vector<BodyPose>& poses) {
  const int n = static_cast<int>(world.bodies.size());
  std::vector<Placed> solids(n);
  const MeshSolid* last = nullptr;
  Placed outline;  // bodies of one model follow each other
  for (int i = 0; i < n; ++i) {
    const auto* mesh = std::get_if<MeshSolid>(&world.bodies[i].shape);
    if (mesh == nullptr) continue;
    if (last == nullptr || last->mesh_body.vertices != mesh->mesh_body.vertices)
      outline = outline_of(mesh->mesh_body);
    last = mesh;
    solids[i] = placed(outline, poses[i]);
  }
  double deepest = 0.0;
  for (int i = 0; i < n; ++i)
    for (int j = i + 1; j < n; ++j) {
      const WorldBody &a = world.bodies[i], &b = world.bodies[j];
      if (a.immovable() && b.immovable()) continue;
      if (std::holds_alternative<HalfSpace>(b.shape)) {
        deepest = std::max(
            deepest, -height_above(a.shape, poses[i], b.state.world_from_body * Vector3d::UnitZ(),
                                   b.state.com_world));
        continue;
      }
      const double apart = (poses[i].com_world - poses[j].com_world).norm(),
                   reach = bounding_radius(a.shape) + bounding_radius(b.shape);
      if (!(apart < reach)) continue;
      const bool balls =
          std::holds_alternative<Sphere>(a.shape) && std::holds_alternative<Sphere>(b.shape);
      deepest = std::max(deepest, balls ? reach - apart : least_overlap(solids[i], solids[j]));
    }
  return deepest;
}

}  // namespace tumble::testing
