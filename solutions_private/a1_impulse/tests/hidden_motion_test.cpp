// Properties that hold for every force, torque and motion; inputs from a seed.
#include "tests/a1_impulse/a1_fixtures.h"

namespace tumble::testing {
namespace {

// Random scenes: about 100 roundings of eps / 2, times the size of the largest product that occurs
// (given at each use).
constexpr double kManyRoundings = 50 * kEps;

std::string number_of(int i, int seed) {
  return "random scene " + std::to_string(i) + " of seed " + std::to_string(seed);
}

Matrix3d inertia_world(const Body& body) {
  const Matrix3d R = body.world_from_body.toRotationMatrix();
  return R * body.inertia.inertia_body * R.transpose();
}

TEST(HiddenPointForce, MovingTheCentreChangesTheTorqueByTheLeverOfTheMove) {
  Random random(2101);
  for (int i = 0; i < 100 && !HasFailure(); ++i) {
    const Vector3d force = random_vector(random, 10), point = random_vector(random, 3),
                   x = random_vector(random, 3), y = random_vector(random, 3);
    const Vector3d about_x = student().wrench_of_point_force(force, point, x).torque_world;
    const Vector3d about_y = student().wrench_of_point_force(force, point, y).torque_world;
    expect_near(about_x - about_y, (y - x).cross(force), kManyRoundings * 60, "N m",
                {.scene = number_of(i, 2101) + ": the same force about two centres",
                 .slip = "the arm or the order of the cross product: tau = (p - x) x F",
                 .handout = equation("2")});
  }
}

TEST(HiddenPointForce, PowerIsForceTimesVelocityOfThePoint) {
  Random random(2102);
  for (int i = 0; i < 100 && !HasFailure(); ++i) {
    const Body body = random_body(random);
    const Vector3d force = random_vector(random, 10), point = random_vector(random, 3);
    const Wrench wrench = student().wrench_of_point_force(force, point, body.com_world);
    const double power =
        wrench.force_world.dot(body.velocity_world) + wrench.torque_world.dot(body.omega_world);
    const Vector3d point_velocity =
        body.velocity_world + body.omega_world.cross(point - body.com_world);
    expect_near(
        power, force.dot(point_velocity), kManyRoundings * 1000, "W",
        {.scene = number_of(i, 2102) + ": power of force and torque against power at the point",
         .slip = "the sign or the arm of the torque",
         .handout = equation("2")});
  }
}

TEST(HiddenLinearAcceleration, GivesTheForceBackTimesMass) {
  Random random(2103);
  for (int i = 0; i < 50 && !HasFailure(); ++i) {
    const Body body = random_body(random);
    const Vector3d force = random_vector(random, 10);
    expect_near(body.inertia.mass * student().linear_acceleration(body, force), force,
                kManyRoundings * 10, "N",
                {.scene = number_of(i, 2103),
                 .slip = "m a = F: something beside mass and force came in",
                 .handout = equation("3")});
  }
}

TEST(HiddenAngularAcceleration, ObeysEulersEquationInTheWorldFrame) {
  Random random(2104);
  for (int i = 0; i < 100 && !HasFailure(); ++i) {
    const Body body = random_body(random);
    const Vector3d torque = random_vector(random, 10);
    const Matrix3d I = inertia_world(body);
    const Vector3d& w = body.omega_world;
    const Vector3d found = I * student().angular_acceleration(body, torque) + w.cross(I * w);
    const double scale = (torque.norm() + I.norm() * w.squaredNorm()) * I.norm() *
                         body.inertia.inverse_inertia_body.norm();
    expect_near(found, torque, kManyRoundings * scale, "N m",
                {.scene = number_of(i, 2104) + ": I w' + w x (I w) in the world frame",
                 .slip = "a frame mixed up, or the gyroscopic term",
                 .handout = equation("4")});
  }
}

TEST(HiddenAngularAcceleration, TorqueWorksAtTheRateThatEnergyGrows) {
  Random random(2105);
  for (int i = 0; i < 100 && !HasFailure(); ++i) {
    const Body body = random_body(random);
    const Vector3d torque = random_vector(random, 10);
    const Matrix3d I = inertia_world(body);
    const Vector3d& w = body.omega_world;
    const double found = w.dot(I * student().angular_acceleration(body, torque));
    const double scale = w.norm() * (torque.norm() + I.norm() * w.squaredNorm()) * I.norm() *
                         body.inertia.inverse_inertia_body.norm();
    expect_near(
        found, w.dot(torque), kManyRoundings * scale, "W",
        {.scene = number_of(i, 2105) + ": d/dt of the energy w.Iw/2 against the power w.tau",
         .slip = "a frame mixed up: the gyroscopic term does no work",
         .handout = equation("4")});
  }
}

TEST(HiddenRelativeNormalVelocity, IsTheSameWhicheverBodyIsCalledA) {
  Random random(2106);
  for (int i = 0; i < 100 && !HasFailure(); ++i) {
    const auto [contact, a, b] = random_encounter(random, i);
    const double found = student().relative_normal_velocity(
        {contact.point_world, -contact.normal_b_to_a_world}, b, a);
    expect_near(found, gap_rate(contact, a, velocity_of(a), b, velocity_of(b)), kManyRoundings * 60,
                "m/s",
                {.scene = number_of(i, 2106) + ": bodies swapped and normal turned round",
                 .slip = "u_n = n . (u_a - u_b) with u = v + w x (p - x) for both",
                 .handout = equation("5")});
  }
}

TEST(HiddenRelativeNormalVelocity, IsTheSameForEveryMovingObserver) {
  if (!gives_relative_velocities()) return;
  Random random(2107);
  for (int i = 0; i < 100 && !HasFailure(); ++i) {
    auto [contact, a, b] = random_encounter(random, i);
    const double seen_at_rest = student().relative_normal_velocity(contact, a, b);
    const Vector3d boost = random_vector(random, 10), shift = random_vector(random, 10);
    for (Body* body : {&a, &b}) {
      body->velocity_world += boost;
      body->com_world += shift;
    }
    contact.point_world += shift;
    expect_near(
        student().relative_normal_velocity(contact, a, b), seen_at_rest, kManyRoundings * 100,
        "m/s",
        {.scene = number_of(i, 2107) + ": seen by an observer who stands elsewhere and moves",
         .slip = "the other body's velocity left out, or an arm that starts at the world's origin",
         .handout = equation("5")});
  }
}

TEST(HiddenRelativeMotionCases, AgreeWithTheBorders) {
  Random random(2108);
  for (int i = 0; i < 100 && !HasFailure(); ++i) {
    const double tolerance = i % 3 == 0 ? 0.0 : random.between(0.0, 0.1);
    const double u = i % 5 == 0 ? 0.0 : random.between(-0.2, 0.2);
    const auto expected = u < -tolerance  ? a1::RelativeMotion::kApproaching
                          : u > tolerance ? a1::RelativeMotion::kSeparating
                                          : a1::RelativeMotion::kResting;
    expect_true(student().classify_relative_motion(u, tolerance) == expected,
                "one of the three cases", "another",
                {.scene = "u_n = " + show(u) + " m/s, tolerance " + show(tolerance) + " m/s",
                 .slip = "the borders of the three cases",
                 .handout = equation("6")});
  }
}

TEST(HiddenContactNormal2d, IsUnitPerpendicularAndOnTheRightSide) {
  Random random(2109);
  for (int i = 0; i < 100 && !HasFailure(); ++i) {
    const Vector2d start(random.between(-3, 3), random.between(-3, 3));
    const double heading = random.between(-3.0, 3.0), length = random.between(0.01, 3.0),
                 side = i % 2 == 0 ? 1.0 : -1.0;
    const Vector2d along(std::cos(heading), std::sin(heading)), left(-along.y(), along.x());
    const Vector2d end = start + length * along, off = start + random.unit() * length * along +
                                                       side * random.between(0.01, 1.0) * left;
    const Story story{.scene = number_of(i, 2109) + ": an edge of " + show_scale(length) + " m",
                      .slip = "not unit, not perpendicular, or pointing from A to B",
                      .handout = equation("7")};
    // An edge's direction is known to eps * 3 / length.
    const double tolerance = 8 * kEps * (1.0 + 3.0 / length);
    expect_near(student().contact_normal_vertex_edge(off, start, end), side * left, tolerance,
                "(unit)", story);
    expect_near(student().contact_normal_edge_edge(start, end, off), side * left, tolerance,
                "(unit)", story);
    expect_near(student().contact_normal_vertex_vertex(end, start), along, tolerance, "(unit)",
                story);
  }
}

}  // namespace
}  // namespace tumble::testing
