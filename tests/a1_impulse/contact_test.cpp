// Before the impact: relative normal velocity (A1.5), its three cases (A1.6), contact normals in
// the plane (A1.7).
#include "tests/a1_impulse/a1_fixtures.h"

namespace tumble::testing {
namespace {

TEST(RelativeNormalVelocity, IsNegativeWhenTheyApproach) {
  Body a = ball(2.0, 0.5, {0, 0, 1}), b = ball(6.0, 0.5, {0, 0, 0});
  a.velocity_world = {7, 0, -3};
  b.velocity_world = {0, 0, 1};
  const double found = student().relative_normal_velocity({{0, 0, 0.5}, kUp}, a, b);
  expect_near(found, -4.0, kRoundoff * 7, "m/s",
              {.scene = "A at (7, 0, -3) m/s above B at (0, 0, 1) m/s, n = +z from B to A",
               .slip = likely(found,
                              {{4.0, "u_b - u_a where u_a - u_b belongs: n points from B to A"},
                               {-3.0, "the other body's velocity left out"}},
                              "u_n = n . (u_a - u_b)"),
               .handout = equation("5")});
}

TEST(RelativeNormalVelocity, CountsTheSpin) {
  Body a = block({5, 3, 1});
  a.omega_world = {0, 3, 0};
  const double found = student().relative_normal_velocity({{6, 3, 0}, kUp}, a, wall({0, 0, 0}));
  expect_near(
      found, -3.0, kRoundoff * 18, "m/s",
      {.scene = "a block that hovers with its centre at (5, 3, 1) m and spins at 3 rad/s about y "
                "touches the floor at (6, 3, 0) m",
       .slip = likely(
           found,
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
  expect_near(
      found, -5.0, kRoundoff * 18, "m/s",
      {.scene = "two blocks spin against each other, 3 and -2 rad/s about y, and touch 1 m off "
                "their centres",
       .slip = likely(
           found,
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
  const double found =
      student().relative_normal_velocity({{0, 0, 0}, kUp}, ball(2.0, 0.5, {0, 0, 0.5}), b);
  expect_near(found, -2.0, kRoundoff * 2, "m/s",
              {.scene = "a floor that rises at 2 m/s meets a resting ball",
               .slip = likely(found,
                              {{0.0,
                                "an immovable body taken to be at rest: infinite mass says nothing "
                                "about its velocity"},
                               {2.0, "u_b - u_a where u_a - u_b belongs: n points from B to A"}},
                              "u_n = n . (u_a - u_b)"),
               .handout = equation("5")});
}

TEST(RelativeNormalVelocity, EachBodyHasItsOwnArmAndSpin) {
  const Encounter e = skew_encounter();
  const double found = student().relative_normal_velocity(e.contact, e.a, e.b);
  expect_near(
      found, relative_normal_velocity_by(e), kRoundoff * 10, "m/s",
      {.scene = "two spinning bodies meet at (5.5, 2.25, 0.25) m, arms (0.5, -0.75, -0.75) and "
                "(-0.75, 0.75, 1) m, n = (2, -1, 2) / 3",
       .slip = likely(found, slips_of_relative_velocity(e),
                      "u_n = n . (u_a - u_b), u = v + w x r for each body with its own arm"),
       .handout = equation("5")});
}

TEST(RelativeNormalVelocity, WallsMayTurnAndMayBeA) {
  for (const bool wall_is_a : {false, true}) {
    Encounter e = skew_encounter();
    Body& driven = wall_is_a ? e.a : e.b;
    const Body moving = driven;
    driven = wall(moving.com_world);
    driven.velocity_world = moving.velocity_world;
    driven.omega_world = moving.omega_world;
    const double found = student().relative_normal_velocity(e.contact, e.a, e.b);
    expect_near(
        found, relative_normal_velocity_by(e), kRoundoff * 10, "m/s",
        {.scene = std::string("a driven wall that moves and turns is ") + (wall_is_a ? "A" : "B") +
                  "; n = (2, -1, 2) / 3",
         .slip = likely(found, slips_of_relative_velocity(e),
                        "u_n = n . (u_a - u_b), u = v + w x r for each body with its own arm"),
         .handout = equation("5")});
  }
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
              {.scene = "u_n = " + show(normal_velocity) + " m/s, tolerance 0.001 m/s",
               .slip = slip,
               .handout = equation("6")});
}

TEST(RelativeMotionCases, SignTellsApproachingFromSeparating) {
  const std::string slip = "the sign is wrong: the gap shrinks when u_n is negative";
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

TEST(RelativeMotionCases, TheToleranceIsTheOneGiven) {
  if (!tells_motions_apart()) return;
  struct Case {
    double normal_velocity, tolerance;
    a1::RelativeMotion expected;
  };
  using enum a1::RelativeMotion;
  for (const Case& c : {Case{-0.25, 0.5, kResting},
                        {0.25, 0.5, kResting},
                        {-0.0005, 0.0, kApproaching},
                        {0.0005, 0.0, kSeparating},
                        {0.0, 0.0, kResting},
                        {-2e-9, 1e-9, kApproaching},
                        {2e-9, 1e-9, kSeparating},
                        {-5e-10, 1e-9, kResting},
                        {-1000.5, 1000.0, kApproaching}}) {
    const a1::RelativeMotion found =
        student().classify_relative_motion(c.normal_velocity, c.tolerance);
    const double u = std::abs(c.normal_velocity);
    const bool as_by_a_millimetre = (found == kResting) == (u <= 0.001);
    expect_true(found == c.expected, name_of(c.expected), name_of(found),
                {.scene = "u_n = " + show(c.normal_velocity) + " m/s, tolerance " +
                          show(c.tolerance) + " m/s",
                 .slip = found == kResting && u < 1e-5
                             ? "an absolute threshold beside the tolerance that is given"
                         : as_by_a_millimetre
                             ? "a tolerance of one's own: the tolerance that is given decides"
                             : "the tolerance that is given: resting is |u_n| <= tolerance",
                 .handout = equation("6")});
  }
}

const std::string kNotUnit = "normal not unit: divide by its length";
const std::string kFromAToB = "the normal points from A to B";

TEST(ContactNormal2d, VertexEdgeIsPerpendicularTowardsTheVertex) {
  const Vector2d found = student().contact_normal_vertex_edge({-0.5, 0.75}, {0, 0}, {3, 4});
  expect_near(found, Vector2d(-0.8, 0.6), kRoundoff, "(unit)",
              {.scene = "corner (-0.5, 0.75) of A left of the edge (0, 0) -> (3, 4) of B",
               .slip = likely<2>(
                   found,
                   {{{-4, 3}, kNotUnit},
                    {{4, -3}, kNotUnit + ", and it is on the wrong side"},
                    {{0.8, -0.6}, kFromAToB + ": take the side of the edge where the corner is"},
                    {{0.6, 0.8}, "the direction of the edge, not its perpendicular"}},
                   "perpendicular to the edge, unit, on the corner's side"),
               .handout = equation("7")});
}

// Edges along an axis or a diagonal: there the corner is on the line in every order of evaluation,
// because both parts of the normal are 0, or the same number. (For an edge along (3, 4) the unit
// normal is rounded, and with it the side.)
TEST(ContactNormal2d, VertexExactlyOnTheEdgeTakesTheOutsideOfACounterClockwiseBody) {
  struct Edge {
    Vector2d start, end, vertex, right;
  };
  const double c = std::sqrt(0.5);
  for (const Edge& e :
       {Edge{{3, 1}, {1, 3}, {2.5, 1.5}, {c, c}}, Edge{{1, -2}, {5, -2}, {2, -2}, {0, -1}},
        Edge{{1, 4}, {1, -2}, {1, 3}, {-1, 0}}}) {
    const Vector2d found = student().contact_normal_vertex_edge(e.vertex, e.start, e.end);
    const Vector2d unscaled = e.right * (e.end - e.start).norm();
    expect_near(
        found, e.right, kRoundoff, "(unit)",
        {.scene = "corner " + show(e.vertex) + " of A exactly on the edge " + show(e.start) +
                  " -> " + show(e.end) + " of B",
         .slip = likely<2>(
             found,
             {{unscaled, kNotUnit},
              {-unscaled, kNotUnit},
              {-e.right,
               "the left-hand side: B is listed counter-clockwise, outside is on the right"}},
             "no side to be seen: take the right-hand side of start -> end"),
         .handout = equation("7")});
  }
}

// Edges of 1e-18 m and of 1e18 m: no absolute size is small.
TEST(ContactNormal2d, IsRightInEveryUnit) {
  for (const double size : {0x1p-60, 0x1p60}) {
    for (const double side : {1.0, -1.0}) {
      const Vector2d start = size * Vector2d(1, -2), end = size * Vector2d(4, 2),
                     expected = side * Vector2d(0.8, -0.6);
      const Vector2d off = start + size * (0.25 * Vector2d(3, 4) + side * 0.125 * Vector2d(4, -3));
      const std::string either_side =
          "the wrong side: the sign tells which side it is, however near the line is (one way to "
          "such an answer is an absolute threshold)";
      const auto story = [&](const std::string& scene, const Vector2d& found, const Vector2d& right,
                             const std::string& opposite) {
        return Story{
            .scene = scene + ", lengths times " + show_scale(size),
            .slip = likely<2>(found,
                              {{-right, opposite},
                               {5 * size * right, kNotUnit},
                               {-5 * size * right, kNotUnit + ", and it points the other way"},
                               {{0, 0},
                                "an absolute threshold: no length is too short to have a "
                                "direction"}},
                              "the direction of a line of any length; one way to a wrong one is an "
                              "absolute threshold: no length is too short to have a direction"),
            .handout = equation("7")};
      };
      // Each function is judged before the next is asked: the story then belongs to the last call.
      const Vector2d corner = student().contact_normal_vertex_edge(off, start, end);
      expect_near(corner, expected, kRoundoff, "(unit)",
                  story("edge (1, -2) -> (4, 2) of B, a corner of A beside it", corner, expected,
                        either_side));
      const Vector2d edge = student().contact_normal_edge_edge(start, end, off);
      expect_near(edge, expected, kRoundoff, "(unit)",
                  story("edge (1, -2) -> (4, 2) of B, the centre of A beside it", edge, expected,
                        either_side));
      const Vector2d line =
          student().contact_normal_vertex_vertex(size * Vector2d(5, 6), size * Vector2d(1, 9));
      expect_near(line, Vector2d(0.8, -0.6), kRoundoff, "(unit)",
                  story("centres of A and B at (5, 6) and (1, 9)", line, {0.8, -0.6}, kFromAToB));
    }
  }
}

TEST(ContactNormal2d, EdgeEdgePointsToTheCentreOfAHoweverTheEdgeIsListed) {
  for (const bool turned : {false, true}) {
    const Vector2d start = turned ? Vector2d(4, 3) : Vector2d(0, 0),
                   end = turned ? Vector2d(0, 0) : Vector2d(4, 3);
    const Vector2d found = student().contact_normal_edge_edge(start, end, {-3, 4});
    expect_near(
        found, Vector2d(-0.6, 0.8), kRoundoff, "(unit)",
        {.scene = std::string("edge ") + (turned ? "(4, 3) -> (0, 0)" : "(0, 0) -> (4, 3)") +
                  " of B, centre of A at (-3, 4)",
         .slip = likely<2>(found,
                           {{{-3, 4}, kNotUnit},
                            {{3, -4}, kNotUnit},
                            {{0.6, -0.8}, kFromAToB + ": take the side of A's centre"}},
                           "perpendicular to the edge, unit, on the side of A's centre"),
         .handout = equation("7")});
  }
}

TEST(ContactNormal2d, VertexVertexIsTheLineOfCentres) {
  const Vector2d found = student().contact_normal_vertex_vertex({4, 5}, {1, 1});
  expect_near(found, Vector2d(0.6, 0.8), kRoundoff, "(unit)",
              {.scene = "corner on corner; centre of A at (4, 5), of B at (1, 1)",
               .slip = likely<2>(
                   found, {{{3, 4}, kNotUnit}, {{-3, -4}, kNotUnit}, {{-0.6, -0.8}, kFromAToB}},
                   "(x_a - x_b) / |x_a - x_b|"),
               .handout = equation("7")});
}

}  // namespace
}  // namespace tumble::testing
