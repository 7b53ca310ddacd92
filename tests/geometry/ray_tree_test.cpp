// The nearest face along a ray, compared with a search over every face, and for rays aimed exactly
// at edges and corners, where a gap would show.
#include <cmath>

#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/core/random.h"
#include "framework/geometry/mass_properties.h"
#include "framework/geometry/ray_tree.h"
#include "models/catalogue.h"
#include "models/surfaces.h"

namespace tumble::testing::ray_tree_test {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();

TriangleMesh model(const std::string& file) {
  for (const models::Model& one : models::catalogue()) {
    if (one.file == file + ".3ds") return models::rounded(one.objects.front().mesh);
  }
  throw std::runtime_error("no model " + file);
}

Vector3d on_sphere(Random& random, double radius) {
  for (;;) {
    const Vector3d p(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1));
    if (p.norm() > 0.1 && p.norm() < 1.0) return radius * p.normalized();
  }
}

/// Moeller and Trumbore's test on every face (J. Graphics Tools 2(1), 1997): another method,
/// without a tree.
std::optional<double> nearest_by_trying_all(const TriangleMesh& mesh, const Vector3d& origin,
                                            const Vector3d& direction) {
  std::optional<double> best;
  for (const auto& [i, j, k] : mesh.faces) {
    const Vector3d u = mesh.vertices[j] - mesh.vertices[i], v = mesh.vertices[k] - mesh.vertices[i],
                   s = origin - mesh.vertices[i];
    const Vector3d p = direction.cross(v);
    const double det = u.dot(p);
    if (det == 0.0) continue;
    const double a = s.dot(p) / det, b = direction.dot(s.cross(u)) / det,
                 t = v.dot(s.cross(u)) / det;
    if (a >= 0 && b >= 0 && a + b <= 1 && t >= 0 && (!best || t < *best)) best = t;
  }
  return best;
}

TEST(RayTree, FindsTheSameDistanceAsTryingEveryFace) {
  // A random ray passes an edge within round-off with a probability of about 1e-12: both methods
  // must agree on every ray.
  Random random(1);
  int hits = 0;
  for (const char* name : {"torus", "gear", "chess_pawn", "rock_1", "t_handle"}) {
    const RayTree tree(model(name));
    for (int i = 0; i < 400; ++i) {
      const Vector3d origin = on_sphere(random, 3.0), direction = on_sphere(random, 0.5) - origin;
      const auto expected = nearest_by_trying_all(tree.mesh(), origin, direction);
      const auto found = tree.nearest(origin, direction);
      ASSERT_EQ(found.has_value(), expected.has_value()) << name << ", ray " << i;
      if (!expected) continue;
      ++hits;
      // The ray meets the face at an angle of 1e-3 or more: its distance is accurate to 1e3
      // roundings.
      EXPECT_NEAR(found->t, *expected, 1e4 * kEps) << name << ", ray " << i;
    }
  }
  EXPECT_GT(hits, 500);
}

TEST(RayTree, HitLiesOnItsFaceAndOnItsRay) {
  Random random(2);
  const RayTree tree(model("torus"));
  for (int i = 0; i < 500; ++i) {
    const Vector3d origin = on_sphere(random, 2.0), direction = -origin + on_sphere(random, 0.4);
    const auto hit = tree.nearest(origin, direction);
    if (!hit) continue;
    const auto& [a, b, c] = tree.mesh().faces[hit->face];
    const Vector3d on_face = hit->barycentric[0] * tree.mesh().vertices[a] +
                             hit->barycentric[1] * tree.mesh().vertices[b] +
                             hit->barycentric[2] * tree.mesh().vertices[c];
    EXPECT_LE((on_face - (origin + hit->t * direction)).norm(), 1e3 * kEps);
    EXPECT_GE(hit->barycentric.minCoeff(), 0.0);
    EXPECT_NEAR(hit->barycentric.sum(), 1.0, 4 * kEps);
  }
}

/// Number of rays from inside a solid that hit nothing. Each is aimed at a corner, at an edge's
/// midpoint, or at a random point of an edge.
int misses_from_inside(const TriangleMesh& mesh, const Vector3d& inside, int origins) {
  const RayTree tree(mesh);
  Random random(3);
  int misses = 0;
  for (int i = 0; i < origins; ++i) {
    const Vector3d origin = inside + on_sphere(random, 0.02);
    for (const Face& face : mesh.faces) {
      for (int corner = 0; corner < 3; ++corner) {
        const Vector3d& a = mesh.vertices[face[corner]];
        const Vector3d& b = mesh.vertices[face[(corner + 1) % 3]];
        for (double s : {0.0, 0.5, random.unit()})
          misses += tree.nearest(origin, a + s * (b - a) - origin) ? 0 : 1;
      }
    }
  }
  return misses;
}

TEST(RayTree, NoRayLeavesABoxThroughItsEdgesAndCorners) {
  EXPECT_EQ(misses_from_inside(model("box"), {0, 0, 0}, 300), 0);
}
TEST(RayTree, NoRayLeavesABallThroughItsEdgesAndCorners) {
  EXPECT_EQ(misses_from_inside(model("sphere"), {0.1, 0, 0}, 5), 0);
}
TEST(RayTree, NoRayLeavesAPawnThroughItsEdgesAndCorners) {
  EXPECT_EQ(misses_from_inside(model("chess_pawn"), {0, 0, 0.8}, 5), 0);
}

TEST(RayTree, NoRayLeavesARockFarFromTheOrigin) {
  // At 1e6 m coordinates are 1e-10 m apart: shears and boxes are rounded by that much, and no gap
  // may open.
  const Vector3d far(1e6, -2e6, 3e6);
  EXPECT_EQ(misses_from_inside(models::moved(model("rock_1"), far), far, 100), 0);
}

TEST(RayTree, RaysAlongTheAxesAtCornersOfABoxHit) {
  // A direction with two zeros is parallel to four walls: 0 / 0 in the boxes of the tree, and faces
  // parallel to the ray.
  const RayTree tree(models::box({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}));
  for (double x : {-0.5, -0.25, 0.0, 0.5}) {
    for (double y : {-0.5, 0.0, 0.125, 0.5}) {
      for (double down : {-1.0, 1.0}) {
        for (int axis = 0; axis < 3; ++axis) {
          Vector3d origin, direction = Vector3d::Zero();
          origin[axis] = -2.0 * down;
          origin[(axis + 1) % 3] = x;
          origin[(axis + 2) % 3] = y;
          direction[axis] = down;
          const auto hit = tree.nearest(origin, direction);
          ASSERT_TRUE(hit) << origin.transpose() << " along axis " << axis;
          EXPECT_EQ(hit->t, 1.5);
        }
      }
    }
  }
}

TEST(RayTree, RayBesideABoxMisses) {
  const RayTree tree(models::box({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}));
  // more than the widening of the boxes (16 eps * 5 m = 2e-14 m)
  constexpr double kBeside = 0.5 + 1e-12;
  EXPECT_FALSE(tree.nearest({kBeside, 0, -2}, {0, 0, 1}));
  EXPECT_FALSE(tree.nearest({0, 0, -2}, {0, 0, -1})) << "behind the ray";
  EXPECT_FALSE(tree.nearest({0, 0, -2}, {0, 0, 1}, 1.4)) << "beyond t_most";
}

TEST(RayTree, LengthOfTheDirectionOnlyScalesT) {
  const RayTree tree(model("rock_2"));
  const auto one = tree.nearest({2, 1, 1}, {-2, -1, -1}),
             four = tree.nearest({2, 1, 1}, {-8, -4, -4});
  ASSERT_TRUE(one && four);
  EXPECT_EQ(one->face, four->face);
  EXPECT_EQ(one->t, 4.0 * four->t);
}

TEST(RayTree, OfTwoFacesAtTheSameDistanceTheLowerIndexIsReturned) {
  const TriangleMesh quad{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};
  const auto hit = RayTree(quad).nearest({0.5, 0.5, 1}, {0, 0, -1});
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->face, 0);
}

TEST(RayTree, RayWithoutDirectionBreaksAPrecondition) {
  EXPECT_THROW(RayTree(model("box")).nearest({0, 0, 0}, {0, 0, 0}), PreconditionError);
  EXPECT_THROW(RayTree(TriangleMesh{}), PreconditionError);
}

}  // namespace
}  // namespace tumble::testing::ray_tree_test
