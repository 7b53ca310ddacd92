// Which pairs are looked at when a run begins: those whose boxes overlap, and so as many as bodies,
// not as their square. No pair that would be kept may be missed.
#include <random>

#include <gtest/gtest.h>

#include "framework/collision/collision_shape.h"
#include "framework/core/math.h"
#include "framework/engines/stepping/start_overlaps.h"

namespace tumble::engines::start_boxes_test {
namespace {

using collision::CollisionShape;
using collision::Pose;

bool is_kept(const CollisionShape& a, const Pose& pose_a, const CollisionShape& b,
             const Pose& pose_b) {
  std::vector<StartPair> near;
  look_at_start(0, 1, a, pose_a, b, pose_b, 0.0, near);
  return !near.empty();
}

bool is_found(const CollisionShape& a, const Pose& pose_a, const CollisionShape& b,
              const Pose& pose_b) {
  return !collision::overlapping_pairs({start_box(a, pose_a, true), start_box(b, pose_b, false)})
              .empty();
}

// Balls along an axis of the world, where box and ball are of one width: apart by some of what
// rounding explains, far from the origin and near it, of sizes from 1e-4 to 1e4 m.
TEST(StartBoxes, HoldEveryPairThatIsKept) {
  std::mt19937 random(20261128);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  int kept = 0, not_kept = 0;
  for (int run = 0; run < 2000; ++run) {
    const double r_a = std::pow(10.0, 8.0 * unit(random) - 4.0),
                 r_b = r_a * std::pow(10.0, 2.0 * unit(random) - 1.0);
    const CollisionShape a{Shape(Sphere{r_a})}, b{Shape(Sphere{r_b})};
    const Vector3d axis = Vector3d::Unit(static_cast<int>(3.0 * unit(random))),
                   place = 1e3 * r_a * unit(random) * Vector3d(unit(random), unit(random), 1.0);
    Pose pose_a{place, Quaterniond::Identity()}, pose_b = pose_a;
    pose_b.com_world += (r_a + r_b) * axis;
    const double explained = explained_overlap(a, pose_a, b, pose_b);
    pose_b.com_world += 10.0 * (unit(random) - 0.5) * explained * axis;
    if (!is_kept(a, pose_a, b, pose_b)) {
      ++not_kept;
      continue;
    }
    ++kept;
    EXPECT_TRUE(is_found(a, pose_a, b, pose_b)) << "run " << run;
  }
  EXPECT_GT(kept, 500);
  EXPECT_GT(not_kept, 50);
}

// A floor without end is near everything, and bodies a diameter apart are no pair.
TEST(StartBoxes, AFloorIsNearAllAndBodiesApartAreNoPair) {
  const CollisionShape floor{Shape(HalfSpace{})}, ball{Shape(Sphere{0.1})};
  const Pose origin{Vector3d::Zero(), Quaterniond::Identity()},
      above{Vector3d(5, 0, 0.1), Quaterniond::Identity()},
      beside{Vector3d(5.4, 0, 0.1), Quaterniond::Identity()};
  EXPECT_TRUE(is_found(ball, above, floor, origin));
  EXPECT_FALSE(is_found(ball, above, ball, beside));
}

}  // namespace
}  // namespace tumble::engines::start_boxes_test
