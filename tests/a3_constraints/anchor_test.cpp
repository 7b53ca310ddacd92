// Position and velocity of a point fixed in a body (A3.1), (A3.2).
#include "tests/a3_constraints/a3_fixtures.h"

namespace tumble::a3_testing {
namespace {

TEST(AnchorPosition, TurnsWithTheBody) {
  Body body = resting_at({10, 20, 30});
  body.world_from_body = third_turn();
  const Vector3d found = a3_module().anchor_position(body, {1, 2, 4});
  expect_near(
      found, Vector3d(14, 21, 32), kRoundoff * 34, "m",
      {.scene =
           "a body at (10, 20, 30) m, turned by 120 degrees about (1, 1, 1); its point (1, 2, 4) m",
       .slip = likely(
           found,
           Slips<Vector3d>{
               {{11, 22, 34},
                "a body point used as a world point: turn it with the body first, R p"},
               {{12, 24, 31}, "R and R^T swapped: world_from_body turns body into world"},
               {{4, 1, 2}, "the centre of mass is forgotten"},
               {{1, 2, 4}, "a body point used as a world point, and the centre of mass forgotten"}},
           "x + R p"),
       .handout = equation(1)});
}

TEST(AnchorVelocity, AddsTheTurningToTheMoving) {
  Body body = resting_at({10, 20, 30});
  body.world_from_body = third_turn();
  body.velocity_world = {1, 0, -1};
  body.omega_world = {0, 0, 2};
  const Vector3d found = a3_module().anchor_velocity(body, {1, 2, 4});  // r = (4, 1, 2)
  expect_near(found, Vector3d(-1, 8, -1), kRoundoff * 10, "m/s",
              {.scene = "a body turned by 120 degrees about (1, 1, 1), v = (1, 0, -1) m/s, omega = "
                        "(0, 0, 2) rad/s; its point (1, 2, 4) m",
               .slip = likely(
                   found,
                   Slips<Vector3d>{
                       {{1, 0, -1}, "omega x r is forgotten: the point turns with the body"},
                       {{3, -8, -1}, "r x omega for omega x r"},
                       {{-3, 2, -1},
                        "a body point used as a world arm: turn it with the body first, r = R p"},
                       {{-41, 28, -1},
                        "the arm is taken from the origin of the world: r = R p, without the "
                        "centre of mass"},
                       {{-2, 8, 0}, "the body's own velocity is forgotten"}},
                   "v + omega x r, r = R p"),
               .handout = equation(2)});
}

TEST(AnchorVelocity, IsTheRateOfThePosition) {
  // In closed form: a body rotates about z at 2 rad/s and moves straight; its point circles. v =
  // d/dt (x + R_z(2 t) p).
  for (const double t : {0.0, 0.7, 3.0}) {
    Body body = resting_at(Vector3d(3, -1, 2) * t);
    body.velocity_world = {3, -1, 2};
    body.omega_world = {0, 0, 2};
    body.world_from_body = Quaterniond(Eigen::AngleAxisd(2 * t, Vector3d::UnitZ()));
    const double c = std::cos(2 * t), s = std::sin(2 * t);
    const Story story{.scene =
                          "a body flies at (3, -1, 2) m/s and turns about z at 2 rad/s; its point "
                          "(1, 0.5, 2) m at t = " +
                          show(t) + " s",
                      .slip = "omega x r is forgotten, or its arm",
                      .handout = equation(2)};
    expect_near(a3_module().anchor_position(body, {1, 0.5, 2}),
                Vector3d(3 * t + c - 0.5 * s, -t + s + 0.5 * c, 2 * t + 2), kRoundoff * 15, "m",
                story);
    expect_near(a3_module().anchor_velocity(body, {1, 0.5, 2}),
                Vector3d(3 - 2 * s - c, -1 + 2 * c - s, 2), kRoundoff * 15, "m/s", story);
  }
}

}  // namespace
}  // namespace tumble::a3_testing
