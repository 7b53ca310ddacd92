// Forces: at a point (A1.2), and the accelerations they cause (A1.3, A1.4).
#include "tests/a1_impulse/a1_fixtures.h"

namespace tumble::testing {
namespace {

TEST(PointForce, TorqueIsArmCrossForce) {
  const Wrench found = student().wrench_of_point_force({0, 0, 5}, {1, 2, 3}, {0, 0, 0});
  expect_near(found.torque_world, Vector3d(10, -5, 0), kRoundoff * 10, "N m",
              {.scene = "5 N along z at (1, 2, 3) m on a body centred at the world's origin",
               .slip = likely<3>(
                   found.torque_world,
                   {{{-10, 5, 0}, "F x r where r x F belongs (or a left-handed cross product)"}},
                   "tau = r x F"),
               .handout = equation("2")});
}

TEST(PointForce, ArmStartsAtTheCentreOfMass) {
  const Wrench found = student().wrench_of_point_force({0, 0, 5}, {1, 2, 3}, {1, 0, 0});
  expect_near(
      found.torque_world, Vector3d(10, 0, 0), kRoundoff * 10, "N m",
      {.scene = "5 N along z at (1, 2, 3) m on a body centred at (1, 0, 0) m",
       .slip = likely<3>(
           found.torque_world,
           {{{10, -5, 0}, "the arm starts at the world's origin: r = p - x"},
            {{-10, 0, 0}, "F x r where r x F belongs, r = x - p, or a left-handed cross product"}},
           "r = p - x, tau = r x F"),
       .handout = equation("2")});
}

TEST(PointForce, ForceItselfStaysWhatItIs) {
  const Wrench found = student().wrench_of_point_force({1, -2, 5}, {1, 2, 3}, {1, 0, 0});
  expect_near(found.force_world, Vector3d(1, -2, 5), 0.0, "N",
              {.scene = "(1, -2, 5) N off the centre of a free body",
               .slip = "part of the force spent on turning: a force moves the centre of mass by "
                       "all of itself, wherever it acts",
               .handout = equation("2")});
}

TEST(LinearAcceleration, IsForceOverMass) {
  const Vector3d found = student().linear_acceleration(block({5, 3, 1}), {2, 0, -8});
  expect_near(
      found, Vector3d(1, 0, -4), kRoundoff * 4, "m/s^2",
      {.scene = "(2, 0, -8) N on a 2 kg block",
       .slip = likely<3>(found, {{{4, 0, -16}, "mass where inverse mass belongs"}}, "a = F / m"),
       .handout = equation("3")});
}

TEST(LinearAcceleration, WallHasNone) {
  if (!gives_linear_acceleration()) return;
  const Vector3d found = student().linear_acceleration(wall({0, 0, 0}), {2, 0, -8});
  expect_near(found, Vector3d::Zero(), 0.0, "m/s^2",
              {.scene = "(2, 0, -8) N on a wall",
               .slip = "infinite mass: multiply by inverse_mass, which is 0",
               .handout = equation("3"),
               .no_number = "infinite mass: multiply by inverse_mass, which is 0"});
}

TEST(AngularAcceleration, FromRestIsTorqueOverInertia) {
  const Vector3d found = student().angular_acceleration(block({5, 3, 1}), {1, 4, 2});
  expect_near(found, Vector3d(1, 2, 0.5), kRoundoff * 2, "rad/s^2",
              {.scene = "torque (1, 4, 2) N m on a resting block with moments 1, 2, 4 kg m^2",
               .slip = likely<3>(found, {{{1, 8, 8}, "inertia where inverse inertia belongs"}},
                                 "alpha = I^-1 tau at rest"),
               .handout = equation("4")});
}

TEST(AngularAcceleration, TurnedBlockNeedsItsInertiaInTheWorldFrame) {
  Body body = block({5, 3, 1});
  body.world_from_body = third_turn();
  // three different numbers, so that a rotation of the torque shows
  const Vector3d torque(4, 8, 12);
  const Vector3d found = student().angular_acceleration(body, torque);
  expect_near(
      found, Vector3d(1, 8, 6), kRoundoff * 8, "rad/s^2",
      {.scene = "torque (4, 8, 12) N m on the resting block turned by 120 degrees: moments 4, 1, 2 "
                "about world x, y, z",
       .slip = likely<3>(found, slips_of_angular_acceleration(body, torque),
                         "frames: torque to the body frame, acceleration back to the world"),
       .handout = equation("4")});
}

TEST(AngularAcceleration, FreeBodyThatTumblesStillAccelerates) {
  Body body = block({5, 3, 1});
  body.omega_world = {1, 1, 1};
  const Vector3d found = student().angular_acceleration(body, {0, 0, 0});
  // I w = (1, 2, 4);  w x I w = (2, -3, 1).
  expect_near(
      found, Vector3d(-2, 1.5, -0.25), kRoundoff * 2, "rad/s^2",
      {.scene = "no torque on a block with moments 1, 2, 4 kg m^2 that spins at (1, 1, 1) rad/s",
       .slip = likely<3>(
           found,
           {{{0, 0, 0}, "the gyroscopic term - w x (I w) is missing"},
            {{2, -1.5, 0.25}, "the sign of the gyroscopic term is wrong: it is subtracted"}},
           "the gyroscopic term - w x (I w)"),
       .handout = equation("4")});
}

TEST(AngularAcceleration, GyroscopicTermIsFormedInTheBodyFrame) {
  Body body = block({5, 3, 1});
  body.world_from_body = third_turn();
  body.omega_world = {1, 2, 3};
  const Vector3d found = student().angular_acceleration(body, {0, 0, 0});
  // w_body = (2, 3, 1), I w = (2, 6, 4), w x I w = (6, -6, 6), w'_body = (-6, 3, -1.5).
  expect_near(
      found, Vector3d(-1.5, -6, 3), kRoundoff * 6, "rad/s^2",
      {.scene = "no torque on the block turned by 120 degrees that spins at (1, 2, 3) rad/s, world",
       .slip =
           likely<3>(found,
                     {{{0, 0, 0}, "the gyroscopic term - w x (I w) is missing"},
                      {{-12, 4.5, -0.5},
                       "body inertia multiplied with world components of w: bring w into the "
                       "body frame first"},
                      {{-6, 3, -1.5}, "the result left in the body frame"},
                      {{1.5, 6, -3}, "the sign of the gyroscopic term is wrong: it is subtracted"}},
                     "frames: w to the body frame, w' back to the world"),
       .handout = equation("4")});
}

TEST(AngularAcceleration, ProductsOfInertiaCount) {
  for (const bool turned : {false, true}) {
    Body body = bracket({5, 3, 1});
    if (turned) body.world_from_body = third_turn();
    body.omega_world = {1, -2, 0.5};
    const Vector3d torque(3, -1, 2);
    const Vector3d found = student().angular_acceleration(body, torque);
    // Smallest moment 1.39, largest 7.27: rounding of w x (I w), up to 40 N m, is divided by 1.39.
    expect_near(
        found, angular_acceleration_by(body, torque), kRoundoff * 40, "rad/s^2",
        {.scene = std::string("torque (3, -1, 2) N m on a lopsided bracket, I = (4, -2, -2; -2, 5, "
                              "-1; -2, -1, 6) kg m^2") +
                  (turned ? ", turned by 120 degrees about (1, 1, 1)," : "") +
                  " that spins at (1, -2, 0.5) rad/s",
         .slip = likely<3>(
             found, slips_of_angular_acceleration(body, torque),
             "I w' = tau - w x (I w) with the whole tensor: its axes here are no principal axes"),
         .handout = equation("4")});
  }
}

TEST(AngularAcceleration, IsRightInEveryUnit) {
  if (!gives_angular_acceleration()) return;
  Body body = bracket({5, 3, 1});
  body.omega_world = {1, -2, 0.5};
  const Vector3d torque(3, -1, 2), expected = angular_acceleration_by(body, torque);
  const bool plain =
      (student().angular_acceleration(body, torque) - expected).norm() <= kRoundoff * 80;
  for (const Units& units : changes_of_unit()) {
    const Body other = scaled(body, units.length, units.mass, units.time);
    const Vector3d other_torque =
        torque * (units.mass * units.length * units.length / (units.time * units.time));
    const Vector3d found = student().angular_acceleration(other, other_torque);
    const double size = 1.0 / (units.time * units.time);
    expect_near(
        found, Vector3d(expected * size), kRoundoff * 40 * size, "rad/s^2",
        {.scene = "the spinning bracket under a torque, " + show(units),
         .slip = slip_of_units(
             plain,
             "an absolute threshold: compare with 0 exactly, since nothing is small by itself"),
         .handout = equation("4")});
  }
}

TEST(LinearAcceleration, IsRightInEveryUnit) {
  const bool plain =
      (student().linear_acceleration(block({5, 3, 1}), {2, 0, -8}) - Vector3d(1, 0, -4)).norm() <=
      kRoundoff * 8;
  for (const Units& units : changes_of_unit()) {
    const Body body = scaled(block({5, 3, 1}), units.length, units.mass, units.time);
    const double acceleration = units.length / (units.time * units.time);
    const Vector3d found =
        student().linear_acceleration(body, Vector3d(2, 0, -8) * (units.mass * acceleration));
    expect_near(found, Vector3d(1, 0, -4) * acceleration, kRoundoff * 4 * acceleration, "m/s^2",
                {.scene = "(2, 0, -8) N on a 2 kg block, " + show(units),
                 .slip = slip_of_units(plain,
                                       "an absolute threshold: a body is immovable where its "
                                       "inverse mass is exactly 0, not where it is small"),
                 .handout = equation("3")});
  }
}

TEST(AngularAcceleration, WallHasNone) {
  if (!gives_angular_acceleration()) return;
  const Vector3d found = student().angular_acceleration(wall({0, 0, 0}), {1, 4, 2});
  expect_near(found, Vector3d::Zero(), 0.0, "rad/s^2",
              {.scene = "torque (1, 4, 2) N m on a wall, whose inertia_body is unset (NaN)",
               .slip = "infinite mass: inertia_body is not to be used; a zero inverse inertia "
                       "means no acceleration",
               .handout = equation("4"),
               .no_number = "infinite mass: inertia_body is not to be used; a zero inverse inertia "
                            "means no acceleration"});
}

// From a click to motion: the pixel's ray, the force, and two accelerations.
TEST(UserForce, ClickOnABlockMovesAndTurnsIt) {
  const Body body = block({0, 0, 0.5});
  const Ray ray{{0.5, -0.5, 3}, {0, 0, -2}};
  const auto hit = student().intersect_ray_triangle(ray, {{-1, -1, 1}, {1, -1, 1}, {1, 1, 1}});
  const Story story{
      .scene =
          "a click on the top face, z = 1 m, of a 2 kg block centred at (0, 0, 0.5) m: 8 N down at "
          "the point hit, (0.5, -0.5, 1)",
      .steps = "ray against triangle; force and torque at o + t d; linear and angular acceleration",
      .slip = "one of the parts: the tests of each part tell which",
      .handout = "handouts/a1_impulse.md#user-selected-force"};
  if (!hit) {
    report_failure(tell(story, "a hit", "a miss", ""));
    return;
  }
  const Wrench wrench = student().wrench_of_point_force(
      {0, 0, -8}, ray.origin_world + hit->t * ray.direction_world, body.com_world);
  expect_near(student().linear_acceleration(body, wrench.force_world), Vector3d(0, 0, -4),
              kRoundoff * 4, "m/s^2", story);
  expect_near(student().angular_acceleration(body, wrench.torque_world), Vector3d(4, 2, 0),
              kRoundoff * 4, "rad/s^2", story);
}

}  // namespace
}  // namespace tumble::testing
