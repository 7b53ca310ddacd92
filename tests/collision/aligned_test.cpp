// Solids that are exactly aligned: their faces lie in one plane, and their corners meet exactly.
// Neither crosses a face of the other where it enters it.
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/collision/contact_patch.h"
#include "framework/collision/first_impact.h"
#include "framework/core/random.h"
#include "framework/geometry/solid.h"
#include "tests/support/places.h"

namespace tumble::testing::aligned_test {
namespace {

using collision::CollisionShape;
using collision::Gap;
using collision::Motion;
using collision::MotionState;
using collision::Pose;

// m: some ten roundings of solids of a metre that are turned. A gap of a neighbouring face, or one
// of 0 for solids in each other, is off by more than 1e-9 m.
constexpr double kRounding = 1e-14;

// Of a normal: roundings of 1e-16 m, seen over the least of the gaps, 1e-9 m. The wrong ones are
// off by 0.1 and more.
constexpr double kTurned = 1e-6;

/// A prism along z between two heights over a polygon, counter-clockwise, that is a star about its
/// first corner; its top may be wider.
CollisionShape prism(const std::vector<Vector3d>& corners, double low, double high,
                     double widening = 1.0) {
  TriangleMesh mesh;
  const int n = static_cast<int>(corners.size());
  for (const Vector3d& c : corners) mesh.vertices.emplace_back(c.x(), c.y(), low);
  for (const Vector3d& c : corners)
    mesh.vertices.emplace_back(widening * c.x(), widening * c.y(), high);
  for (int i = 1; i + 1 < n; ++i) {
    mesh.faces.push_back({0, i + 1, i});
    mesh.faces.push_back({n, n + i, n + i + 1});
  }
  for (int i = 0; i < n; ++i) {
    const int next = (i + 1) % n;
    mesh.faces.push_back({i, next, n + next});
    mesh.faces.push_back({i, n + next, n + i});
  }
  return CollisionShape{MeshSolid{mesh, false}};
}

// Legs 1 m long and 0.5 m wide, 1 m high; the corner between the legs is at the origin.
const std::vector<Vector3d> kL{{0, 0, 0},       {0, 0.5, 0},    {-0.5, 0.5, 0},
                               {-0.5, -0.5, 0}, {0.5, -0.5, 0}, {0.5, 0, 0}};
const std::vector<Vector3d> kSquare{{-0.5, -0.5, 0}, {0.5, -0.5, 0}, {0.5, 0.5, 0}, {-0.5, 0.5, 0}};

const std::vector<Quaterniond> kTurns{Quaterniond::Identity(), Quaterniond(0.5, 0.5, 0.5, 0.5),
                                      Quaterniond(Eigen::AngleAxisd(0.7, Vector3d(0.6, 0.0, 0.8)))};

/// The gap of A and B, placed by `offset` (of A from B) in a frame that is turned as a whole; also
/// asked for the other way round.
void expect_gap(const CollisionShape& a, const CollisionShape& b, const Vector3d& offset,
                double distance, const Vector3d& normal) {
  for (const Quaterniond& turn : kTurns) {
    const Pose pose_a{turn * offset, turn}, pose_b{Vector3d::Zero(), turn};
    const Gap gap = collision::compute_gap(a, pose_a, b, pose_b),
              flipped = collision::compute_gap(b, pose_b, a, pose_a);
    for (const Gap& found : {gap, flipped}) EXPECT_NEAR(found.distance, distance, kRounding);
    EXPECT_LT((gap.normal_b_to_a_world - turn * normal).norm(), kTurned);
    EXPECT_LT((flipped.normal_b_to_a_world + turn * normal).norm(), kTurned);
    EXPECT_EQ(collision::gap_distance(a, pose_a, b, pose_b), gap.distance);
  }
}

TEST(AlignedSolids, OneOnAnotherHaveTheGapOfTheirHeights) {
  const CollisionShape l = prism(kL, -0.5, 0.5);
  for (const double gap : {0.1, 1e-3, 1e-9, 0.0, -1e-12, -1e-9, -1e-3, -0.1})
    expect_gap(l, l, {0, 0, 1.0 + gap}, gap, Vector3d::UnitZ());
}

TEST(AlignedSolids, BesideEachOtherHaveTheGapOfTheFacesThatFaceEachOther) {
  const CollisionShape l = prism(kL, -0.5, 0.5);
  for (const double gap : {0.1, 1e-3, 1e-9, 0.0, -1e-12, -1e-9, -1e-3})
    expect_gap(l, l, {1.0 + gap, 0, 0}, gap, Vector3d::UnitX());
}

// No faces are in one plane: an edge of the upper one lies in a side of the lower one.
TEST(AlignedSolids, AnEdgeInAFaceIsInTheSolidWhereAFaceAtItLeadsInside) {
  const CollisionShape square = prism(kSquare, -0.5, 0.5),
                       widening = prism(kSquare, -0.5, 0.5, 1.5);
  for (const double gap : {1e-3, 1e-9, 0.0, -1e-9, -1e-3, -0.1})
    expect_gap(widening, square, {0, 0, 1.0 + gap}, gap, Vector3d::UnitZ());
}

// Two blades that touch with their edges, and lie on the same side of them: each is beneath one
// face of the other, and in neither.
TEST(AlignedSolids, BladesThatTouchWithTheirEdgesDoNotOverlap) {
  const auto at = [](double degrees) {
    return Vector3d(std::cos(degrees * M_PI / 180), std::sin(degrees * M_PI / 180), 0);
  };
  const CollisionShape one = prism({Vector3d::Zero(), at(45), at(55)}, -0.5, 0.5),
                       two = prism({Vector3d::Zero(), at(80), at(90)}, -0.5, 0.5);
  for (const Quaterniond& turn : kTurns) {
    const Gap gap = collision::compute_gap(one, {{0, 0, 0}, turn}, two, {{0, 0, 0}, turn});
    EXPECT_NEAR(gap.distance, 0.0, kRounding);
    const double between = std::cos(22.5 * M_PI / 180);  // from the middle of the two to a face
    EXPECT_GT((turn.conjugate() * gap.normal_b_to_a_world).dot(-at(67.5 + 90)), between - 1e-9);
  }
}

CollisionShape model(const std::string& name) {
  return CollisionShape{load_solid(test::source_dir() + "/models/" + name + ".3ds").solid};
}

// Two corners of each touch, with many faces at each: the normal is that of the symmetry, and both
// places carry.
TEST(AlignedSolids, CornersThatMeetCornersTouchAlongTheLineOfTheirSymmetry) {
  const CollisionShape dumbbell = model("dumbbell");
  const double reach = -dumbbell.corners().lowest_height(Vector3d::UnitX()) -
                       dumbbell.corners().lowest_height(-Vector3d::UnitX());
  const Pose a{Vector3d(reach, 0, 0)}, b;
  const Gap gap = collision::compute_gap(dumbbell, a, dumbbell, b);
  // the models' coordinates are of single precision
  EXPECT_LT((gap.normal_b_to_a_world - Vector3d::UnitX()).norm(), 1e-6);
  EXPECT_NEAR(gap.distance, 0.0, kRounding);
  EXPECT_EQ(collision::contact_patch(dumbbell, a, dumbbell, b, gap, 1e-9).corners.size(), 2U);
}

/// The first flies at the second, which hovers.
struct Flight {
  const CollisionShape& a;
  const CollisionShape& b;
  Vector3d along, aside;  // unit; of the second [m]
  Quaterniond turn;       // of the second

  std::optional<collision::Impact> impact() const {
    const auto flying = [](const Vector3d& from, const Vector3d& velocity,
                           const Quaterniond& turned) {
      return Motion{[=](double t) {
                      MotionState state;
                      state.pose = {from + t * velocity, turned};
                      state.velocity_world = velocity;
                      return state;
                    },
                    {}};
    };
    const auto most = [](const CollisionShape& shape, const Vector3d& direction) {
      return -shape.corners().lowest_height(-direction);
    };
    const double far = most(a, along) + most(b, turn.conjugate() * -along) + 0.01;
    return collision::first_impact(a, flying(-far * along, along, Quaterniond::Identity()), b,
                                   flying(aside, Vector3d::Zero(), turn), 0.0, 2 * far);
  }
};

TEST(AlignedSolids, DrawnMeetWhenTheyDoBesideTheLine) {
  // 3e-7 m aside, on slopes up to 20: later or earlier by 6e-6 m. Those that pass each other's
  // first faces are late by more than 1e-3 m.
  constexpr double kAside = 3e-7, kLater = 20 * kAside;
  const std::vector<std::string> names{"gear",     "l_shape",  "scoop",
                                       "t_handle", "dumbbell", "chess_pawn"};
  std::vector<CollisionShape> shapes;
  for (const std::string& name : names) shapes.push_back(model(name));
  Random random(11);
  for (int k = 0; k < 30; ++k) {
    const std::size_t i = random.below(names.size()),
                      j = random.unit() < 0.7 ? i : random.below(names.size());
    const int axis = static_cast<int>(random.below(3));
    const bool turned = random.below(2) == 1;
    const Quaterniond turn(
        turned ? Quaterniond(Eigen::AngleAxisd(M_PI, Vector3d::Unit((axis + 1) % 3)))
               : Quaterniond::Identity());
    const Vector3d along = Vector3d::Unit(axis);
    const Vector3d aside = kAside * (Vector3d::Ones() - along);
    const auto aligned = Flight{shapes[i], shapes[j], along, Vector3d::Zero(), turn}.impact(),
               beside = Flight{shapes[i], shapes[j], along, aside, turn}.impact();
    const std::string pair =
        names[i] + " and " + names[j] + " along " + "xyz"[axis] + (turned ? ", turned" : "");
    ASSERT_EQ(aligned.has_value(), beside.has_value()) << pair;
    if (!aligned) continue;
    EXPECT_NEAR(aligned->time, beside->time, kLater) << pair;
    // Along what they touch they also come nearer: no normal is across the motion.
    EXPECT_LT(aligned->rate, 0.5 * beside->rate) << pair;
  }
}

}  // namespace
}  // namespace tumble::testing::aligned_test
