// Fast methods against slow ones: gaps of convex solids against 33 digits, the broad phase against
// testing all pairs, queries with a cache against queries without.
#include <cmath>
#include <cstring>
#include <random>

#include <gtest/gtest.h>

#include "tests/support/places.h"
#include "framework/collision/first_impact.h"
#include "framework/collision/manifold_points.h"
#include "framework/collision/sweep.h"
#include "framework/collision/time_bound.h"
#include "framework/geometry/solid.h"
#include "tests/collision/exhaustive.h"
#include "tests/collision/hulls.h"

namespace tumble::testing::fast_paths_test {
namespace {

using collision::CollisionShape;
using collision::Gap;
using collision::ManifoldPoint;
using collision::Motion;
using collision::MotionState;
using collision::PairCache;
using collision::Pose;

class Chance {
 public:
  explicit Chance(unsigned seed) : random_(seed) {}
  double in(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  int below(int n) { return std::uniform_int_distribution<int>(0, n - 1)(random_); }
  Vector3d vector() { return {in(-1, 1), in(-1, 1), in(-1, 1)}; }
  Quaterniond turn() {
    return Quaterniond(in(-1, 1), in(-1, 1), in(-1, 1), in(-1, 1)).normalized();
  }

 private:
  std::mt19937_64 random_;
};

TriangleMesh scaled(TriangleMesh mesh, double scale) {
  for (Vector3d& v : mesh.vertices) v *= scale;
  return mesh;
}

Shape model(const std::string& name) {
  return load_solid(test::source_dir() + "/models/" + name + ".3ds").solid;
}

struct Convex {
  std::string name;
  TriangleMesh mesh;
  Shape shape;
};

std::vector<Convex> convex_solids(double scale) {
  std::vector<Convex> solids;
  for (const Vector3d& half :
       {Vector3d(0.5, 0.4, 0.3), Vector3d(0.5, 0.5, 0.5), Vector3d(0.7, 0.5, 0.001)}) {
    const Box box{scale * half};
    solids.push_back({"box", surface_of(box), box});
  }
  for (const Shape& shape : {random_hull(8, 2), random_hull(14, 1), model("wedge")}) {
    const TriangleMesh mesh = scaled(surface_of(shape), scale);
    solids.push_back({"hull", mesh, MeshSolid{mesh, true}});
  }
  return solids;
}

/// Relative orientations as in heaps and stacks: arbitrary, edge along edge, face to face, and
/// nearly so.
struct Placing {
  Quaterniond turn_a, turn_b;
  Vector3d line;

  explicit Placing(Chance& chance)
      : turn_a(chance.turn()), turn_b(chance.turn()), line(chance.vector().normalized()) {
    const int kind = chance.below(5);
    if (kind == 0) return;
    turn_a = turn_b = Quaterniond::Identity();
    if (kind == 2) turn_a = Eigen::AngleAxisd(chance.in(0, 6), Vector3d::UnitZ());
    if (kind >= 3)
      turn_a = Eigen::AngleAxisd(std::pow(10.0, chance.in(-16, -3)), chance.vector().normalized());
    const int way = chance.below(3);
    if (way == 0) line = Vector3d(0.3 * chance.in(-1, 1), 0.2 * chance.in(-1, 1), 1).normalized();
    // edges and corners exactly above each other
    if (way == 1) line = Vector3d::Unit(chance.below(3));
  }
};

constexpr double kGaps[] = {0,     1e-15, -1e-15, 1e-13, -1e-13, 1e-12, 1e-10, -1e-10, 1e-8,
                            -1e-8, 1e-6,  -1e-6,  1e-4,  1e-2,   -1e-2, -0.1,  -0.3,   1};

Pose brought_to(double goal, const CollisionShape& a, const CollisionShape& b,
                const Placing& placing, const Pose& pose_b, double scale) {
  Pose pose{pose_b.com_world, placing.turn_a};
  double low = 0.0, high = 4 * scale;
  for (;;) {
    const double middle = 0.5 * (low + high);
    if (!(middle > low && middle < high)) break;
    pose.com_world = pose_b.com_world + middle * placing.line;
    (collision::compute_gap(a, pose, b, pose_b).distance < goal ? low : high) = middle;
  }
  pose.com_world = pose_b.com_world + high * placing.line;
  return pose;
}

// Coordinates are up to 2 times the scale, each vertex and height rounded a few times: 100
// roundings are 2e-14. The axis of edges at an angle below 1e-9 rad may be skipped, which adds no
// more. Nearest points with a rounded direction are off by up to 1e-8.
constexpr double kRoundings = 100 * 2.220446049250313e-16;

class ConvexGap : public ::testing::TestWithParam<double> {};

TEST_P(ConvexGap, IsAccurateInEveryRelativePose) {
  const double scale = GetParam();
  const std::vector<Convex> solids = convex_solids(scale);
  Chance chance(21);
  for (int k = 0; k < 900; ++k) {
    const Convex &one = solids[chance.below(static_cast<int>(solids.size()))],
                 &other = solids[chance.below(static_cast<int>(solids.size()))];
    const CollisionShape a(one.shape), b(other.shape);
    const Placing placing(chance);
    const double goal = scale * kGaps[chance.below(static_cast<int>(std::size(kGaps)))];
    const Pose pose_b{Vector3d::Zero(), placing.turn_b},
        pose_a = brought_to(goal, a, b, placing, pose_b, scale);
    const Gap found = collision::compute_gap(a, pose_a, b, pose_b);
    const double truth =
        static_cast<double>(exact_gap(placed_exactly(one.mesh, pose_a, pose_b.com_world),
                                      placed_exactly(other.mesh, pose_b, pose_b.com_world)));
    EXPECT_NEAR(found.distance, truth, kRoundings * scale)
        << one.name << " and " << other.name << " at gap " << goal << ", sample " << k;
    EXPECT_NEAR(found.normal_b_to_a_world.norm(), 1.0, 1e-14);
    EXPECT_NEAR((found.point_a_world - found.point_b_world).dot(found.normal_b_to_a_world),
                found.distance, kRoundings * scale);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Scales, ConvexGap, ::testing::Values(1e-6, 1.0, 1e6), [](const auto& info) {
      return std::string(info.param < 1 ? "Tiny" : info.param > 1 ? "Huge" : "Metres");
    });

TEST(ConvexGaps, FarFromTheOriginEqualThoseNearIt) {
  const std::vector<Convex> solids = convex_solids(1.0);
  Chance chance(22);
  const Vector3d far(1048576.0, -524288.0, 262144.0);
  for (int k = 0; k < 300; ++k) {
    const CollisionShape a(solids[chance.below(6)].shape), b(solids[chance.below(6)].shape);
    const Placing placing(chance);
    Pose pose_b{far + chance.vector(), placing.turn_b};
    const Pose pose_a = brought_to(kGaps[chance.below(static_cast<int>(std::size(kGaps)))], a, b,
                                   placing, pose_b, 1.0);
    // The difference of the positions is exact: the query near the origin is identical.
    const Gap there = collision::compute_gap(a, pose_a, b, pose_b);
    const Gap here =
        collision::compute_gap(a, {pose_a.com_world - pose_b.com_world, pose_a.world_from_body}, b,
                               {Vector3d::Zero(), pose_b.world_from_body});
    EXPECT_EQ(there.distance, here.distance);
    EXPECT_EQ(there.normal_b_to_a_world, here.normal_b_to_a_world);
  }
}

TEST(ManifoldPoints, OfBoxesFaceToFaceAreTheirCornersAtEveryGap) {
  const CollisionShape a{Box{{0.5, 0.4, 0.3}}}, b{Box{{0.6, 0.6, 0.2}}};
  Chance chance(23);
  for (int k = 0; k < 400; ++k) {
    const double gap = kGaps[chance.below(11)];
    const Pose pose_a{{0.05 * chance.in(-1, 1), 0.05 * chance.in(-1, 1), 0.5 + gap},
                      Quaterniond(Eigen::AngleAxisd(chance.in(-0.1, 0.1), Vector3d::UnitZ()))};
    const double exact = pose_a.com_world.z() - 0.3 - 0.2;
    const std::vector<ManifoldPoint> points = collision::manifold_points(a, pose_a, b, {}, 1e-5);
    // the upper box's corners, which are inside the lower one's face
    ASSERT_EQ(points.size(), 4u) << "gap " << gap;
    for (const ManifoldPoint& p : points) {
      EXPECT_NEAR(p.gap, exact, 1e-15);
      EXPECT_NEAR(p.normal_b_to_a_world.z(), 1.0, 1e-15);
      EXPECT_NEAR((pose_a.world_from_body.conjugate() * (p.point_a_world - pose_a.com_world))
                      .cwiseAbs()
                      .x(),
                  0.5, 1e-14);
    }
  }
}

TEST(ManifoldPoints, OfABoxAgainstAWallAndAFloorOfOneMeshHaveBothNormals) {
  // An L of three cubes: a box in its inner corner touches two faces at once.
  const Shape l_shape = model("l_shape");
  const CollisionShape l(l_shape), box{Box{{0.2, 0.2, 0.2}}};
  const TriangleMesh& mesh = std::get<MeshSolid>(l_shape).mesh_body;
  // The inner edge: its vertices, around which three quarters of a small ball are solid, lie in the
  // middle of the two long axes.
  Vector3d low = mesh.vertices[0], high = low;
  for (const Vector3d& v : mesh.vertices) {
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  int thin = 0;
  (high - low).minCoeff(&thin);
  const int u = (thin + 1) % 3, v = (thin + 2) % 3;
  for (const double side_u : {-1.0, 1.0})
    for (const double side_v : {-1.0, 1.0}) {
      Pose pose;
      pose.com_world = 0.5 * (low + high);
      pose.com_world[u] += side_u * (0.2 + 1e-7);
      pose.com_world[v] += side_v * (0.2 + 1e-7);
      if (collision::overlapping(box, pose, l, {}, 0.0)) continue;  // the three solid quarters
      const auto points = collision::manifold_points(box, pose, l, {}, 1e-5);
      int push_u = 0, push_v = 0;
      for (const ManifoldPoint& p : points) {
        if (std::abs(p.normal_b_to_a_world[u] - side_u) < 1e-9) ++push_u;
        if (std::abs(p.normal_b_to_a_world[v] - side_v) < 1e-9) ++push_v;
        EXPECT_NEAR(p.gap, 1e-7, 1e-13);
      }
      EXPECT_EQ(push_u, 4);
      EXPECT_EQ(push_v, 4);
    }
}

TEST(ManifoldPoints, OfABallAgainstTwoEdgesThatMeetInACornerAreOneOnEach) {
  // Under the bar of a T, beside its stem: the ball touches an edge of each, and both edges end in
  // the inner corner, where the other part protrudes.
  const Shape t_shape = model("t_handle");
  const CollisionShape t(t_shape), ball{Sphere{0.1}};
  const std::vector<Vector3d>& vertices = std::get<MeshSolid>(t_shape).mesh_body.vertices;
  Vector3d high = vertices[0];
  for (const Vector3d& v : vertices) high = high.cwiseMax(v);
  // outline of the model: the bar's end and top, the stem's half width of 0.075
  const Vector3d about = high - Vector3d(0.425, 0.15, 0.0);
  const Vector3d corner = *std::min_element(vertices.begin(), vertices.end(),
                                            [&](const Vector3d& v, const Vector3d& w) {
                                              return (v - about).norm() < (w - about).norm();
                                            });
  constexpr double kGap = 1e-6;
  const double aside = (0.1 + kGap) / std::sqrt(2.0);
  const auto points =
      collision::manifold_points(ball, {corner + Vector3d(aside, -aside, aside)}, t, {}, 1e-5);
  ASSERT_EQ(points.size(), 2u);
  const Vector3d from_stem = Vector3d(1, 0, 1).normalized(),
                 from_bar = Vector3d(0, -1, 1).normalized();
  for (const Vector3d& n : {from_stem, from_bar})
    EXPECT_TRUE(std::any_of(points.begin(), points.end(), [&](const ManifoldPoint& p) {
      return (p.normal_b_to_a_world - n).norm() < 1e-9;
    })) << n.transpose();
  // a few roundings of coordinates below 1
  for (const ManifoldPoint& p : points) EXPECT_NEAR(p.gap, kGap, 1e-15);
}

void expect_same_bits(const Gap& a, const Gap& b) {
  EXPECT_EQ(a.distance, b.distance);
  EXPECT_EQ(a.normal_b_to_a_world, b.normal_b_to_a_world);
  EXPECT_EQ(a.point_a_world, b.point_a_world);
  EXPECT_EQ(a.point_b_world, b.point_b_world);
}

// Queries with limits, small before large and large before small, in the same poses and after other
// poses: within the limit the exact distance, bit for bit; beyond it a lower bound that is beyond
// the limit too.
void expect_exact_within_limits(const CollisionShape& a, const Pose& pose_a,
                                const CollisionShape& b, const Pose& pose_b, double distance,
                                double some, PairCache& cache) {
  const Pose aside{pose_a.com_world + Vector3d(0, 0, some), pose_a.world_from_body};
  for (const double limit :
       {0.5 * distance, some, 2 * distance, 0.0, distance, std::nextafter(distance, -1e300)}) {
    // the result for a small limit must not be used for a large one
    collision::gap_distance(a, some < 0 ? aside : pose_a, b, pose_b, &cache, 0.0);
    for (PairCache* const kept : {&cache, &cache, static_cast<PairCache*>(nullptr)}) {
      const double found = collision::gap_distance(a, pose_a, b, pose_b, kept, limit);
      if (distance <= limit)
        EXPECT_EQ(found, distance) << "limit " << limit;
      else
        EXPECT_TRUE(found > limit && found <= distance)
            << found << " for " << distance << ", limit " << limit;
    }
  }
}

// Two pawns of 3280 faces that part, one turning: within ten seconds every face could reach every
// other, ten million pairs, of which a bound that looks less far ahead tests a hundredth at most.
TEST(PairCache, HoldsFewPairsOfSolidsThatPassEachOther) {
  const CollisionShape pawn(model("chess_pawn"));
  const double size = pawn.bounding_radius();
  const MotionState still{{Vector3d::Zero(), Quaterniond::Identity()}};
  const Motion at_rest{[&](double) { return still; }, {}};
  Motion parting{[&](double t) {
                   return MotionState{{Vector3d((1.2 + t) * size, 0, 0),
                                       Quaterniond(Eigen::AngleAxisd(t, Vector3d::UnitX()))},
                                      Vector3d(size, 0, 0),
                                      Vector3d::UnitX()};
                 },
                 {}};
  parting.bounds.angular_speed = 1.0;
  PairCache cache;
  collision::ImpactCost cost;
  const double all = std::pow(static_cast<double>(pawn.pieces().size()), 2);
  const MotionState start = parting.at(0.0);
  ASSERT_GT(collision::gap_distance(pawn, start.pose, pawn, still.pose), 0.0);
  collision::bound_time_apart(pawn, start, parting.bounds, pawn, still, {}, 10.0, &cache);
  EXPECT_LT(static_cast<double>(cache.near.size()), 1e-2 * all);
  // each round looks farther than the one before, as the gap grows
  EXPECT_FALSE(collision::first_impact(pawn, parting, pawn, at_rest, 0.0, 10.0, {}, &cost));
  EXPECT_LT(cost.gap_evaluations, 100);
}

TEST(PairCache, ChangesNoBitOfAnyAnswer) {
  Chance chance(24);
  for (const auto& [name_a, name_b] :
       {std::pair("t_handle", "l_shape"), std::pair("l_shape", "l_shape"),
        std::pair("t_handle", "t_handle"), std::pair("torus", "t_handle")}) {
    const CollisionShape a(model(name_a)), b(model(name_b)), hull(random_hull(14, 3));
    for (const CollisionShape* first : {&a, &hull}) {
      PairCache cache;
      Pose pose_a{
          0.7 * chance.vector().normalized() * (first->bounding_radius() + b.bounding_radius()),
          chance.turn()};
      Pose pose_b{Vector3d::Zero(), chance.turn()};
      const double size = std::min(first->bounding_radius(), b.bounding_radius());
      for (int step = 0; step < 60; ++step) {
        // Mostly small moves, as in a heap, rarely large ones; towards each other until they touch.
        const double stride = step % 20 == 19 ? 0.5 : std::pow(10.0, chance.in(-9, -1.5));
        pose_a.com_world += stride * size * chance.vector() - 0.1 * stride * pose_a.com_world;
        pose_a.world_from_body =
            (pose_a.world_from_body *
             Quaterniond(Eigen::AngleAxisd(stride, chance.vector().normalized())))
                .normalized();
        const Gap gap = collision::compute_gap(*first, pose_a, b, pose_b);
        expect_same_bits(gap, collision::compute_gap(*first, pose_a, b, pose_b, &cache));
        EXPECT_EQ(gap.distance, collision::gap_distance(*first, pose_a, b, pose_b));
        EXPECT_EQ(gap.distance, collision::gap_distance(*first, pose_a, b, pose_b, &cache));
        expect_exact_within_limits(*first, pose_a, b, pose_b, gap.distance, chance.in(-1, 1) * size,
                                   cache);
        const double reach = size * std::pow(10.0, chance.in(-9, -1));
        const auto points = collision::manifold_points(*first, pose_a, b, pose_b, reach),
                   kept = collision::manifold_points(*first, pose_a, b, pose_b, reach, &cache);
        ASSERT_EQ(points.size(), kept.size());
        for (std::size_t i = 0; i < points.size(); ++i) {
          EXPECT_EQ(points[i].point_a_world, kept[i].point_a_world);
          EXPECT_EQ(points[i].normal_b_to_a_world, kept[i].normal_b_to_a_world);
          EXPECT_EQ(points[i].gap, kept[i].gap);
        }
        if (step % 4 != 0 || gap.distance < 0) continue;
        const Vector3d velocity = -3 * size * pose_a.com_world.normalized(),
                       omega = chance.vector();
        Motion moving{[&](double t) {
                        return MotionState{
                            {pose_a.com_world + t * velocity,
                             Quaterniond(Eigen::AngleAxisd(omega.norm() * t, omega.normalized())) *
                                 pose_a.world_from_body},
                            velocity,
                            omega};
                      },
                      {}};
        moving.bounds.angular_speed = omega.norm();
        const Motion still{[&](double) {
                             return MotionState{pose_b, Vector3d::Zero(), Vector3d::Zero()};
                           },
                           {}};
        collision::ImpactOptions options;
        const auto plain = collision::first_impact(*first, moving, b, still, 0.0, 0.02, options);
        options.cache = &cache;
        const auto faster = collision::first_impact(*first, moving, b, still, 0.0, 0.02, options);
        ASSERT_EQ(plain.has_value(), faster.has_value());
        if (!plain) continue;
        EXPECT_EQ(plain->time, faster->time);
        expect_same_bits(plain->gap, faster->gap);
      }
    }
  }
}

TEST(PairCache, ChangesNoBitForConvexSolidsEither) {
  Chance chance(26);
  const CollisionShape a(random_hull(14, 3)), b(random_hull(9, 4));
  PairCache cache;
  const double size = std::min(a.bounding_radius(), b.bounding_radius());
  for (int k = 0; k < 300; ++k) {
    const Pose pose_a{chance.in(0.3, 1.6) * size * chance.vector(), chance.turn()},
        pose_b{Vector3d::Zero(), chance.turn()};
    expect_exact_within_limits(a, pose_a, b, pose_b, collision::gap_distance(a, pose_a, b, pose_b),
                               chance.in(-1, 1) * size, cache);
  }
}

// In small moves, as in a heap, an axis and two points of the last answer stay good for the next.
TEST(PairCache, ChangesNoBitForRocksThatRollOnEachOther) {
  Chance chance(27);
  const CollisionShape a(random_hull(20, 5)), b(random_hull(20, 6));
  PairCache cache;
  const double size = std::min(a.bounding_radius(), b.bounding_radius());
  Pose pose_a{{0, 0, 1.7 * size}, chance.turn()};
  const Pose pose_b{Vector3d::Zero(), chance.turn()};
  int within = 0;
  for (int step = 0; step < 1000; ++step) {
    // to and fro about touching, to a tenth of their size
    const double gap = collision::gap_distance(a, pose_a, b, pose_b),
                 wanted = 0.1 * size * std::sin(0.05 * step);
    pose_a.com_world +=
        0.3 * (wanted - gap) * pose_a.com_world.normalized() + 0.01 * size * chance.vector();
    pose_a.world_from_body = (Quaterniond(Eigen::AngleAxisd(0.05, chance.vector().normalized())) *
                              pose_a.world_from_body)
                                 .normalized();
    const double now = collision::gap_distance(a, pose_a, b, pose_b);
    for (const double reach : {0.0, 0.01 * size, 0.1 * size, now, std::nextafter(now, -1e300)}) {
      EXPECT_EQ(collision::is_within(a, pose_a, b, pose_b, reach, &cache), now <= reach);
      within += now <= reach;
      const auto points = collision::manifold_points(a, pose_a, b, pose_b, reach),
                 kept = collision::manifold_points(a, pose_a, b, pose_b, reach, &cache);
      ASSERT_EQ(points.size(), kept.size());
      for (std::size_t i = 0; i < points.size(); ++i) {
        EXPECT_EQ(points[i].point_a_world, kept[i].point_a_world);
        EXPECT_EQ(points[i].gap, kept[i].gap);
      }
    }
    expect_exact_within_limits(a, pose_a, b, pose_b, now, chance.in(-0.1, 0.1) * size, cache);
  }
  EXPECT_GT(within, 1000);
  EXPECT_LT(within, 4000);
}

// The index is that of the first vertex of the lowest ones, whatever the number of vertices.
TEST(Polytope, LowestVertexIsThatOfTryingAll) {
  Chance chance(28);
  for (const int n : {1, 2, 3, 8, 20, 63, 64, 65, 127, 128, 129, 300}) {
    collision::Polytope polytope;
    for (int i = 0; i < n; ++i)  // on a coarse grid: many are as low as each other
      polytope.vertices.push_back({std::round(chance.in(-2, 2)), std::round(chance.in(-2, 2)),
                                   std::round(chance.in(-2, 2))});
    polytope.prepare();
    for (int k = 0; k < 40; ++k) {
      const Vector3d d = k < 6 ? Vector3d((k % 2 ? 1 : -1) * Vector3d::Unit(k / 2))
                               : Vector3d(std::round(chance.in(-3, 3)), 1, 2);
      int lowest = 0;  // of whole numbers: exact in any order
      for (int i = 1; i < n; ++i)
        if (d.dot(polytope.vertices[static_cast<std::size_t>(i)]) <
            d.dot(polytope.vertices[static_cast<std::size_t>(lowest)]))
          lowest = i;
      double height;
      EXPECT_EQ(polytope.lowest(d, height), lowest) << n << " vertices";
      EXPECT_EQ(height, d.dot(polytope.vertices[static_cast<std::size_t>(lowest)]));
      EXPECT_EQ(polytope.lowest_height(d), height);
    }
  }
}

// A line is inside a convex solid from where it has passed the last face that looks against it.
TEST(Polytope, EntryIsThatOfTryingAllFaces) {
  Chance chance(29);
  constexpr double kSteep = 0.05;
  for (const int n : {0, 1, 2, 3, 4, 5, 31, 64}) {
    collision::Polytope polytope;
    for (int i = 0; i < std::max(n, 1); ++i) polytope.vertices.push_back(chance.vector());
    for (int f = 0; f < n; ++f) polytope.face_normals.push_back(chance.vector().normalized());
    polytope.prepare();
    for (int k = 0; k < 40; ++k) {
      const Vector3d direction = chance.vector().normalized(), point = chance.vector();
      double entry = -std::numeric_limits<double>::infinity();
      for (int f = 0; f < n; ++f) {
        const Vector3d& m = polytope.face_normals[static_cast<std::size_t>(f)];
        if (const double lean = direction.dot(m); lean <= -kSteep)
          entry = std::max(
              entry, (polytope.face_offsets[static_cast<std::size_t>(f)] - m.dot(point)) / lean);
      }
      // the sums are those of the loop, in its order: a rounding of each is all that may differ
      const double rounding = 8 * std::numeric_limits<double>::epsilon() / kSteep;
      const double found = polytope.entry_along(direction, point, kSteep);
      if (std::isinf(entry))
        EXPECT_EQ(found, entry) << n << " faces";
      else
        EXPECT_NEAR(found, entry, rounding * (1 + std::abs(entry))) << n << " faces";
    }
  }
}

TEST(BroadPhase, FindsTheSamePairsAsTestingAll) {
  Chance chance(25);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const int n : {0, 1, 2, 5, 17, 64, 300}) {
    for (int k = 0; k < 6; ++k) {
      std::vector<collision::SweptBox> boxes;
      for (int i = 0; i < n; ++i) {
        const Vector3d middle = std::round(4 * chance.in(0, 1)) * Vector3d::Ones() +
                                (k % 2 ? 6.0 : 0.0) * chance.vector();
        const Vector3d half = std::pow(10.0, chance.in(-3, 0.5)) * chance.vector().cwiseAbs();
        boxes.push_back({middle - half, middle + half, chance.below(3) > 0});
        if (chance.below(40) == 0)
          boxes.back() = {Vector3d::Constant(-kInfinity), Vector3d::Constant(kInfinity),
                          chance.below(2) > 0};
        if (chance.below(40) == 0) boxes.back().high.z() = kInfinity;
        // boxes that just touch
        if (i > 0 && chance.below(10) == 0)
          boxes.back().low =
              boxes[static_cast<std::size_t>(chance.below(i))].high.cwiseMin(boxes.back().high);
      }
      std::vector<std::pair<int, int>> expected;
      for (int i = 0; i < n; ++i)
        for (int j = i + 1; j < n; ++j)
          if ((boxes[i].can_move || boxes[j].can_move) &&
              (boxes[i].low.array() <= boxes[j].high.array()).all() &&
              (boxes[j].low.array() <= boxes[i].high.array()).all())
            expected.emplace_back(i, j);
      EXPECT_EQ(collision::overlapping_pairs(boxes), expected) << n << " boxes";
    }
  }
}

// Boxes that creep, and now and then leap far; what stands may begin to move.
TEST(BroadPhase, FindsTheSamePairsOfMovingBoxesAsAnew) {
  Chance chance(26);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double leap : {0.0, 0.02, 1.0}) {
    collision::NearBoxes near;
    std::vector<collision::SweptBox> boxes;
    for (int i = 0; i < 60; ++i) {
      const Vector3d middle = 4.0 * chance.vector(), half = 0.6 * chance.vector().cwiseAbs();
      boxes.push_back({middle - half, middle + half, chance.below(3) > 0});
    }
    boxes[7] = {Vector3d::Constant(-kInfinity), Vector3d::Constant(kInfinity), false};
    std::size_t met = 0;
    for (int step = 0; step < 400; ++step) {
      EXPECT_EQ(near.overlapping_pairs(boxes), collision::overlapping_pairs(boxes)) << step;
      met += collision::overlapping_pairs(boxes).size();
      for (collision::SweptBox& box : boxes) {
        const Vector3d way = (chance.in(0, 1) < leap ? 1.0 : 0.01) * chance.vector();
        box.low += way;
        box.high += way;
        if (chance.below(200) == 0) box.can_move = !box.can_move;
      }
    }
    EXPECT_GT(met, 400u);  // or there was nothing to find
  }
}

}  // namespace
}  // namespace tumble::testing::fast_paths_test
