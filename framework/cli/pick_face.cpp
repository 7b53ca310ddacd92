#include "framework/cli/pick_face.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "framework/core/error.h"
#include "framework/geometry/ray_tree.h"
#include "framework/scene/build_shape.h"

namespace tumble::cli {
namespace {

/// Distance of a point from a half-line [m].
double distance_to(const Vector3d& point_world, const Ray& ray) {
  const Vector3d to_point = point_world - ray.origin_world;
  const double along =
      std::max(0.0, to_point.dot(ray.direction_world) / ray.direction_world.squaredNorm());
  return (to_point - along * ray.direction_world).norm();
}

// Size of the coordinates that are rounded in computing a point on the ray [m].
double coordinates(const Ray& ray, const Vector3d& centre_world, double along) {
  return ray.origin_world.norm() + centre_world.norm() + along;
}

bool meets_ball(const Ray& ray, const Vector3d& centre_world, double radius) {
  // distance_to rounds numbers of that size about ten times: a ray that grazes the ball is tested
  // further, not decided here.
  const double rounding =
      32 * std::numeric_limits<double>::epsilon() * (coordinates(ray, centre_world, 0.0) + radius);
  return !std::isfinite(radius) || distance_to(centre_world, ray) <= radius + rounding;
}

// Whether two methods found the same point on the ray. Each rounds its coordinates about ten times,
// in the body's frame or in the world's, which moves a face by some 1e-15 of their size, and the
// point on a ray at the angle a to the face by 1 / sin a of that: 1e-9 accepts all rays except
// those within 1e-6 rad of the face. For those, and for every larger error, the law is called for
// all faces: the number only affects the time.
bool is_same_place(double t, double other, const Ray& ray, const Vector3d& centre_world) {
  constexpr double kRelative = 1e-9;
  const double length = ray.direction_world.norm();
  return std::abs(t - other) * length <= kRelative * coordinates(ray, centre_world, other * length);
}

double drawn_extent(const scene::BodySpec& body) {
  const auto* plane = std::get_if<scene::PlaneSpec>(&body.shape);
  // the extent is not used for a bounded body
  return plane == nullptr ? 1.0 : plane->drawn_half_extent_m;
}

/// The law's answer for one face.
std::optional<RayHit> ask(const Laws& laws, const Ray& ray, const scene::BodySpec& body,
                          const TriangleMesh& surface, int face) {
  const auto world = [&](int corner) -> Vector3d {
    const int vertex =
        surface.faces[static_cast<std::size_t>(face)][static_cast<std::size_t>(corner)];
    return body.position_m +
           body.world_from_body * surface.vertices[static_cast<std::size_t>(vertex)];
  };
  return laws.intersect_ray_triangle(ray, {world(0), world(1), world(2)});
}

}  // namespace

std::optional<PickedFace> pick_face(const scene::Scene& scene, const Laws& laws, const Ray& ray,
                                    const std::filesystem::path& root) {
  if (!laws.intersect_ray_triangle)
    throw UserError("--modules", "no module here says where a ray meets a triangle",
                    "Build a1, or name one: --modules a1=PATH.cpp");
  const auto solids = scene::build_solids(scene, root);
  std::optional<PickedFace> nearest;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < solids.size(); ++i) {
    const scene::BodySpec& body = scene.bodies[i];
    if (!meets_ball(ray, body.position_m, bounding_radius(solids[i].shape))) continue;
    // The tree finds the face, the law computes the point. Where they disagree (an error of the
    // student's, or a seam that the law assigns to another face), the law is called for every face,
    // so that its answer counts.
    const RayTree tree(surface_of(solids[i].shape, drawn_extent(body)));
    const Quaterniond body_from_world = body.world_from_body.conjugate();
    const auto found = tree.nearest(body_from_world * (ray.origin_world - body.position_m),
                                    body_from_world * ray.direction_world);
    const auto keep = [&](int face, const std::optional<RayHit>& hit) {
      if (!hit || !(hit->t < least)) return;
      least = hit->t;
      nearest =
          PickedFace{static_cast<int>(i), face, ray.origin_world + hit->t * ray.direction_world,
                     hit->t * ray.direction_world.norm()};
    };
    const auto hit = found ? ask(laws, ray, body, tree.mesh(), found->face) : std::nullopt;
    if (hit && is_same_place(hit->t, found->t, ray, body.position_m)) {
      keep(found->face, hit);
      continue;
    }
    for (int face = 0; face < static_cast<int>(tree.mesh().faces.size()); ++face)
      keep(face, ask(laws, ray, body, tree.mesh(), face));
  }
  return nearest;
}

std::string nearest_miss(const scene::Scene& scene, const Ray& ray,
                         const std::filesystem::path& root) {
  const auto solids = scene::build_solids(scene, root);
  std::string nearest;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < solids.size(); ++i) {
    const double radius = bounding_radius(solids[i].shape);
    const double distance = distance_to(scene.bodies[i].position_m, ray);
    if (!std::isfinite(radius) || !(distance - radius < least)) continue;
    least = distance - radius;
    nearest = fmt::format(
        "it comes nearest to body '{}', {:.3g} m from its centre, and the body's farthest point is "
        "{:.3g} m from there",
        scene.bodies[i].name, distance, radius);
  }
  return nearest.empty() ? "there is no body with an end to aim at" : nearest;
}

}  // namespace tumble::cli
