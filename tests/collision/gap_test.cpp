// Gaps of every pair of kinds of solid, convex or not, against a second method: all faces against
// all faces (tests/collision/brute_force.h).
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "tests/collision/brute_force.h"
#include "tests/support/places.h"
#include "framework/collision/gap.h"
#include "framework/geometry/solid.h"

namespace tumble::testing {
namespace {

using collision::CollisionShape;
using collision::Pose;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Solid {
  std::string name;
  TriangleMesh mesh;
  CollisionShape shape;
};

Solid model(const std::string& name) {
  const MeshSolid solid = load_solid(test::source_dir() + "/models/" + name + ".3ds").solid;
  return {name, solid.mesh_body, CollisionShape(solid)};
}

class Poses {
 public:
  explicit Poses(unsigned seed) : random_(seed) {}
  double in(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  Vector3d vector() { return {in(-1, 1), in(-1, 1), in(-1, 1)}; }
  Pose pose(double spread) {
    return {spread * vector(),
            Quaterniond(in(-1, 1), in(-1, 1), in(-1, 1), in(-1, 1)).normalized()};
  }

 private:
  std::mt19937_64 random_;
};

// Both methods have errors of a few roundings of the models' size, about 1 m. For nearly parallel
// segments the closed form loses half its digits, but only where it is not the smallest distance. A
// face skipped by the bounding-volume tree would change the gap by centimetres.
constexpr double kRounding = 1e-12;

void expect_same(const BruteForce& expected, const collision::Gap& found, const std::string& what) {
  if (expected.cross) {
    EXPECT_LT(found.distance, 0.0) << what << ": surfaces cross";
    return;
  }
  // detected by `overlapping` only: gaps are for bodies that were apart before
  if (expected.one_in_other) return;
  EXPECT_NEAR(found.distance, expected.distance, kRounding) << what;
  EXPECT_NEAR((found.point_a_world - found.point_b_world).norm(), found.distance, kRounding)
      << what << ": witness points";
  EXPECT_NEAR(found.normal_b_to_a_world.norm(), 1.0, kRounding) << what;
}

TEST(Gap, OfAnyTwoModelsIsTheSmallestOverAllFaces) {
  std::vector<Solid> solids;
  for (const char* name : {"torus", "l_shape", "t_handle", "wedge", "rock_1"})
    solids.push_back(model(name));
  Poses random(11);
  int crossing = 0, apart = 0;
  for (std::size_t i = 0; i < solids.size(); ++i) {
    for (std::size_t j = i; j < solids.size(); ++j) {
      const Solid &a = solids[i], &b = solids[j];
      for (int k = 0; k < 2; ++k) {
        const double reach = a.shape.bounding_radius() + b.shape.bounding_radius();
        const Pose pose_a = random.pose(0.5 * reach), pose_b = random.pose(0.5 * reach);
        const BruteForce expected = brute_force(placed(a.mesh, pose_a), placed(b.mesh, pose_b));
        ++(expected.cross ? crossing : apart);
        expect_same(expected, collision::compute_gap(a.shape, pose_a, b.shape, pose_b),
                    a.name + " and " + b.name);
        EXPECT_EQ(collision::overlapping(a.shape, pose_a, b.shape, pose_b, 0.0),
                  expected.cross || expected.one_in_other);
      }
    }
  }
  EXPECT_GT(crossing, 5);
  EXPECT_GT(apart, 8);
}

TEST(Gap, OfAModelAndABoxIsTheSmallestOverAllFaces) {
  const Box box{Vector3d(0.3, 0.2, 0.1)};
  const CollisionShape box_shape{Shape(box)};
  const TriangleMesh box_mesh = surface_of(box);
  Poses random(12);
  for (const char* name : {"torus", "dumbbell", "t_handle"}) {
    const Solid solid = model(name);
    for (int k = 0; k < 20; ++k) {
      const Pose pose = random.pose(solid.shape.bounding_radius()), box_pose = random.pose(0.3);
      const BruteForce expected = brute_force(placed(solid.mesh, pose), placed(box_mesh, box_pose));
      if (!expected.cross && !expected.one_in_other)
        expect_same(expected, collision::compute_gap(solid.shape, pose, box_shape, box_pose), name);
      EXPECT_EQ(collision::overlapping(solid.shape, pose, box_shape, box_pose, 0.0),
                expected.cross || expected.one_in_other)
          << name;
    }
  }
}

// A body copied with its place: the surfaces are one, so that no two faces cross.
TEST(Gap, AModelThatIsWhereAnotherOfItsKindIsOverlapsIt) {
  Poses random(13);
  for (const char* name : {"torus", "l_shape", "t_handle", "dumbbell"}) {
    const Solid solid = model(name);
    for (int k = 0; k < 20; ++k) {
      const Pose pose = k == 0 ? Pose() : random.pose(1.0);
      EXPECT_TRUE(collision::overlapping(solid.shape, pose, solid.shape, pose, 0.0))
          << name << ", pose " << k;
    }
  }
}

TEST(Gap, OfAModelAndABallOrAPlaneIsThatOfItsNearestPoint) {
  const CollisionShape ball{Shape(Sphere{0.2})}, floor{Shape(HalfSpace{})};
  Poses random(13);
  for (const char* name : {"torus", "l_shape", "dumbbell"}) {
    const Solid solid = model(name);
    for (int k = 0; k < 50; ++k) {
      const Pose pose = random.pose(1.0), other = random.pose(1.0);
      const Surface surface = placed(solid.mesh, pose);
      double to_center = kInfinity, over_floor = kInfinity;
      const Vector3d n = other.world_from_body * Vector3d::UnitZ();
      for (const Triangle3& t : surface) {
        to_center = std::min(to_center, point_to_triangle(other.com_world, t));
        for (const Vector3d& v : t) over_floor = std::min(over_floor, n.dot(v - other.com_world));
      }
      EXPECT_NEAR(collision::compute_gap(solid.shape, pose, floor, other).distance, over_floor,
                  kRounding)
          << name;
      if (inside(other.com_world, surface)) continue;
      EXPECT_NEAR(collision::compute_gap(solid.shape, pose, ball, other).distance, to_center - 0.2,
                  kRounding)
          << name;
    }
  }
}

TEST(Gap, IsSymmetricInTheTwoBodies) {
  const Solid torus = model("torus"), handle = model("t_handle");
  Poses random(14);
  for (int k = 0; k < 100; ++k) {
    const Pose p = random.pose(1.5), q = random.pose(1.5);
    const collision::Gap there = collision::compute_gap(torus.shape, p, handle.shape, q),
                         back = collision::compute_gap(handle.shape, q, torus.shape, p);
    if (there.distance > 0) {
      EXPECT_NEAR(there.distance, back.distance, kRounding);
    }
    EXPECT_EQ(there.distance < 0, back.distance < 0);
  }
}

TEST(Gap, StaysAccurateFarFromTheOriginAndAtEveryScale) {
  const Solid torus = model("torus");
  Poses random(15);
  for (const double scale : {1e-6, 1e6}) {
    TriangleMesh scaled = torus.mesh;
    for (Vector3d& v : scaled.vertices) v *= scale;
    const CollisionShape shape{Shape(MeshSolid{scaled, false})};
    for (int k = 0; k < 20; ++k) {
      Pose p = random.pose(1.5), q = random.pose(1.5);
      const double expected = collision::compute_gap(torus.shape, p, torus.shape, q).distance;
      if (expected < 0) continue;
      const Vector3d shift(1048576.0, -524288.0, 262144.0);  // m: one rounding of it is 1.2e-10 m
      const double far =
          collision::compute_gap(torus.shape, {p.com_world + shift, p.world_from_body}, torus.shape,
                                 {q.com_world + shift, q.world_from_body})
              .distance;
      EXPECT_NEAR(far, expected, 4 * 1.2e-10);
      p.com_world *= scale;
      q.com_world *= scale;
      EXPECT_NEAR(collision::compute_gap(shape, p, shape, q).distance / scale, expected, kRounding);
    }
  }
}

}  // namespace
}  // namespace tumble::testing
