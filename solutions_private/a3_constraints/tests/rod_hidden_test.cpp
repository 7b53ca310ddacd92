// Hidden: a rod's row against the motion it describes.
#include "tests/a3_constraints/a3_fixtures.h"

namespace tumble::a3_testing {
namespace {

/// The body after t seconds of flight at constant velocity and angular velocity.
Body after(const Body& body, double t) {
  Body later = body;
  later.com_world += t * body.velocity_world;
  const double angle = body.omega_world.norm() * t;
  later.world_from_body =
      Quaterniond(Eigen::AngleAxisd(angle, body.omega_world.normalized())) * body.world_from_body;
  return later;
}

TEST(RodRow, DerivativesAreThoseOfTheMotion) {
  // Bodies that do not accelerate: C'' = J' u. Five points of C(t) at steps h: errors h^4 C^(5..6)
  // / 30 and eps / h^2, both below 1e-8.
  Random random(331);
  constexpr double h = 1e-3;
  for (int i = 0; i < 20; ++i) {
    const Body a = random_body(random);
    Body b = random_body(random);
    b.com_world += Vector3d(6, 0, 0);  // ends stay metres apart: smooth
    const Vector3d point_a = random_vector(random, 1), point_b = random_vector(random, 1);
    const auto row_at = [&](double t) {
      return a3_module().rod_row(after(a, t), point_a, after(b, t), point_b, 1.5);
    };
    const double c[] = {row_at(-2 * h).value, row_at(-h).value, row_at(0).value, row_at(h).value,
                        row_at(2 * h).value};
    const ConstraintRow row = row_at(0);
    const Story story{
        .scene = "two bodies in free flight, number " + std::to_string(i) +
                 ": C' and C'' from C at five times",
        .slip =
            "the velocity product: the centripetal term of both bodies, and the turning of the rod",
        .handout = equation(5)};
    expect_true(row.jacobian_a.norm() > 0.9, "|J_a| >= 1", show(row.jacobian_a.norm()), story);
    expect_near(row.rate, (c[0] - 8 * c[1] + 8 * c[3] - c[4]) / (12 * h), 1e-7, "m/s (C')", story);
    expect_near(row.velocity_product,
                (-c[0] + 16 * c[1] - 30 * c[2] + 16 * c[3] - c[4]) / (12 * h * h), 1e-6,
                "m/s^2 (C'')", story);
  }
}

TEST(RodRow, DoesNotCareWhoIsCalledA) {
  Random random(332);
  for (int i = 0; i < 20; ++i) {
    const Body a = random_body(random), b = random_body(random);
    const Vector3d point_a = random_vector(random, 1), point_b = random_vector(random, 1);
    const ConstraintRow row = a3_module().rod_row(a, point_a, b, point_b, 2.0),
                        swapped = a3_module().rod_row(b, point_b, a, point_a, 2.0);
    const Story story{.scene = "a random rod, number " + std::to_string(i) +
                               ", and the same with A and B exchanged",
                      .slip = "a sign or an arm of one of the two",
                      .handout = equation(4)};
    expect_true(row.jacobian_a.norm() > 0.9, "|J_a| >= 1", show(row.jacobian_a.norm()), story);
    expect_near(row.value, swapped.value, 20 * kEps * 8, "m (C)", story);
    expect_near(row.rate, swapped.rate, 40 * kEps * 20, "m/s (C')", story);
    expect_near(row.velocity_product, swapped.velocity_product, 1e-10, "m/s^2 (J' u)", story);
    expect_near(row.jacobian_a, swapped.jacobian_b, 40 * kEps * 8, "(J_a, J_b)", story);
    expect_near(row.jacobian_b, swapped.jacobian_a, 40 * kEps * 8, "(J_b, J_a)", story);
  }
}

TEST(RodRow, GivesNoNetForceAndNoNetTorque) {
  // lambda J pushes the ends apart along the line that joins them: forces cancel, and so do torques
  // about any point.
  Random random(333);
  for (int i = 0; i < 20; ++i) {
    const Body a = random_body(random), b = random_body(random);
    const ConstraintRow row =
        a3_module().rod_row(a, random_vector(random, 1), b, random_vector(random, 1), 2.0);
    const Vector3d force_a = row.jacobian_a.head<3>(), force_b = row.jacobian_b.head<3>();
    const Story story{.scene = "a random rod, number " + std::to_string(i),
                      .slip = "the sign of J_b, or r x n in either",
                      .handout = equation(4)};
    expect_near(force_a.norm(), 1.0, 20 * kEps, "(|n|)", story);
    expect_near(Vector3d(force_a + force_b), Vector3d::Zero(), 20 * kEps, "N", story);
    const Vector3d torque = a.com_world.cross(force_a) + row.jacobian_a.tail<3>() +
                            b.com_world.cross(force_b) + row.jacobian_b.tail<3>();
    expect_near(torque, Vector3d::Zero(), 100 * kEps * 5, "N m about the origin", story);
  }
}

TEST(RodRow, StaysTrueFarFromTheOrigin) {
  Body a = resting_at({1e6, -1e6, 1e6}), b = resting_at({1e6 + 2, -1e6, 1e6});
  a.omega_world = {0, 0, 3};
  const ConstraintRow row = a3_module().rod_row(a, {0.5, 0, 0}, b, {-0.5, 0, 0}, 1.0);
  const Story story{.scene = "a rod of 1 m at 1.7e6 m from the origin",
                    .slip = "an arm from the origin of the world",
                    .handout = equation(4)};
  expect_near(row.value, 0.0, 8 * kEps * 1e6, "m (C)", story);
  // The rim point moves across at 1.5 m/s: 1.5^2 / 1; and is drawn to the hub, away from B, at 3^2
  // * 0.5: C'' = 4.5 + 2.25.
  expect_near(row.velocity_product, 6.75, 1e-8, "m/s^2 (J' u)", story);
  expect_near(row.jacobian_a, (Vector6d() << -1, 0, 0, 0, 0, 0).finished(), 1e-9, "(J_a)", story);
}

TEST(Baumgarte, SettlesAnErrorByIntegration) {
  // C'' as given, RK4 by hand on (C, C'): after 3 T, C = C0 (1 + 3) exp(-3) for C'(0) = 0.
  // Truncation below (h / T)^4 = 1e-8.
  const double T = 0.2, h = T / 100;
  double value = 1, rate = 0;
  const auto f = [&](double c, double v) { return a3_module().baumgarte_acceleration(c, v, T); };
  for (int i = 0; i < 300; ++i) {
    const double k1 = f(value, rate), k2 = f(value + h / 2 * rate, rate + h / 2 * k1);
    const double k3 = f(value + h / 2 * (rate + h / 2 * k1), rate + h / 2 * k2),
                 k4 = f(value + h * (rate + h / 2 * k2), rate + h * k3);
    value += h * rate + h * h / 6 * (k1 + k2 + k3);
    rate += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
  }
  expect_near(value, 4 * std::exp(-3.0), 1e-7, "m",
              {.scene = "an error of 1 m, T = 0.2 s, after 0.6 s",
               .slip = "the 2 is forgotten, T is not squared, or a sign",
               .handout = equation(6)});
}

TEST(EndsInContact, LooksAtTheSpeedAfterwards) {
  Random random(335);
  int contacts = 0, bounces = 0;
  for (int i = 0; i < 100; ++i) {
    const double approach = random.between(0, 2), restitution = random.between(0, 1),
                 rest = random.between(0, 1);
    if (std::abs(restitution * approach - rest) < 1e-9) continue;
    const bool ends = restitution * approach < rest;
    (ends ? contacts : bounces) += 1;
    expect_true(a3_module().ends_in_contact(approach, restitution, rest) == ends,
                ends ? "true: a contact" : "false: it bounces", ends ? "false" : "true",
                {.scene = "met at " + show(approach) + " m/s, e = " + show(restitution) +
                          ", rest speed " + show(rest) + " m/s",
                 .slip = "e |u_n| <= rest speed",
                 .handout = equation(10)});
  }
  EXPECT_GT(contacts, 20);
  EXPECT_GT(bounces, 20);
}

}  // namespace
}  // namespace tumble::a3_testing
