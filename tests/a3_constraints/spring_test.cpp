// Force of a damped spring (A3.3).
#include "tests/a3_constraints/a3_fixtures.h"

namespace tumble::a3_testing {
namespace {

AnchorState at_rest(const Vector3d& point_world) { return {point_world, Vector3d::Zero()}; }

// A from (1, 1, 1) to (4, 5, 1): 5 m along (0.6, 0.8, 0).
const AnchorState kNear = at_rest({1, 1, 1}), kFar = at_rest({4, 5, 1});

TEST(SpringForce, PullsTheEndsOfAStretchedSpringTogether) {
  const Spring spring{.stiffness = 10, .damping = 0, .rest_length = 2};
  const Vector3d found = a3_module().spring_force(spring, kNear, kFar), n(0.6, 0.8, 0);
  expect_near(
      found, Vector3d(18, 24, 0), kRoundoff * 50, "N",
      {.scene = "k = 10 N/m, rest length 2 m, from A at (1, 1, 1) to B at (4, 5, 1): 5 m long",
       .slip = likely(
           found,
           Slips<Vector3d>{{-30 * n,
                            "the sign of the force is wrong: it acts on A, and a stretched spring "
                            "pulls A towards B"},
                           {50 * n, "the rest length is forgotten"},
                           {-50 * n, "the rest length is forgotten, and the sign of the force"},
                           {150 * n, "d is not made a unit vector: n = d / |d|"},
                           {70 * n, "the rest length is added: |d| - L0"},
                           {230 * n, "the square of the length for the length"}},
           "(k (|d| - L0)) n, n from A to B"),
       .handout = equation(3)});
}

TEST(SpringForce, PushesThemApartWhenCompressed) {
  const Spring spring{.stiffness = 10, .damping = 0, .rest_length = 8};
  const Vector3d found = a3_module().spring_force(spring, kNear, kFar);
  expect_near(
      found, Vector3d(-18, -24, 0), kRoundoff * 50, "N",
      {.scene = "k = 10 N/m, rest length 8 m, from A at (1, 1, 1) to B at (4, 5, 1): 5 m long",
       .slip =
           likely(found,
                  Slips<Vector3d>{
                      {{0, 0, 0}, "the spring only pulls, as a rope: a spring pushes, too"},
                      {{18, 24, 0},
                       "the sign of the force is wrong: a compressed spring pushes A away from B"},
                      {{30, 40, 0}, "the rest length is forgotten"}},
                  "k (|d| - L0) is negative here"),
       .handout = equation(3)});
}

TEST(SpringForce, DampsAlongTheSpringOnly) {
  // At its rest length, so that only the damper acts. B moves along the spring at 2 m/s, across it
  // at 5; A at -1 m/s along it.
  const Spring spring{.stiffness = 10, .damping = 3, .rest_length = 5};
  const Vector3d n(0.6, 0.8, 0), across(-0.8, 0.6, 0);
  AnchorState a = kNear, b = kFar;
  a.velocity_world = -1 * n;
  b.velocity_world = 2 * n + 5 * across + Vector3d(0, 0, 7);
  const Vector3d found = a3_module().spring_force(spring, a, b),
                 u = b.velocity_world - a.velocity_world;
  expect_near(
      found, 9 * n, kRoundoff * 50, "N",
      {.scene = "c = 3 N s/m, at rest length, B leaves A at 3 m/s along the spring and moves "
                "across it at 5 and 7 m/s",
       .slip = likely(
           found,
           Slips<Vector3d>{
               {3 * u, "the damper acts in every direction: project the velocity on n"},
               {-9 * n, "the sign of the damping is wrong: ends that part are pulled together"},
               {3 * n, "the velocity of one end only: the damper feels n . (v_b - v_a)"},
               {6 * n, "the velocity of one end only: the damper feels n . (v_b - v_a)"},
               {-3 * u, "the damper acts in every direction, and its sign is wrong"},
               {3 * u.norm() * n,
                "the speed in place of its part along the spring: damping acts along "
                "the spring only"},
               {45 * n, "d is not made a unit vector: n = d / |d|"},
               {225 * n, "d is not made a unit vector: n = d / |d|"},
               {{0, 0, 0}, "the damping is forgotten"}},
           "c n . (v_b - v_a) n"),
       .handout = equation(3)});
}

TEST(SpringForce, AddsStiffnessAndDamping) {
  const Spring spring{.stiffness = 10, .damping = 3, .rest_length = 2};
  AnchorState a = kNear, b = kFar;
  a.velocity_world = {1, 0, 0};
  b.velocity_world = {0, -2, 4};
  // n . (v_b - v_a) = 0.6 * (-1) + 0.8 * (-2) = -2.2 m/s: 30 - 6.6 N.
  expect_near(
      a3_module().spring_force(spring, a, b), Vector3d(0.6, 0.8, 0) * 23.4, kRoundoff * 50, "N",
      {.scene = "k = 10 N/m, c = 3 N s/m, rest length 2 m, 5 m long and shortening at 2.2 m/s",
       .slip = "the sign of the damping, or one of the two terms",
       .handout = equation(3)});
}

TEST(SpringForce, IsZeroWhereTheAnchorsCoincide) {
  AnchorState moving = kNear;
  moving.velocity_world = {1, 2, 3};
  for (const double rest_length : {0.0, 2.0}) {
    const Spring spring{.stiffness = 10, .damping = 3, .rest_length = rest_length};
    if (!(a3_module().spring_force(spring, kNear, kFar).norm() > 10)) {
      expect_true(false, "a force", "none",
                  {.scene = "asked first: the same spring, 5 m long",
                   .slip = "the function gives nothing (0 or NaN) where there is an answer",
                   .handout = equation(3)});
      return;
    }
    const Vector3d found = a3_module().spring_force(spring, kNear, moving);
    expect_near(found, Vector3d::Zero(), 0.0, "N",
                {.scene = "a spring of rest length " + show(rest_length) +
                          " m whose anchors coincide, one of them moving",
                 .slip = "there is no direction, hence no force",
                 .handout = equation(3),
                 .no_number = "a division by the length 0: there is no direction, hence no force"});
  }
}

TEST(SpringForce, OfRestLengthZeroIsStiffnessTimesDistance) {
  const Vector3d d(1, -2, 2);
  for (const double size : {1e-200, 1e-30, 1.0, 1e30, 1e200}) {
    const Spring spring{.stiffness = 4, .damping = 0, .rest_length = 0};
    const Vector3d found =
        a3_module().spring_force(spring, at_rest(Vector3d::Zero()), at_rest(size * d)) / size;
    const std::string of_no_force =
        size * size == 0.0
            ? "|d|^2 leaves the range of doubles: it is 0 below 1e-162 m: divide d by its largest "
              "component first (or use stableNorm)"
            : "a short spring is taken for one of length 0: it has a direction, however short";
    expect_near(
        found, Vector3d(4, -8, 8), kRoundoff * 12, "N per unit of length",
        {.scene =
             "k = 4 N/m, rest length 0, from the origin to (1, -2, 2) times " + show(size) + " m",
         .slip = likely(found, Slips<Vector3d>{{{0, 0, 0}, of_no_force}}, "k d"),
         .handout = equation(3),
         .no_number = "|d|^2 leaves the range of doubles: divide d by its largest component first "
                      "(or use stableNorm)"});
  }
}

}  // namespace
}  // namespace tumble::a3_testing
