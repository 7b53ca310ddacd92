// What an impulse does: to one body (A1.10), to both (A1.11).
#include "tests/a1_impulse/a1_fixtures.h"

namespace tumble::testing {
namespace {

constexpr double kRoundoff = 20 * kEps;  // times the largest number involved: at most 40 roundings of eps / 2 each
const Vector3d kUp = Vector3d::UnitZ();

TEST(ApplyImpulse, ThroughTheCentreChangesTheVelocity) {
  Body body = block({5, 3, 1});
  body.velocity_world = {1, 0, 0};
  const Velocity found = student().apply_impulse(body, {0, 0, 6}, {5, 3, 1});
  expect_near(found.linear_world, Vector3d(1, 0, 3), kRoundoff * 3, "m/s",
              {.scene = "6 N s along z through the centre of a 2 kg block that moves at (1, 0, 0) m/s",
               .slip = likely<3>(found.linear_world,
                                 {{{1, 0, 12}, "mass where inverse mass belongs"},
                                  {{0, 0, 3}, "the old velocity is lost: the impulse adds to it"},
                                  {{1, 0, 6}, "the inverse mass is missing"},
                                  {{1, 0, -3}, "the sign: the impulse is given as this body feels it"}},
                                 "v' = v + J / m"),
               .handout = equation("10")});
}

TEST(ApplyImpulse, OffTheCentreTurnsTheBody) {
  Body body = block({5, 3, 1});
  body.omega_world = {0, 1, 0};
  const Velocity found = student().apply_impulse(body, {0, 0, 6}, {6, 3, 0});
  // r = (1, 0, -1), r x J = (0, -6, 0), moment 2 kg m^2.
  expect_near(found.angular_world, Vector3d(0, -2, 0), kRoundoff * 6, "rad/s",
              {.scene = "6 N s along z at (6, 3, 0) m on a block centred at (5, 3, 1) m that spins at (0, 1, 0) rad/s",
               .slip = likely<3>(found.angular_world,
                                 {{{0, 4, 0}, "J x r where r x J belongs"},
                                  {{0, 1, 0}, "the angular velocity is not changed: an impulse off the centre also turns"},
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
  expect_near(found.angular_world, Vector3d(0, -6, 0), kRoundoff * 6, "rad/s",
              {.scene = "the same blow on the block turned by 120 degrees, at rest: its moment about world y is now 1 kg m^2",
               .slip = likely<3>(found.angular_world,
                                 {{{0, -3, 0}, "body inertia where world inertia belongs: I^-1 = R I_body^-1 R^T"},
                                  {{0, -1.5, 0}, "R and R^T swapped: I^-1 = R I_body^-1 R^T"},
                                  {{0, 6, 0}, "J x r where r x J belongs"}},
                                 "world inertia: I^-1 = R I_body^-1 R^T"),
               .handout = equation("10")});
}

TEST(ApplyImpulse, WallKeepsItsVelocities) {
  if (!moves_a_struck_body()) return;
  Body body = wall({0, 0, 0});
  body.velocity_world = {0, 0, 0.1};
  body.omega_world = {0.3, 0, 0};
  const Velocity found = student().apply_impulse(body, {0, 0, 6}, {6, 3, 0});
  const Story story{.scene = "6 N s on a driven wall that moves at 0.1 m/s and turns at 0.3 rad/s",
                    .slip = "infinite mass: use inverse_mass and inverse_inertia_body, which are 0",
                    .handout = equation("10")};
  expect_near(found.linear_world, body.velocity_world, 0.0, "m/s", story);
  expect_near(found.angular_world, body.omega_world, 0.0, "rad/s", story);
}

// The block falls on a resting 2 kg ball, 1 m off its own centre: j = 4 N s at e = 0.5, and 16/3 at e = 1.
struct BlockOnBall {
  Body a = block({5, 3, 1});
  Body b = ball(2.0, 1.0, {6, 3, -1});
  Contact contact{{6, 3, 0}, kUp};
  BlockOnBall() { a.velocity_world = {0, 0, -4}; }
};
const std::string kBlockOnBall = "a 2 kg block falls at 4 m/s, 1 m off its centre, on a resting 2 kg ball";

TEST(ResolveCollision, PushesAAlongTheNormal) {
  const BlockOnBall scene;
  const a1::CollisionOutcome found = student().resolve_collision(scene.contact, scene.a, scene.b, 0.5);
  expect_near(found.a.linear_world, Vector3d(0, 0, -2), kRoundoff * 4, "m/s",
              {.scene = kBlockOnBall + ", e = 0.5: j = 4 N s",
               .slip = likely<3>(found.a.linear_world, {{{0, 0, -6}, "signs swapped: A gets +j n, B gets -j n"},
                                                          {{0, 0, -4}, "no impulse reached A"},
                                                          {{0, 0, 4 * 2.0 / 3.0 / 2 - 4}, "the (1 + e) is missing in j"},
                                                          {{0, 0, 4 / 3.0 / 2 - 4}, "e where (1 + e) belongs in j"},
                                                          {{0, 0, 4}, "mass where inverse mass belongs: v' = v + j n / m"}},
                                 "A gets +j n, divided by its mass"),
               .handout = equation("11")});
}

TEST(ResolveCollision, PushesBTheOtherWay) {
  const BlockOnBall scene;
  const a1::CollisionOutcome found = student().resolve_collision(scene.contact, scene.a, scene.b, 0.5);
  expect_near(found.b.linear_world, Vector3d(0, 0, -2), kRoundoff * 4, "m/s",
              {.scene = kBlockOnBall + ", e = 0.5: j = 4 N s",
               .slip = likely<3>(found.b.linear_world, {{{0, 0, 2}, "impulse direction the same on both bodies: B got +j n and gets -j n (action = reaction)"}, {{0, 0, 0}, "no impulse reached B"}, {{0, 0, -4.0 / 3.0}, "the (1 + e) is missing in j"}, {{0, 0, -2.0 / 3.0}, "e where (1 + e) belongs in j"}},
                                 "B gets -j n"),
               .handout = equation("11")});
}

TEST(ResolveCollision, GapOpensAtETimesTheSpeedItClosed) {
  for (const double e : {0.0, 0.5, 1.0}) {
    const BlockOnBall scene;
    const a1::CollisionOutcome found = student().resolve_collision(scene.contact, scene.a, scene.b, e);
    expect_near(gap_rate(scene.contact, scene.a, found.a, scene.b, found.b), e * 4.0, kRoundoff * 8, "m/s",
                {.scene = kBlockOnBall + ", e = " + show(e),
                 .slip = "the restitution law u_n' = -e u_n fails: an impulse of the wrong size, or applied at another point than it was computed for",
                 .handout = equation("11")});
  }
}

TEST(ResolveCollision, PerfectBounceKeepsTheEnergy) {
  if (!moves_colliding_bodies()) return;
  BlockOnBall scene;
  scene.a.world_from_body = third_turn();
  scene.a.omega_world = {1, -2, 0.5};
  const a1::CollisionOutcome found = student().resolve_collision(scene.contact, scene.a, scene.b, 1.0);
  const double before = kinetic_energy(scene.a, velocity_of(scene.a)) + kinetic_energy(scene.b, velocity_of(scene.b));
  const double after = kinetic_energy(scene.a, found.a) + kinetic_energy(scene.b, found.b);
  expect_near(after, before, 4 * kRoundoff * before, "J",
              {.scene = kBlockOnBall + ", turned by 120 degrees and spinning, e = 1",
               .slip = after > before ? "energy from nothing: a term of the denominator is missing, or body inertia stands where world inertia belongs"
                                      : "energy lost at e = 1: the impulse is too small, or one body did not get its own",
               .handout = equation("11")});
}

TEST(ResolveCollision, SeparatingBodiesFlyOn) {
  if (!moves_colliding_bodies()) return;
  BlockOnBall scene;
  scene.a.velocity_world = {0, 0, 4};
  const a1::CollisionOutcome found = student().resolve_collision(scene.contact, scene.a, scene.b, 0.5);
  const Story story{.scene = "the block leaves the ball at 4 m/s", .slip = "impulse applied to separating bodies", .handout = equation("11")};
  expect_near(found.a.linear_world, scene.a.velocity_world, 0.0, "m/s", story);
  expect_near(found.b.linear_world, scene.b.velocity_world, 0.0, "m/s", story);
}

}  // namespace
}  // namespace tumble::testing
