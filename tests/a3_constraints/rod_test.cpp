// A rod as an equation (A3.4), (A3.5), and its Baumgarte stabilisation (A3.6); the restitution
// threshold (A3.10).
#include "tests/a3_constraints/a3_fixtures.h"

namespace tumble::a3_testing {
namespace {

// relative to the largest term: two rotations, cross products, a norm and a division
constexpr double kRodRoundoff = 40 * kEps;

// A at (10, 20, 30), rotated by a third; its point (1, 2, 4) is at r = (4, 1, 2), hence at (14, 21,
// 32).
// B at (10, 21, 32), not rotated; its point (1, -4, 0) is at (11, 17, 32). d = (3, 4, 0).
Body body_a() {
  Body body = resting_at({10, 20, 30});
  body.world_from_body = third_turn();
  return body;
}
Body body_b() { return resting_at({10, 21, 32}); }
const Vector3d kPointA(1, 2, 4), kArmA(4, 1, 2), kPointB(1, -4, 0), n(0.6, 0.8, 0);
const std::string kScene =
    "a rod of 2 m from A's point at (14, 21, 32) to B's at (11, 17, 32) m: 5 m apart along n = "
    "(0.6, 0.8, 0)";

Vector6d six(const Vector3d& linear, const Vector3d& angular) {
  Vector6d v;
  v << linear, angular;
  return v;
}

TEST(RodRow, MeasuresHowMuchTooLong) {
  const double found = a3_module().rod_row(body_a(), kPointA, body_b(), kPointB, 2.0).value;
  expect_near(
      found, 3.0, kRodRoundoff * 35, "m",
      {.scene = kScene,
       .slip = likely(
           found,
           Slips<double>{
               {-3, "the sign of C is wrong: |d| - length"},
               {21, "the squares of the lengths: this C has another scale and another J"},
               {10.5, "half the squares of the lengths: this C has another scale and another J"},
               {5, "the length is forgotten"},
               {std::sqrt(5.0) - 2,
                "the rod is taken from centre to centre: it ends at the points"},
               {std::sqrt(29.0) - 2,
                "a body point used as a world arm: turn it with the body first"}},
           "C = |d| - length"),
       .handout = equation(4)});
}

TEST(RodRow, JacobianPushesTheEndsApart) {
  const ConstraintRow row = a3_module().rod_row(body_a(), kPointA, body_b(), kPointB, 2.0);
  const Vector6d a = six(n, kArmA.cross(n)), b = six(-n, -kPointB.cross(n));
  expect_near(
      row.jacobian_a, a, kRodRoundoff * 10, "(J_a: n, r_a x n)",
      {.scene = kScene,
       .slip = likely<Vector6d>(
           row.jacobian_a,
           Slips<Vector6d>{
               {-a,
                "the sign of J_a is wrong: n points from B to A, and C grows when A moves along "
                "it"},
               {six(n, -kArmA.cross(n)), "n x r for r x n"},
               {six(n, kPointA.cross(n)), "a body point used as a world arm: r_a = R p_a"},
               {six(n, Vector3d::Zero()), "r x n is forgotten: turning A moves its end of the rod"},
               {5 * a, "d is not made a unit vector: n = d / |d|"},
               {six(n, Vector3d(14, 21, 32).cross(n)),
                "the arm is taken from the origin of the world"},
               {b, "J_a and J_b exchanged"}},
           "(n, r_a x n)"),
       .handout = equation(4)});
  expect_near(
      row.jacobian_b, b, kRodRoundoff * 10, "(J_b: -n, -(r_b x n))",
      {.scene = kScene,
       .slip = likely<Vector6d>(
           row.jacobian_b,
           Slips<Vector6d>{
               {-b, "the sign of J_b is wrong: what pushes A one way pushes B the other"},
               {six(-n, kPointB.cross(n)), "the sign of J_b's turning part is wrong: -(r_b x n)"},
               {six(n, -kPointB.cross(n)),
                "the sign of J_b is wrong: its first three numbers are -n"},
               {six(-n, Vector3d::Zero()),
                "r x n is forgotten: turning B moves its end of the rod"},
               {5 * b, "d is not made a unit vector: n = d / |d|"}},
           "(-n, -(r_b x n))"),
       .handout = equation(4)});
}

TEST(RodRow, RateIsJacobianTimesVelocity) {
  Random random(301);
  for (int i = 0; i < 10; ++i) {
    const Body a = random_body(random), b = random_body(random);
    const Vector3d point_a = random_vector(random, 1), point_b = random_vector(random, 1);
    const ConstraintRow row = a3_module().rod_row(a, point_a, b, point_b, 1.0);
    const Vector3d arm_a = a.world_from_body * point_a, arm_b = b.world_from_body * point_b;
    const Vector3d d = a.com_world + arm_a - b.com_world - arm_b;
    const double rate = d.normalized().dot(a.velocity_world + a.omega_world.cross(arm_a) -
                                           b.velocity_world - b.omega_world.cross(arm_b));
    const Story story{.scene = "two random bodies, number " + std::to_string(i),
                      .slip = "C' = n . (p_a' - p_b'), with omega x r in both",
                      .handout = equation(4)};
    expect_near(row.rate, rate, kRodRoundoff * 50, "m/s (C')", story);
    expect_near(row.jacobian_a.dot(velocity_of(a)) + row.jacobian_b.dot(velocity_of(b)), rate,
                kRodRoundoff * 50, "m/s (J u)", story);
  }
}

TEST(RodRow, DrivenBodiesMoveToo) {
  Random random(305);
  for (const bool wall_is_a : {false, true}) {
    Body a = random_body(random), b = random_body(random);
    (wall_is_a ? a : b).inertia = {INFINITY, 0.0, Matrix3d::Constant(kUnset), Matrix3d::Zero()};
    const Vector3d point_a = random_vector(random, 1), point_b = random_vector(random, 1),
                   arm_a = a.world_from_body * point_a, arm_b = b.world_from_body * point_b;
    const ConstraintRow row = a3_module().rod_row(a, point_a, b, point_b, 1.0);
    const Vector3d d = a.com_world + arm_a - b.com_world - arm_b, n = d.normalized();
    const Vector3d of_a = a.velocity_world + a.omega_world.cross(arm_a),
                   of_b = b.velocity_world + b.omega_world.cross(arm_b), d_rate = of_a - of_b;
    const Vector3d centripetal = a.omega_world.cross(a.omega_world.cross(arm_a)) -
                                 b.omega_world.cross(b.omega_world.cross(arm_b));
    const double rate = n.dot(d_rate),
                 velocity_product =
                     n.dot(centripetal) + (d_rate - rate * n).squaredNorm() / d.norm();
    const Story story{
        .scene = std::string("a rod between a random body and a driven one of infinite mass that "
                             "moves and turns; the driven one is ") +
                 (wall_is_a ? "A" : "B"),
        .slip = likely(row.rate,
                       Slips<double>{{n.dot(wall_is_a ? Vector3d(-of_b) : of_a),
                                      "an immovable body taken to be at rest: infinite mass says "
                                      "nothing about its velocity"}},
                       "C' = n . (p_a' - p_b'), with omega x r in both"),
        .handout = equation(4)};
    expect_near(row.rate, rate, kRodRoundoff * 50, "m/s (C')", story);
    const double across = (d_rate - rate * n).squaredNorm() / d.norm();
    Story of_product = story;
    of_product.slip = likely(
        row.velocity_product,
        Slips<double>{
            {across, "the anchors' centripetal accelerations w x (w x r) are missing"},
            {n.dot(centripetal), "what turning the rod adds is missing: (d'^2 - (n . d')^2) / |d|"},
            {across - n.dot(centripetal),
             "the sign of the centripetal accelerations is wrong: + n . (w x (w x r)) of A, - of "
             "B"}},
        "J' u = n . (a_centripetal_a - a_centripetal_b) + what turning the rod adds");
    expect_near(row.velocity_product, velocity_product, kRodRoundoff * 300, "m/s^2 (J' u)",
                of_product);
  }
}

// A rod of 1e-30 m, and one of 1e30 m: powers of two, so that answers scale exactly.
TEST(RodRow, IsRightAtEveryLength) {
  const ConstraintRow plain = a3_module().rod_row(body_a(), kPointA, body_b(), kPointB, 2.0);
  for (const double size : {0x1p-100, 0x1p100}) {
    Body a = body_a(), b = body_b();
    a.com_world *= size, b.com_world *= size;
    a.velocity_world = size * Vector3d(1, -2, 0.5);
    const ConstraintRow row = a3_module().rod_row(a, size * kPointA, b, size * kPointB, size * 2.0);
    const Story story{
        .scene = kScene + ", all lengths times " + show_scale(size) +
                 "; A moves at (1, -2, 0.5) m/s times the same",
        .slip = std::abs(plain.value - 3.0) > 1e-9
                    ? "the same rod in metres is wrong, too: see the tests before this one"
                    : "an absolute threshold: a rod has a direction unless its length is exactly 0",
        .handout = equation(4)};
    expect_near(row.value / size, 3.0, kRodRoundoff * 35, "(C, in that unit)", story);
    expect_near(Vector3d(row.jacobian_a.head<3>()), n, kRodRoundoff, "(n)", story);
    expect_near(Vector3d(row.jacobian_a.tail<3>() / size), Vector3d(kArmA.cross(n)),
                kRodRoundoff * 10, "(r_a x n, in that unit)", story);
    expect_near(row.rate / size, -1.0, kRodRoundoff * 10, "(C', in that unit)", story);
    expect_near(row.velocity_product / size, 0.85, kRodRoundoff * 10, "(J' u, in that unit)",
                story);
  }
}

TEST(RodRow, AccelerationOfASwingingPoint) {
  // A mass circles a fixed point at 3 m/s on 0.5 m, at 1 m/s outwards: |d|'' = v_across^2 / |d|
  // without forces.
  Body mass = resting_at({0.5, 0, 0});
  mass.velocity_world = {1, 3, 0};
  Body wall = resting_at({0, 0, 0});
  wall.inertia = {INFINITY, 0.0, Matrix3d::Constant(kUnset), Matrix3d::Zero()};
  for (const bool mass_is_a : {true, false}) {
    const double found = mass_is_a
                             ? a3_module()
                                   .rod_row(mass, Vector3d::Zero(), wall, Vector3d::Zero(), 0.5)
                                   .velocity_product
                             : a3_module()
                                   .rod_row(wall, Vector3d::Zero(), mass, Vector3d::Zero(), 0.5)
                                   .velocity_product;
    expect_near(
        found, 18.0, kRodRoundoff * 20, "m/s^2 (J' u)",
        {.scene = std::string("a mass flies past a fixed point 0.5 m away at 3 m/s, leaving it at "
                              "1 m/s; it is ") +
                  (mass_is_a ? "A" : "B"),
         .slip = likely(
             found,
             Slips<double>{
                 {0,
                  "the velocity product is missing: (|d'|^2 - (n . d')^2) / |d|, a straight flight "
                  "leaves the circle"},
                 {-18, "the sign of the velocity product is wrong"},
                 {20, "|d'|^2 / |d| is used whole: take (n . d')^2 off |d'|^2"},
                 {36, "the velocity product is divided by the length twice"},
                 {9, "the division by |d| is forgotten"}},
             "(|d'|^2 - (n . d')^2) / |d|"),
         .handout = equation(5)});
  }
}

TEST(RodRow, AccelerationOfATurningBody) {
  // A wheel rotates about z at 2 rad/s; its rim point at r = (0.5, 0, 0) accelerates towards the
  // hub at omega^2 r = 2 m/s^2.
  // The rod continues along x to a point that moves with the rim, so that d' = 0 and the second
  // term is 0.
  Body wheel = resting_at({0, 0, 0}), other = resting_at({2.5, 0, 0});
  wheel.omega_world = {0, 0, 2};
  other.velocity_world = {0, 1, 0};
  for (const bool wheel_is_a : {true, false}) {
    const ConstraintRow row =
        wheel_is_a ? a3_module().rod_row(wheel, {0.5, 0, 0}, other, Vector3d::Zero(), 2.0)
                   : a3_module().rod_row(other, Vector3d::Zero(), wheel, {0.5, 0, 0}, 2.0);
    const double found = row.velocity_product;
    expect_near(found, 2.0, kRodRoundoff * 10, "m/s^2 (J' u)",
                {.scene = std::string("a wheel turns at 2 rad/s, a rod from its rim leads away "
                                      "from the hub; the wheel is ") +
                          (wheel_is_a ? "A" : "B"),
                 .slip = likely(
                     found,
                     Slips<double>{{0,
                                    "the centripetal term is missing: n . (w x (w x "
                                    "r)), the points of a turning body accelerate"},
                                   {-2, wheel_is_a ? "the sign of the centripetal term is wrong"
                                                   : "the sign of B's centripetal term is wrong"},
                                   {1, "w x r for w x (w x r)"}},
                     "n . ( w_a x (w_a x r_a) - w_b x (w_b x r_b) )"),
                 .handout = equation(5)});
  }
}

TEST(RodRow, HasNoDirectionWhereThePointsCoincide) {
  Body a = resting_at({1, 2, 3}), b = resting_at({1, 2, 5});
  b.velocity_world = {1, 1, 1};
  b.omega_world = {1, 2, 3};
  const ConstraintRow row = a3_module().rod_row(a, {0, 0, 1}, b, {0, 0, -1}, 2.0);
  const Story story{
      .scene = "a rod of 2 m between two points at the same place",
      .slip = "there is no direction, hence J = 0, C' = 0, J' u = 0",
      .handout = equation(4),
      .no_number =
          "a division by the length 0: there is no direction, hence J = 0, C' = 0, J' u = 0"};
  expect_near(row.value, -2.0, kRodRoundoff * 10, "m (C)", story);
  expect_near(row.jacobian_a, Vector6d::Zero(), 0.0, "(J_a)", story);
  expect_near(row.jacobian_b, Vector6d::Zero(), 0.0, "(J_b)", story);
  expect_near(row.rate, 0.0, 0.0, "m/s (C')", story);
  expect_near(row.velocity_product, 0.0, 0.0, "m/s^2 (J' u)", story);
}

TEST(Baumgarte, PullsBack) {
  struct Case {
    double value, rate;
    std::string scene;
  };
  for (const Case& c : {Case{0.5, 0, "C = 0.5 m"}, Case{0, 3, "C' = 3 m/s"},
                        Case{0.5, -3, "C = 0.5 m, C' = -3 m/s"}}) {
    const double found = a3_module().baumgarte_acceleration(c.value, c.rate, 0.1),
                 expected = -20 * c.rate - 100 * c.value;
    expect_near(
        found, expected, kRodRoundoff * 60, "m/s^2",
        {.scene = c.scene + ", T = 0.1 s",
         .slip = likely(
             found,
             Slips<double>{
                 {-expected, "the sign is wrong: the acceleration must lead back"},
                 {-20 * c.rate + 100 * c.value, "the sign of the second term is wrong: - C / T^2"},
                 {20 * c.rate - 100 * c.value, "the sign of the first term is wrong: - (2 / T) C'"},
                 {-10 * c.rate - 100 * c.value, "the 2 is forgotten: it swings over without"},
                 {-20 * c.rate - 10 * c.value, "T is not squared under C"},
                 {-0.2 * c.rate - 0.01 * c.value, "T is multiplied, not divided by"},
                 {-100 * c.value - 200 * c.rate, "T is squared under C' as well"}},
             "-(2 / T) C' - C / T^2"),
         .handout = equation(6)});
  }
}

TEST(Baumgarte, LeadsBackWithoutSwingingOver) {
  // C(t) = (C0 + (C0' + C0 / T) t) exp(-t / T), differentiated twice by hand.
  const double T = 0.25, C0 = 0.3, slope = -1 + C0 / T;
  for (const double t : {0.0, 0.1, 0.25, 1.0}) {
    const double decay = std::exp(-t / T), value = (C0 + slope * t) * decay,
                 rate = (slope - (C0 + slope * t) / T) * decay;
    const double acceleration = (-2 * slope / T + (C0 + slope * t) / (T * T)) * decay;
    expect_near(a3_module().baumgarte_acceleration(value, rate, T), acceleration, kRodRoundoff * 20,
                "m/s^2",
                {.scene = "a critically damped return with T = 0.25 s, at t = " + show(t) +
                          " s, in closed form",
                 .slip = "the 2, the square of T, or a sign",
                 .handout = equation(6)});
  }
}

TEST(EndsInContact, WhereTheBounceIsTooSlow) {
  struct Case {
    double approach, restitution, rest;
    bool ends;
  };
  for (const Case& c :
       {Case{0.3, 0.5, 0.2, true}, Case{0.5, 0.5, 0.2, false}, Case{3, 0.05, 0.2, true},
        Case{3, 0.5, 0.2, false}, Case{0.19, 1, 0.2, true}, Case{0.3, 1, 0.2, false}}) {
    const bool found = a3_module().ends_in_contact(c.approach, c.restitution, c.rest);
    const bool by_approach = (c.approach <= c.rest) == found && (c.approach <= c.rest) != c.ends;
    const double e = c.restitution;
    const bool by_square =
        (e * e * c.approach <= c.rest) == found && (e * e * c.approach <= c.rest) != c.ends;
    expect_true(
        found == c.ends, c.ends ? "true: a contact" : "false: it bounces", found ? "true" : "false",
        {.scene = "met at " + show(c.approach) + " m/s, e = " + show(c.restitution) +
                  ", rest speed " + show(c.rest) + " m/s",
         .slip = by_approach ? "the speed before the bounce is compared: what counts is the speed "
                               "after it, e |u_n|"
                 : by_square ? "e^2 |u_n| is compared: e is a ratio of speeds, e^2 one of energies"
                             : "e |u_n| <= rest speed",
         .handout = equation(10)});
  }
}

TEST(EndsInContact, CountsTheBorder) {
  const bool bounces = !a3_module().ends_in_contact(1, 0.5, 0.25);
  expect_true(bounces, "false: it bounces", "true",
              {.scene = "met at 1 m/s, e = 0.5, rest speed 0.25 m/s",
               .slip = "e |u_n| <= rest speed",
               .handout = equation(10)});
  if (!bounces) return;
  const Story story{.scene = "",
                    .slip =
                        "the border belongs to the contact: e |u_n| <= rest speed. Else what does "
                        "not bounce (e = 0) never rests at rest speed 0",
                    .handout = equation(10)};
  const auto with_scene = [&story](const std::string& scene) {
    Story s = story;
    s.scene = scene;
    return s;
  };
  expect_true(a3_module().ends_in_contact(0.5, 0.5, 0.25), "true", "false",
              with_scene("met at 0.5 m/s, e = 0.5, rest speed 0.25 m/s"));
  expect_true(a3_module().ends_in_contact(2, 0, 0), "true", "false",
              with_scene("met at 2 m/s, e = 0, rest speed 0"));
}

// The threshold is sharp, at every speed.
TEST(EndsInContact, HasNoMarginOfItsOwn) {
  for (const double unit : {0x1p-30, 1.0, 0x1p30}) {
    for (const double off : {-0x1p-20, 0x1p-20}) {
      const bool ends = a3_module().ends_in_contact(unit, 0.5, unit * (0.5 + off)),
                 expected = off > 0;
      expect_true(
          ends == expected, expected ? "true: a contact" : "false: it bounces",
          ends ? "true" : "false",
          {.scene = "met at " + show(unit) +
                    " m/s, e = 0.5, rest speed half of that and a millionth " +
                    (expected ? "more" : "less"),
           .slip = unit < 1
                       ? "an absolute threshold: speeds are compared as they are, however small"
                       : "an absolute threshold, or a margin: e |u_n| <= rest speed as it stands",
           .handout = equation(10)});
    }
  }
}

// Two calls of each function in one process: the first fills a static variable, which makes the
// second wrong.
TEST(Constraints, KeepNothingBetweenCalls) {
  const auto story = [](const std::string& function, int number) {
    return Story{.scene = "two calls of " + function + ", each with other numbers",
                 .slip = function + " itself: see its own tests",
                 .handout = equation(number)};
  };
  const Spring spring{.stiffness = 10, .damping = 0, .rest_length = 2};
  const AnchorState origin{Vector3d::Zero(), Vector3d::Zero()};
  const auto pull = [&](const Vector3d& at) {
    return a3_module().spring_force(spring, origin, {at, Vector3d::Zero()});
  };
  const Vector3d f1 = pull({3, 4, 0}), f2 = pull({0, -6, 8});
  expect_kept_nothing(f1, Vector3d(18, 24, 0), f2, Vector3d(0, -48, 64), kRodRoundoff * 100, "N",
                      story("spring_force", 3));

  const ConstraintRow first = a3_module().rod_row(body_a(), kPointA, body_b(), kPointB, 2.0),
                      second = a3_module().rod_row(body_b(), kPointB, body_a(), kPointA, 2.0);
  expect_kept_nothing(first.jacobian_a, six(n, kArmA.cross(n)), second.jacobian_a,
                      six(-n, -kPointB.cross(n)), kRodRoundoff * 10, "(J_a)", story("rod_row", 4));

  const VectorXd l1 = hanging_chain({2, 2}).multipliers(), l2 = hanging_chain({8, 8}).multipliers();
  expect_kept_nothing(l1, vector({-4 * kGravity, -2 * kGravity}), l2,
                      vector({-16 * kGravity, -8 * kGravity}), 1e-12 * 16 * kGravity, "N",
                      story("constraint_multipliers", 7));

  const auto push = [](double A, double b) {
    return VectorXd(a3_module().contact_forces(MatrixXd::Constant(1, 1, A), vector({b})));
  };
  const VectorXd c1 = push(0.5, -1), c2 = push(0.25, -3);
  expect_kept_nothing(c1, vector({2}), c2, vector({12}), kRodRoundoff * 12, "N",
                      story("contact_forces", 9));
}

}  // namespace
}  // namespace tumble::a3_testing
