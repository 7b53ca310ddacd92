// The effect of an impulse: on one body (A1.10), on both (A1.11).
#include "tests/a1_impulse/a1_fixtures.h"

namespace tumble::testing {
namespace {

TEST(ApplyImpulse, ThroughTheCentreChangesTheVelocity) {
  Body body = block({5, 3, 1});
  body.velocity_world = {1, 0, 0};
  const Velocity found = student().apply_impulse(body, {0, 0, 6}, {5, 3, 1});
  expect_near(
      found.linear_world, Vector3d(1, 0, 3), kRoundoff * 3, "m/s",
      {.scene = "6 N s along z through the centre of a 2 kg block that moves at (1, 0, 0) m/s",
       .slip = likely<3>(
           found.linear_world,
           {{{1, 0, 12}, "mass where inverse mass belongs"},
            {{0, 0, 3}, "the old velocity is lost: the impulse adds to it"},
            {{1, 0, 6}, "the inverse mass is missing"},
            {{1, 0, -3}, "the sign is wrong: the impulse is given as this body feels it"}},
           "v' = v + J / m"),
       .handout = equation("10")});
}

TEST(ApplyImpulse, OffTheCentreTurnsTheBody) {
  Body body = block({5, 3, 1});
  body.omega_world = {0, 1, 0};
  const Velocity found = student().apply_impulse(body, {0, 0, 6}, {6, 3, 0});
  // r = (1, 0, -1), r x J = (0, -6, 0), moment 2 kg m^2.
  expect_near(found.angular_world, Vector3d(0, -2, 0), kRoundoff * 6, "rad/s",
              {.scene = "6 N s along z at (6, 3, 0) m on a block centred at (5, 3, 1) m that spins "
                        "at (0, 1, 0) rad/s",
               .slip = likely<3>(
                   found.angular_world,
                   {{{0, 4, 0}, "J x r where r x J belongs"},
                    {{0, 1, 0},
                     "the angular velocity is not changed: an impulse off the centre also turns"},
                    {{0, -3, 0}, "the old angular velocity is lost: the impulse adds to it"},
                    {{18, -17, 0}, "the arm starts at the world's origin: r = p - x"},
                    {{0, -5, 0}, "the inverse inertia is missing"},
                    {{0, -11, 0}, "inertia where inverse inertia belongs"}},
                   "w' = w + I^-1 (r x J)"),
               .handout = equation("10")});
}

TEST(ApplyImpulse, TurnedBlockNeedsItsInertiaInTheWorldFrame) {
  Body body = block({5, 3, 1});
  body.world_from_body = third_turn();
  const Velocity found = student().apply_impulse(body, {0, 0, 6}, {6, 3, 0});
  expect_near(
      found.angular_world, Vector3d(0, -6, 0), kRoundoff * 6, "rad/s",
      {.scene =
           "6 N s along z at (6, 3, 0) m on a block at rest, centred at (5, 3, 1) m and turned by "
           "120 degrees: its moment about world y is now 1 kg m^2",
       .slip = likely<3>(
           found.angular_world,
           {{{0, -3, 0}, "body inertia where world inertia belongs: I^-1 = R I_body^-1 R^T"},
            {{0, -1.5, 0}, "R and R^T swapped: I^-1 = R I_body^-1 R^T"},
            {{0, 6, 0}, "J x r where r x J belongs"}},
           "world inertia: I^-1 = R I_body^-1 R^T"),
       .handout = equation("10")});
}

TEST(ApplyImpulse, ProductsOfInertiaCount) {
  for (const Units& units : changes_of_unit()) {
    const Encounter skew = skew_encounter();
    const Body body = scaled(skew.a, units.length, units.mass, units.time);
    const double speed = units.length / units.time;
    const Vector3d impulse = Vector3d(2, -1, 3) * units.mass * speed,
                   point = skew.contact.point_world * units.length;
    const Velocity found = student().apply_impulse(body, impulse, point);
    const std::string scene =
        "(2, -1, 3) N s off the centre of a lopsided bracket of 2 kg, turned by 120 degrees, that "
        "moves and spins; " +
        show(units);
    expect_near(
        found.linear_world, Vector3d(2, -2.5, -4.5) * speed, kRoundoff * 6 * speed, "m/s",
        {.scene = scene,
         .slip = found.linear_world == body.velocity_world
                     ? "an absolute threshold: an impulse changes the velocity, however small it is"
                     : "v' = v + J / m",
         .handout = equation("10")});
    // The arm is about a metre long, the smallest moment 1.39 kg m^2.
    expect_near(
        found.angular_world,
        Vector3d(body.omega_world +
                 inverse_inertia_by(body) * (point - body.com_world).cross(impulse)),
        kRoundoff * 6 / units.time, "rad/s",
        {.scene = scene,
         .slip = likely<3>(found.angular_world, slips_of_apply(body, impulse, point),
                           "w' = w + I^-1 (r x J) with the whole tensor, in the world frame"),
         .handout = equation("10")});
  }
}

TEST(ApplyImpulse, WallKeepsItsVelocities) {
  if (!moves_a_struck_body()) return;
  Body body = wall({0, 0, 0});
  body.velocity_world = {0, 0, 0.1};
  body.omega_world = {0.3, 0, 0};
  const Velocity found = student().apply_impulse(body, {0, 0, 6}, {6, 3, 0});
  const Story story{
      .scene = "6 N s on a driven wall that moves at 0.1 m/s and turns at 0.3 rad/s",
      .slip = "infinite mass: use inverse_mass and inverse_inertia_body, which are 0",
      .handout = equation("10"),
      .no_number = "infinite mass: use inverse_mass and inverse_inertia_body, which are 0"};
  expect_near(found.linear_world, body.velocity_world, 0.0, "m/s", story);
  expect_near(found.angular_world, body.omega_world, 0.0, "rad/s", story);
}

// The block falls on a resting 2 kg ball, 1 m off its own centre: j = 4 N s at e = 0.5, and 16/3 at
// e = 1.
struct BlockOnBall {
  Body a = block({5, 3, 1});
  Body b = ball(2.0, 1.0, {6, 3, -1});
  Contact contact{{6, 3, 0}, kUp};
  BlockOnBall() { a.velocity_world = {0, 0, -4}; }
};
const std::string kSwapped = "signs swapped: A gets +j n, B gets -j n (action = reaction)",
                  kSwappedA = "the sign of A's impulse is wrong: A got -j n and gets +j n",
                  kSwappedB =
                      "impulse direction the same on both bodies: B got +j n and gets -j n (action "
                      "= reaction)";
bool is_same(const Vector3d& found, const Vector3d& gives) {
  return (found - gives).norm() <= kSameAnswer * gives.norm();
}

// What opens the gap: u_n' = u_n + j (A's share + B's share), where a share is 1 / m + r x n . I^-1
// (r x n). Here 1/2 + 1/2 for the block, and 1/2 for the ball, which is hit through its centre.
Slips<double> slips_of_opening(const BlockOnBall& scene, double e) {
  const double closing = -4.0, of_a = 1.0, of_b = 0.5, right = (1 + e) * 4.0 / (of_a + of_b);
  Slips<double> slips = {{closing + right * (of_a - of_b), kSwappedB},
                         {closing - right * (of_a - of_b), kSwappedA},
                         {closing - right * (of_a + of_b), kSwapped + ", or the sign of j"},
                         {closing + right * of_a, "no impulse reached B"},
                         {closing + right * of_b, "no impulse reached A"},
                         {closing, "no impulse reached A or B"}};
  for (const auto& [wrong, words] : slips_of_impulse({scene.contact, scene.a, scene.b}, e))
    if (wrong != -right) slips.push_back({closing + wrong * (of_a + of_b), words + " (in j)"});
  std::erase_if(slips, [&](const auto& slip) { return std::abs(slip.first - e * 4) < 1e-6; });
  return slips;
}

const std::string kBlockOnBall =
    "a 2 kg block falls at 4 m/s, 1 m off its centre, on a resting 2 kg ball";

TEST(ResolveCollision, PushesAAlongTheNormal) {
  const BlockOnBall scene;
  const a1::CollisionOutcome found =
      student().resolve_collision(scene.contact, scene.a, scene.b, 0.5);
  const bool is_b_swapped = is_same(found.b.linear_world, {0, 0, 2});
  expect_near(found.a.linear_world, Vector3d(0, 0, -2), kRoundoff * 4, "m/s",
              {.scene = kBlockOnBall + ", e = 0.5: j = 4 N s",
               .slip = likely<3>(found.a.linear_world,
                                 {{{0, 0, -6}, is_b_swapped ? kSwapped : kSwappedA},
                                  {{0, 0, -4}, "no impulse reached A"},
                                  {{0, 0, 4 * 2.0 / 3.0 / 2 - 4}, "the (1 + e) is missing in j"},
                                  {{0, 0, 4 / 3.0 / 2 - 4}, "e where (1 + e) belongs in j"},
                                  {{0, 0, 10 / 3.0 / 2 - 4}, "1 + e^2 where 1 + e belongs in j"},
                                  {{0, 0, 4}, "mass where inverse mass belongs: v' = v + j n / m"}},
                                 "A gets +j n, divided by its mass"),
               .handout = equation("11")});
}

TEST(ResolveCollision, PushesBTheOtherWay) {
  const BlockOnBall scene;
  const a1::CollisionOutcome found =
      student().resolve_collision(scene.contact, scene.a, scene.b, 0.5);
  const bool is_a_swapped = is_same(found.a.linear_world, {0, 0, -6});
  expect_near(found.b.linear_world, Vector3d(0, 0, -2), kRoundoff * 4, "m/s",
              {.scene = kBlockOnBall + ", e = 0.5: j = 4 N s",
               .slip = likely<3>(found.b.linear_world,
                                 {{{0, 0, 2}, is_a_swapped ? kSwapped : kSwappedB},
                                  {{0, 0, 0}, "no impulse reached B"},
                                  {{0, 0, -4.0 / 3.0}, "the (1 + e) is missing in j"},
                                  {{0, 0, -2.0 / 3.0}, "e where (1 + e) belongs in j"},
                                  {{0, 0, -5.0 / 3.0}, "1 + e^2 where 1 + e belongs in j"}},
                                 "B gets -j n"),
               .handout = equation("11")});
}

TEST(ResolveCollision, GapOpensAtETimesTheSpeedItClosed) {
  for (const double e : {0.0, 0.5, 1.0}) {
    const BlockOnBall scene;
    const a1::CollisionOutcome found =
        student().resolve_collision(scene.contact, scene.a, scene.b, e);
    const double opening = gap_rate(scene.contact, scene.a, found.a, scene.b, found.b);
    expect_near(opening, e * 4.0, kRoundoff * 8, "m/s",
                {.scene = kBlockOnBall + ", e = " + show(e),
                 .slip = likely(opening, slips_of_opening(scene, e),
                                "the restitution law u_n' = -e u_n: it fails by an impulse of the "
                                "wrong size, by a body that does not get its own, or at another "
                                "point than the impulse was computed for"),
                 .handout = equation("11")});
  }
}

TEST(ResolveCollision, PerfectBounceKeepsTheEnergy) {
  if (!moves_colliding_bodies()) return;
  BlockOnBall scene;
  scene.a.world_from_body = third_turn();
  scene.a.omega_world = {1, -2, 0.5};
  const a1::CollisionOutcome found =
      student().resolve_collision(scene.contact, scene.a, scene.b, 1.0);
  const double before =
      kinetic_energy(scene.a, velocity_of(scene.a)) + kinetic_energy(scene.b, velocity_of(scene.b));
  const double after = kinetic_energy(scene.a, found.a) + kinetic_energy(scene.b, found.b);
  expect_near(
      after, before, 4 * kRoundoff * before, "J",
      {.scene = kBlockOnBall + ", turned by 120 degrees and spinning, e = 1",
       .slip =
           after > before
               ? "energy from nothing: ways to it are a term that is missing in the denominator, "
                 "body inertia where world inertia belongs, and a sign"
               : "energy lost at e = 1: the impulse is too small, or one body did not get its own",
       .handout = equation("11")});
}

TEST(ResolveCollision, TwoTurnedBodiesMeetOnASkewNormal) {
  const Encounter e = skew_encounter();
  const Vector3d J = collision_impulse_by(e, 0.25) * e.contact.normal_b_to_a_world,
                 &p = e.contact.point_world;
  const a1::CollisionOutcome found = student().resolve_collision(e.contact, e.a, e.b, 0.25);
  const auto expect_body = [&](const Body& body, const Velocity& after, const Vector3d& impulse,
                               const std::string& swapped, const std::string& name) {
    const std::string scene =
        "two lopsided bodies, both turned and spinning, meet off their centres; n = (2, -1, 2) / "
        "3, e = 0.25";
    const Vector3d change = impulse * body.inertia.inverse_mass, &v = body.velocity_world;
    Slips<Vector3d> slips = {{v - change, swapped},
                             {v, "no impulse reached " + name},
                             {change, "the old velocity is lost: the impulse adds to it"}};
    int k = 0;
    impulse.cwiseAbs().maxCoeff(&k);
    slips.push_back({v + (change[k] < 0 ? -1 : 1) * change.norm() * Vector3d::Unit(k),
                     "the impulse along an axis of the world: it acts along n, which is skew"});
    for (const auto& [wrong, words] : slips_of_impulse(e, 0.25))
      slips.push_back({v + wrong / J.norm() * change, words + " (in j)"});
    // Rounding of j (kRoundoff * 10, see CollisionImpulse) and of the sums.
    expect_near(after.linear_world, Vector3d(v + change), kRoundoff * 60,
                "m/s (velocity of " + name + ")",
                {.scene = scene,
                 .slip = likely<3>(after.linear_world, slips, "v' = v + J / m"),
                 .handout = equation("11")});
    const Vector3d &w = body.omega_world,
                   turn = inverse_inertia_by(body) * (p - body.com_world).cross(impulse);
    Slips<Vector3d> turning = slips_of_apply(body, impulse, p);
    // Where the impulse has the wrong sign, so has the turn: then no cross product is to blame.
    if (is_same(after.linear_world, v - change))
      turning.insert(turning.begin(), {Vector3d(w - turn), swapped});
    expect_near(after.angular_world, Vector3d(w + turn), kRoundoff * 60,
                "rad/s (angular velocity of " + name + ")",
                {.scene = scene,
                 .slip = likely<3>(after.angular_world, turning,
                                   "w' = w + I^-1 (r x J), each body with its own arm and tensor"),
                 .handout = equation("11")});
  };
  const bool is_a_swapped =
                 is_same(found.a.linear_world, e.a.velocity_world - J * e.a.inertia.inverse_mass),
             is_b_swapped =
                 is_same(found.b.linear_world, e.b.velocity_world + J * e.b.inertia.inverse_mass);
  expect_body(e.a, found.a, J, is_b_swapped ? kSwapped : kSwappedA, "A");
  expect_body(e.b, found.b, -J, is_a_swapped ? kSwapped : kSwappedB, "B");
}

TEST(ResolveCollision, ADrivenWallThrowsAndGoesOn) {
  if (!moves_colliding_bodies()) return;
  for (const bool wall_is_a : {false, true}) {
    Body driven = wall({0, 0, -1}), struck = ball(2.0, 0.5, {0, 0, 0.5});
    driven.velocity_world = {0.5, 0, 2};
    driven.omega_world = {0, 0, 3};
    const Contact contact{{0, 0, 0}, wall_is_a ? Vector3d(-kUp) : kUp};
    const a1::CollisionOutcome found = student().resolve_collision(
        contact, wall_is_a ? driven : struck, wall_is_a ? struck : driven, 1.0);
    const Velocity &of_wall = wall_is_a ? found.a : found.b,
                   &of_ball = wall_is_a ? found.b : found.a;
    const std::string scene = std::string(
                                  "a driven wall rises at 2 m/s, slides at 0.5 m/s and turns at 3 "
                                  "rad/s; it meets a resting ball, e = 1; the wall is ") +
                              (wall_is_a ? "A" : "B");
    expect_near(
        of_ball.linear_world, Vector3d(0, 0, 4), kRoundoff * 4, "m/s (velocity of the ball)",
        {.scene = scene,
         .slip = likely<3>(
             of_ball.linear_world,
             {{{0, 0, 0},
               "an immovable body taken to be at rest: it throws the ball at twice its speed"},
              {{0, 0, -4}, wall_is_a ? kSwappedB : kSwappedA}},
             "a wall at V throws a ball at 2 V"),
         .handout = equation("11")});
    const std::string lost =
        "the velocity of a driven wall is lost: an impulse does not change it, not even to 0";
    expect_near(of_wall.linear_world, driven.velocity_world, 0.0, "m/s (velocity of the wall)",
                {.scene = scene, .slip = lost, .handout = equation("11")});
    expect_near(of_wall.angular_world, driven.omega_world, 0.0,
                "rad/s (angular velocity of the wall)",
                {.scene = scene, .slip = lost, .handout = equation("11")});
  }
}

TEST(ResolveCollision, SeparatingBodiesFlyOn) {
  if (!moves_colliding_bodies()) return;
  BlockOnBall scene;
  scene.a.velocity_world = {0, 0, 4};
  const a1::CollisionOutcome found =
      student().resolve_collision(scene.contact, scene.a, scene.b, 0.5);
  const Story story{.scene = "the block leaves the ball at 4 m/s",
                    .slip = "impulse applied to separating bodies",
                    .handout = equation("11")};
  expect_near(found.a.linear_world, scene.a.velocity_world, 0.0, "m/s", story);
  expect_near(found.b.linear_world, scene.b.velocity_world, 0.0, "m/s", story);
}

// Two calls of each function in one process: the first fills a static variable, which makes the
// second wrong.
TEST(Impulse, KeepsNothingBetweenCalls) {
  const Encounter first = skew_encounter();
  Encounter second = first;
  std::swap(second.a, second.b);
  second.contact = {first.contact.point_world + Vector3d(0.25, 0.5, -0.5), Vector3d(-1, 2, 2) / 3};
  second.a.velocity_world = {2, -3, -5};
  const auto story = [](const std::string& function, const std::string& n) {
    return Story{.scene = "two calls of " + function + ", each with other bodies",
                 .slip = function + " itself: see its own tests",
                 .handout = equation(n)};
  };
  using One = Eigen::Matrix<double, 1, 1>;
  const Vector3d torque(3, -1, 2), J(2, -1, 3), &p = first.contact.point_world,
                                                &q = second.contact.point_world;
  const auto w_after = [&](const Body& body, const Vector3d& at) {
    return Vector3d(body.omega_world + inverse_inertia_by(body) * (at - body.com_world).cross(J));
  };
  const auto apply = [&](const Body& body, const Vector3d& at) {
    return student().apply_impulse(body, J, at).angular_world;
  };
  const auto j = [](const Encounter& e) {
    return One(student().collision_impulse(e.contact, e.a, e.b, 0.5));
  };
  const auto u = [](const Encounter& e) {
    return One(student().relative_normal_velocity(e.contact, e.a, e.b));
  };
  // numbers up to 10; a mistake is wrong by a tenth and more
  constexpr double kAllowed = 100 * kRoundoff;
  // Each function is judged before the next is asked: the story then belongs to the last call.
  const Vector3d w1 = student().angular_acceleration(first.a, torque),
                 w2 = student().angular_acceleration(second.a, torque);
  expect_kept_nothing(w1, angular_acceleration_by(first.a, torque), w2,
                      angular_acceleration_by(second.a, torque), kAllowed, "rad/s^2",
                      story("angular_acceleration", "4"));
  const One u1 = u(first), u2 = u(second);
  expect_kept_nothing(u1, One(relative_normal_velocity_by(first)), u2,
                      One(relative_normal_velocity_by(second)), kAllowed, "m/s",
                      story("relative_normal_velocity", "5"));
  const One j1 = j(first), j2 = j(second);
  expect_kept_nothing(j1, One(collision_impulse_by(first, 0.5)), j2,
                      One(collision_impulse_by(second, 0.5)), kAllowed, "N s",
                      story("collision_impulse", "9"));
  const Vector3d a1 = apply(first.a, p), a2 = apply(second.a, q);
  expect_kept_nothing(a1, w_after(first.a, p), a2, w_after(second.a, q), kAllowed, "rad/s",
                      story("apply_impulse", "10"));
}

}  // namespace
}  // namespace tumble::testing
