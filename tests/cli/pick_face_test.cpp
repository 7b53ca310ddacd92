// The face of a click: the face that a loop over all faces finds, with one call of the law.
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "tests/support/places.h"
#include "framework/cli/pick_face.h"
#include "framework/geometry/ray_tree.h"
#include "framework/scene/build_shape.h"

namespace tumble::cli {
namespace {

// A simple law: the point in the plane, then its side of each edge.
std::optional<RayHit> plane_and_edges(const Ray& ray, const Triangle& triangle) {
  const auto& [a, b, c] = triangle;
  const Vector3d normal = (b - a).cross(c - a);
  const double t = normal.dot(a - ray.origin_world) / normal.dot(ray.direction_world);
  if (!(t >= 0) || !std::isfinite(t)) return std::nullopt;
  const Vector3d p = ray.origin_world + t * ray.direction_world;
  const auto inside = [&](const Vector3d& from, const Vector3d& to) {
    return normal.dot((to - from).cross(p - from)) >= 0;
  };
  if (!inside(a, b) || !inside(b, c) || !inside(c, a)) return std::nullopt;
  RayHit hit{};
  hit.t = t;
  return hit;
}

scene::Scene scene_of(const std::string& file) {
  scene::BodySpec body;
  body.name = file;
  body.shape = scene::ModelSpec{file + ".3ds", "", 1.0};
  body.density_kg_m3 = 1000.0;
  body.position_m = {0.7, -1.3, 2.1};
  body.world_from_body = Quaterniond(0.8, 0.1, -0.5, 0.3).normalized();
  scene::Scene scene;
  scene.bodies.push_back(body);
  return scene;
}

struct Asked {
  Laws laws;
  int calls = 0;
};

void count_calls(Asked& asked) {
  asked.laws.intersect_ray_triangle = [&asked](const Ray& ray, const Triangle& triangle) {
    return ++asked.calls, plane_and_edges(ray, triangle);
  };
}

// Face and distance from a call of the law for every face.
std::optional<PickedFace> ask_every_face(const scene::Scene& scene, const Ray& ray) {
  const scene::BodySpec& body = scene.bodies.front();
  const TriangleMesh surface =
      surface_of(scene::build_solids(scene, test::source_dir()).front().shape);
  std::optional<PickedFace> nearest;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t face = 0; face < surface.faces.size(); ++face) {
    const auto world = [&](std::size_t corner) -> Vector3d {
      return body.position_m +
             body.world_from_body *
                 surface.vertices[static_cast<std::size_t>(surface.faces[face][corner])];
    };
    const auto hit = plane_and_edges(ray, {world(0), world(1), world(2)});
    if (!hit || !(hit->t < least)) continue;
    least = hit->t;
    nearest = PickedFace{0, static_cast<int>(face), ray.origin_world + least * ray.direction_world,
                         least * ray.direction_world.norm()};
  }
  return nearest;
}

// A ray from outside towards a point near the body; its direction is not a unit vector.
Ray aimed(const scene::Scene& scene, double radius, std::mt19937& random) {
  std::normal_distribution<double> normal;
  const Vector3d from =
      scene.bodies.front().position_m +
      4 * radius * Vector3d(normal(random), normal(random), normal(random)).normalized();
  const Vector3d at = scene.bodies.front().position_m +
                      0.4 * radius * Vector3d(normal(random), normal(random), normal(random));
  return {from, 0.3 * (at - from)};
}

class PickFace : public ::testing::TestWithParam<const char*> {};

// Random rays hit no edge: one face is nearest, and both methods must name it.
TEST_P(PickFace, IsTheFaceThatALoopOverAllFacesFinds) {
  constexpr int kRays = 60;
  const scene::Scene scene = scene_of(GetParam());
  const double radius =
      bounding_radius(scene::build_solids(scene, test::source_dir()).front().shape);
  std::mt19937 random(1);
  int hits = 0;
  for (int i = 0; i < kRays; ++i) {
    const Ray ray = aimed(scene, radius, random);
    Asked asked;
    count_calls(asked);
    const auto picked = pick_face(scene, asked.laws, ray, test::source_dir()),
               expected = ask_every_face(scene, ray);
    ASSERT_EQ(picked.has_value(), expected.has_value()) << "ray " << i;
    if (!picked) continue;
    ++hits;
    EXPECT_EQ(picked->face, expected->face) << "ray " << i;
    EXPECT_EQ(picked->distance, expected->distance)
        << "ray " << i << ": both are the law's own answer";
    EXPECT_EQ(asked.calls, 1) << "the tree has found the face already";
  }
  EXPECT_GT(hits, kRays / 4);
}
INSTANTIATE_TEST_SUITE_P(Models, PickFace,
                         ::testing::Values("chess_pawn", "gear", "torus", "rock_1",
                                           "water_molecule"));

// A law that sees only faces from behind: the tree's face is not its answer, so it is called for
// every face.
TEST(PickFaceOfAnotherOpinion, IsWhatTheLawSays) {
  const scene::Scene scene = scene_of("rock_1");
  const Ray ray{scene.bodies.front().position_m + Vector3d(0, -10, 0), Vector3d(0.02, 1, 0.01)};
  Laws laws;
  laws.intersect_ray_triangle = [](const Ray& ray,
                                   const Triangle& triangle) -> std::optional<RayHit> {
    const auto& [a, b, c] = triangle;
    if ((b - a).cross(c - a).dot(ray.direction_world) < 0) return std::nullopt;
    return plane_and_edges(ray, triangle);
  };
  Asked seeing;
  count_calls(seeing);
  const auto behind = pick_face(scene, laws, ray, test::source_dir()),
             front = pick_face(scene, seeing.laws, ray, test::source_dir());
  ASSERT_TRUE(behind && front);
  EXPECT_GT(behind->distance, front->distance);
  EXPECT_NE(behind->face, front->face);
}

}  // namespace
}  // namespace tumble::cli
