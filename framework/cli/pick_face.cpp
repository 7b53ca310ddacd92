#include "framework/cli/pick_face.h"

#include <fmt/format.h>

#include "framework/core/error.h"
#include "framework/scene/build_shape.h"

namespace tumble::cli {
namespace {

/// Of a half-line [m].
double distance_to(const Vector3d& point_world, const Ray& ray) {
  const Vector3d to_point = point_world - ray.origin_world;
  const double along = std::max(0.0, to_point.dot(ray.direction_world) / ray.direction_world.squaredNorm());
  return (to_point - along * ray.direction_world).norm();
}

bool meets_ball(const Ray& ray, const Vector3d& centre_world, double radius) {
  // 1e-9: a ray that grazes the ball is asked about, not decided here.
  return !std::isfinite(radius) || distance_to(centre_world, ray) <= radius * (1 + 1e-9);
}

double drawn_extent(const scene::BodySpec& body) {
  const auto* plane = std::get_if<scene::PlaneSpec>(&body.shape);
  return plane == nullptr ? 1.0 : plane->drawn_half_extent_m;   // of a body with an end the extent is not asked
}

}  // namespace

std::optional<PickedFace> pick_face(const scene::Scene& scene, const Laws& laws, const Ray& ray, const std::filesystem::path& root) {
  if (!laws.intersect_ray_triangle) throw UserError("--modules", "no module here says where a ray meets a triangle", "Build a1, or name one: --modules a1=PATH.cpp");
  const auto solids = scene::build_solids(scene, root);
  std::optional<PickedFace> nearest;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < solids.size(); ++i) {
    const scene::BodySpec& body = scene.bodies[i];
    if (!meets_ball(ray, body.position_m, bounding_radius(solids[i].shape))) continue;
    const TriangleMesh surface = surface_of(solids[i].shape, drawn_extent(body));
    const auto world = [&](int vertex_index) -> Vector3d {
      return body.position_m + body.world_from_body * surface.vertices[static_cast<std::size_t>(vertex_index)];
    };
    for (std::size_t k = 0; k < surface.faces.size(); ++k) {
      const Face& face = surface.faces[k];
      const auto hit = laws.intersect_ray_triangle(ray, {world(face[0]), world(face[1]), world(face[2])});
      if (!hit || !(hit->t < least)) continue;
      least = hit->t;
      const Vector3d point_world = ray.origin_world + hit->t * ray.direction_world;
      nearest = PickedFace{static_cast<int>(i), static_cast<int>(k), point_world, hit->t * ray.direction_world.norm()};
    }
  }
  return nearest;
}

std::string nearest_miss(const scene::Scene& scene, const Ray& ray, const std::filesystem::path& root) {
  const auto solids = scene::build_solids(scene, root);
  std::string nearest;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < solids.size(); ++i) {
    const double radius = bounding_radius(solids[i].shape);
    const double distance = distance_to(scene.bodies[i].position_m, ray);
    if (!std::isfinite(radius) || !(distance - radius < least)) continue;
    least = distance - radius;
    nearest = fmt::format("it comes nearest to body '{}', {:.3g} m from its centre, and the body's farthest point is {:.3g} m from there", scene.bodies[i].name, distance, radius);
  }
  return nearest.empty() ? "there is no body with an end to aim at" : nearest;
}

}  // namespace tumble::cli
