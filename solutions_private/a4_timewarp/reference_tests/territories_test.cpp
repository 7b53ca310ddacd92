// The cuts of space among threads: about the same work on both sides, few bodies in the planes, and
// a second cut across the first.
#include <gtest/gtest.h>

#include "framework/core/random.h"
#include "solutions_private/a4_timewarp/fast/partition.h"

namespace tumble::a4 {
namespace {

using engines::Box;

constexpr double kHalf = 0.1;  // edge of each body's box [m]

WorkLoad body_at(const Vector3d& middle_world, double work = 1.0) {
  return {{middle_world - Vector3d::Constant(kHalf), middle_world + Vector3d::Constant(kHalf)},
          work};
}

// A lattice of bodies, a quarter of a metre apart.
std::vector<WorkLoad> lattice(int x, int y, int z) {
  std::vector<WorkLoad> bodies;
  for (int i = 0; i < x; ++i)
    for (int j = 0; j < y; ++j)
      for (int k = 0; k < z; ++k) bodies.push_back(body_at(0.25 * Vector3d(i, j, k)));
  return bodies;
}

std::vector<WorkLoad> cloud(int count, const Vector3d& half) {
  Random random(5);
  std::vector<WorkLoad> bodies;
  for (int k = 0; k < count; ++k) {
    Vector3d middle;
    for (int axis = 0; axis < 3; ++axis) middle[axis] = random.between(-half[axis], half[axis]);
    bodies.push_back(body_at(middle));
  }
  return bodies;
}

double work_held(const Box& territory, const std::vector<WorkLoad>& bodies) {
  double work = 0.0;
  for (const WorkLoad& body : bodies)
    if (holds(territory, body.box_world)) work += body.work;
  return work;
}

int held_by_none(const std::vector<Box>& territories, const std::vector<WorkLoad>& bodies) {
  int count = 0;
  for (const WorkLoad& body : bodies) {
    bool is_held = false;
    for (const Box& territory : territories) is_held = is_held || holds(territory, body.box_world);
    count += is_held ? 0 : 1;
  }
  return count;
}

int axis_between(const std::vector<Box>& two) {
  int axis = 0;
  while (axis < 3 && two[0].high[axis] != two[1].low[axis]) ++axis;
  return axis;
}

TEST(Territories, AreCutWhereHalfOfTheWorkIsOnEachSide) {
  std::vector<WorkLoad> bodies = lattice(40, 3, 3);
  for (WorkLoad& body : bodies)
    if (body.middle(0) < 2.0) body.work = 9.0;  // the first fifth
  const std::vector<Box> two = partition_space(bodies, 2);
  EXPECT_EQ(axis_between(two), 0);
  const double below = work_held(two[0], bodies), above = work_held(two[1], bodies);
  const double layer = 9 * 9.0;  // the work of the heaviest plane of the lattice
  EXPECT_NEAR(below, above, layer);
}

// Along the longest side lie heavy bodies, of which every cut across it meets many.
TEST(Territories, AreCutWhereTheLeastWorkLiesInThePlane) {
  std::vector<WorkLoad> bodies = lattice(12, 10, 10);
  for (WorkLoad& body : bodies) {
    body.box_world.low.x() -= 0.5;
    body.box_world.high.x() += 0.5;
  }
  EXPECT_NE(axis_between(partition_space(bodies, 2)), 0);
  EXPECT_EQ(held_by_none(partition_space(bodies, 2), bodies), 0);
}

TEST(Territories, FillAllSpaceAndDoNotOverlap) {
  const std::vector<WorkLoad> bodies = cloud(500, {4, 3, 2});
  for (const int count : {1, 2, 3, 7})
    for (const std::vector<Box>& boxes :
         {partition_space(bodies, count), slabs_of_space(bodies, count)}) {
      ASSERT_EQ(boxes.size(), static_cast<std::size_t>(count));
      for (const WorkLoad& body : bodies) {
        const Vector3d point(body.middle(0), body.middle(1), body.middle(2));
        int times = 0;
        for (const Box& box : boxes) times += holds(box, {point, point}) ? 1 : 0;
        ASSERT_EQ(times, 1) << count << " boxes, at " << point.transpose();
      }
    }
}

// Boxes are a tenth as long as the room: of 4,000 bodies some 400 lie in the plane of one cut, and
// a tenth of these in that of the second, too. A second cut along the first would leave them all.
TEST(Territories, OfTheSecondPassHoldMostOfWhatCrossesThoseOfTheFirst) {
  struct Cuts {
    int count;
    double most_left;  // of those that cross the first
  };
  for (const auto& [count, most_left] : {Cuts{2, 0.15}, {4, 0.55}}) {
    const std::vector<WorkLoad> bodies = cloud(4000, {1.0, 0.9, 0.9});
    const std::vector<Box> regions = partition_space(bodies, count);
    std::vector<WorkLoad> crossing;
    for (const WorkLoad& body : bodies)
      if (held_by_none(regions, {body}) > 0) crossing.push_back(body);
    ASSERT_GT(crossing.size(), 300U) << count;
    const std::vector<Box> slabs = slabs_of_space(crossing, count);
    const double all = static_cast<double>(crossing.size()), left = held_by_none(slabs, crossing);
    EXPECT_LT(left, most_left * all) << count;
    // those at the ends have one plane, the others two
    for (const Box& slab : slabs) EXPECT_GT(work_held(slab, crossing), 0.3 * (all - left) / count);
  }
}

TEST(Territories, OfTheSecondPassAreOnePerThreadUnlessThePiecesAreTooMany) {
  EXPECT_EQ(slabs_for(1, 1), 0);
  EXPECT_EQ(slabs_for(16, 1), 0);  // regions for the caches: one thread needs no second pass
  EXPECT_EQ(slabs_for(2, 2), 2);
  EXPECT_EQ(slabs_for(8, 8), 8);
  EXPECT_EQ(slabs_for(64, 64), 0);
}

TEST(Territories, OfNoBodyAreStillThere) {
  EXPECT_EQ(partition_space({}, 3).size(), 3U);
  EXPECT_EQ(slabs_of_space({}, 3).size(), 3U);
}

}  // namespace
}  // namespace tumble::a4
