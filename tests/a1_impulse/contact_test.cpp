// Before the blow: relative normal velocity (A1.5), its three cases (A1.6), contact normals in the plane (A1.7).
#include "tests/a1_impulse/a1_fixtures.h"

namespace tumble::testing {
namespace {

constexpr double kRoundoff = 20 * kEps;  // times the largest number involved: at most 40 roundings of eps / 2 each
const Vector3d kUp = Vector3d::UnitZ();

TEST(RelativeNormalVelocity, IsNegativeWhenTheyApproach) {
  Body a = ball(2.0, 0.5, {0, 0, 1}), b = ball(6.0, 0.5, {0, 0, 0});
  a.velocity_world = {7, 0, -3};
  b.velocity_world = {0, 0, 1};
  const double found = student().relative_normal_velocity({{0, 0, 0.5}, kUp}, a, b);
  expect_near(found, -4.0, kRoundoff * 7, "m/s",
              {.scene = "A at (7, 0, -3) m/s above B at (0, 0, 1) m/s, n = +z from B to A",
               .slip = likely(found, {{4.0, "u_b - u_a where u_a - u_b belongs: n points from B to A"}, {-3.0, "the other body's velocity left out"}},
                              "u_n = n . (u_a - u_b)"),
               .handout = equation("5")});
}

TEST(RelativeNormalVelocity, CountsTheSpin) {
  Body a = block({5, 3, 1});
  a.omega_world = {0, 3, 0};
  const double found = student().relative_normal_velocity({{6, 3, 0}, kUp}, a, wall({0, 0, 0}));
  expect_near(found, -3.0, kRoundoff * 18, "m/s",
              {.scene = "a block that hovers with its centre at (5, 3, 1) m and spins at 3 rad/s about y touches the floor at (6, 3, 0) m",
               .slip = likely(found,
                              {{0.0, "relative velocity without rotation: the touching point moves at v + w x r"},
                               {3.0, "r x w where w x r belongs"},
                               {-18.0, "the arm starts at the world's origin: r = p - x"}},
                              "u = v + w x r"),
               .handout = equation("5")});
}

TEST(RelativeNormalVelocity, CountsTheSpinOfBoth) {
  Body a = block({5, 3, 1}), b = block({5, 3, -2});
  a.omega_world = {0, 3, 0};
  b.omega_world = {0, -2, 0};
  const double found = student().relative_normal_velocity({{6, 3, 0}, kUp}, a, b);
  expect_near(found, -5.0, kRoundoff * 18, "m/s",
              {.scene = "two blocks spin against each other, 3 and -2 rad/s about y, and touch 1 m off their centres",
               .slip = likely(found,
                              {{-3.0, "the other body's spin left out"},
                               {-1.0, "the other body's part has the wrong sign"},
                               {0.0, "relative velocity without rotation: the touching point moves at v + w x r"},
                               {5.0, "r x w where w x r belongs"}},
                              "u = v + w x r for each body with its own arm"),
               .handout = equation("5")});
}

TEST(RelativeNormalVelocity, DrivenWallsMoveToo) {
  Body b = wall({0, 0, 0});
  b.velocity_world = {0, 0, 2};
  const double found = student().relative_normal_velocity({{0, 0, 0}, kUp}, ball(2.0, 0.5, {0, 0, 0.5}), b);
  expect_near(found, -2.0, kRoundoff * 2, "m/s",
              {.scene = "a floor that rises at 2 m/s meets a resting ball",
               .slip = "an immovable body taken to be at rest: infinite mass says nothing about its velocity",
               .handout = equation("5")});
}

std::string name_of(a1::RelativeMotion motion) {
  switch (motion) {
    case a1::RelativeMotion::kApproaching: return "approaching";
    case a1::RelativeMotion::kResting: return "resting";
    case a1::RelativeMotion::kSeparating: return "separating";
  }
  return "none of the three";
}

void expect_case(double normal_velocity, a1::RelativeMotion expected, const std::string& slip) {
  const a1::RelativeMotion found = student().classify_relative_motion(normal_velocity, 0.001);
  expect_true(found == expected, name_of(expected), name_of(found),
              {.scene = "u_n = " + show(normal_velocity) + " m/s, tolerance 0.001 m/s", .slip = slip, .handout = equation("6")});
}

TEST(RelativeMotionCases, SignTellsApproachingFromSeparating) {
  const std::string slip = "the sign: the gap shrinks when u_n is negative";
  expect_case(-2.0, a1::RelativeMotion::kApproaching, slip);
  expect_case(2.0, a1::RelativeMotion::kSeparating, slip);
}

TEST(RelativeMotionCases, SmallEitherWayIsResting) {
  if (!tells_motions_apart()) return;
  const std::string slip = "the tolerance: resting is |u_n| <= tolerance, on both sides of 0";
  expect_case(0.0, a1::RelativeMotion::kResting, slip);
  expect_case(-0.0005, a1::RelativeMotion::kResting, slip);
  expect_case(0.0005, a1::RelativeMotion::kResting, slip);
}

TEST(RelativeMotionCases, ExactlyAtTheToleranceIsResting) {
  if (!tells_motions_apart()) return;
  const std::string slip = "the border: a value exactly at the tolerance is resting";
  expect_case(0.001, a1::RelativeMotion::kResting, slip);
  expect_case(-0.001, a1::RelativeMotion::kResting, slip);
}

const std::string kNotUnit = "normal not unit: divide by its length";
const std::string kFromAToB = "the normal points from A to B";

TEST(ContactNormal2d, VertexEdgeIsPerpendicularTowardsTheVertex) {
  const Vector2d found = student().contact_normal_vertex_edge({-0.5, 0.75}, {0, 0}, {3, 4});
  expect_near(found, Vector2d(-0.8, 0.6), kRoundoff, "(unit)",
              {.scene = "corner (-0.5, 0.75) of A left of the edge (0, 0) -> (3, 4) of B",
               .slip = likely<2>(found,
                                 {{{-4, 3}, kNotUnit},
                                  {{4, -3}, kNotUnit + ", and it is on the wrong side"},
                                  {{0.8, -0.6}, kFromAToB + ": take the side of the edge where the corner is"},
                                  {{0.6, 0.8}, "the direction of the edge, not its perpendicular"}},
                                 "perpendicular to the edge, unit, on the corner's side"),
               .handout = equation("7")});
}

TEST(ContactNormal2d, VertexExactlyOnTheEdgeTakesTheOutsideOfACounterClockwiseBody) {
  const Vector2d found = student().contact_normal_vertex_edge({1.5, 2}, {0, 0}, {3, 4});
  expect_near(found, Vector2d(0.8, -0.6), kRoundoff, "(unit)",
              {.scene = "corner (1.5, 2) of A exactly on the edge (0, 0) -> (3, 4) of B",
               .slip = likely<2>(found, {{{4, -3}, kNotUnit}, {{-4, 3}, kNotUnit}, {{-0.8, 0.6}, "the left-hand side: B is listed counter-clockwise, outside is on the right"}},
                                 "no side to be seen: take the right-hand side of start -> end"),
               .handout = equation("7")});
}

TEST(ContactNormal2d, EdgeEdgePointsToTheCentreOfAHoweverTheEdgeIsListed) {
  for (const bool turned : {false, true}) {
    const Vector2d start = turned ? Vector2d(4, 3) : Vector2d(0, 0), end = turned ? Vector2d(0, 0) : Vector2d(4, 3);
    const Vector2d found = student().contact_normal_edge_edge(start, end, {-3, 4});
    expect_near(found, Vector2d(-0.6, 0.8), kRoundoff, "(unit)",
                {.scene = std::string("edge ") + (turned ? "(4, 3) -> (0, 0)" : "(0, 0) -> (4, 3)") + " of B, centre of A at (-3, 4)",
                 .slip = likely<2>(found, {{{-3, 4}, kNotUnit}, {{3, -4}, kNotUnit}, {{0.6, -0.8}, kFromAToB + ": take the side of A's centre"}},
                                   "perpendicular to the edge, unit, on the side of A's centre"),
                 .handout = equation("7")});
  }
}

TEST(ContactNormal2d, VertexVertexIsTheLineOfCentres) {
  const Vector2d found = student().contact_normal_vertex_vertex({4, 5}, {1, 1});
  expect_near(found, Vector2d(0.6, 0.8), kRoundoff, "(unit)",
              {.scene = "corner on corner; centre of A at (4, 5), of B at (1, 1)",
               .slip = likely<2>(found, {{{3, 4}, kNotUnit}, {{-3, -4}, kNotUnit}, {{-0.6, -0.8}, kFromAToB}}, "(x_a - x_b) / |x_a - x_b|"),
               .handout = equation("7")});
}

}  // namespace
}  // namespace tumble::testing
