// Impulse between two bodies: without rotation (A1.8) and with it (A1.9).
#include "tests/a1_impulse/a1_fixtures.h"

namespace tumble::testing {
namespace {

// At most 30 roundings, each of relative size eps / 2, none amplified (no cancellation in these
// scenes): every correct order of evaluation passes. The nearest mistake is wrong by a tenth or
// more.
constexpr double kImpulseRoundoff = 15 * kEps;

const std::string kForgotOnePlusE = "the (1 + e) is missing";
const std::string kOnlyE = "e where (1 + e) belongs";
const std::string kSquaredE =
    "1 + e^2 where 1 + e belongs: e is a ratio of speeds, e^2 one of energies";
const std::string kWrongSign =
    "the sign of j is wrong: u_n is negative when bodies approach, so j needs the minus in front";
const std::string kCalledSeparating =
    "approaching bodies treated as separating: u_n = n . (u_a - u_b) with n from B to A is "
    "negative when they approach";

TEST(ImpulseWithoutRotation, HeadOnHitSharesTheBlowByInverseMasses) {
  Body a = ball(2.0, 0.5, {0, 0, 1}), b = ball(6.0, 0.5, {0, 0, 0});
  a.velocity_world = {0, 0, -1};
  b.velocity_world = {0, 0, 2};
  const double found = student().collision_impulse_without_rotation({{0, 0, 0.5}, kUp}, a, b, 0.5);
  // Exact: 1.5 * 3 / (1/2 + 1/6) = 6.75.
  expect_near(found, 6.75, kImpulseRoundoff * 6.75, "N s",
              {.scene = "A, 2 kg at -1 m/s, meets B, 6 kg at +2 m/s, along n = +z; e = 0.5",
               .slip = likely(found,
                              {{4.5, kForgotOnePlusE},
                               {2.25, kOnlyE},
                               {-6.75, kWrongSign},
                               {5.625, kSquaredE},
                               {0.0, kCalledSeparating},
                               {36.0, "1/(m_a + m_b) where 1/m_a + 1/m_b belongs"}},
                              "inverse masses or relative velocity"),
               .handout = equation("8")});
}

TEST(ImpulseWithoutRotation, WallIsABodyOfInfiniteMass) {
  Body a = ball(2.0, 0.5, {0, 0, 0.5});
  a.velocity_world = {0, 0, -3};
  const double found =
      student().collision_impulse_without_rotation({{0, 0, 0}, kUp}, a, wall({0, 0, 0}), 0.5);
  expect_near(found, 9.0, kImpulseRoundoff * 9.0, "N s",
              {.scene = "a 2 kg ball at 3 m/s hits an immovable wall, e = 0.5",
               .slip = likely(found,
                              {{6.0, kForgotOnePlusE},
                               {3.0, kOnlyE},
                               {7.5, kSquaredE},
                               {-9.0, kWrongSign},
                               {0.0, kCalledSeparating}},
                              "infinite mass: its inverse mass is 0"),
               .handout = equation("8")});
}

TEST(ImpulseWithoutRotation, TakesNoNoticeOfSpin) {
  Body a = block({5, 3, 1});
  a.velocity_world = {0, 0, -4};
  a.omega_world = {0, 3, 0};
  const double found =
      student().collision_impulse_without_rotation({{6, 3, 0}, kUp}, a, wall({0, 0, 0}), 0.5);
  expect_near(found, 12.0, kImpulseRoundoff * 12.0, "N s",
              {.scene = "a spinning 2 kg block at 4 m/s hits a wall off centre; equation (A1.8) "
                        "knows points only; e = 0.5",
               .slip = likely(found,
                              {{8.0, kForgotOnePlusE},
                               {4.0, kOnlyE},
                               {10.0, kSquaredE},
                               {-12.0, kWrongSign},
                               {0.0, kCalledSeparating}},
                              "rotation taken into account: v_a - v_b is of the centres of mass "
                              "here, and no inertia tensor occurs"),
               .handout = equation("8")});
}

TEST(ImpulseWithoutRotation, SeparatingBodiesGetNone) {
  if (!gives_impulses_without_rotation()) return;
  Body a = ball(2.0, 0.5, {0, 0, 1}), b = ball(6.0, 0.5, {0, 0, 0});
  a.velocity_world = {0, 0, 3};
  const double found = student().collision_impulse_without_rotation({{0, 0, 0.5}, kUp}, a, b, 0.5);
  expect_near(found, 0.0, 0.0, "N s",
              {.scene = "A flies away from B at 3 m/s, e = 0.5",
               .slip = "impulse applied to separating bodies: it would pull them together",
               .handout = equation("8")});
}

TEST(ImpulseWithoutRotation, DrivenWallsMoveToo) {
  for (const bool wall_is_a : {false, true}) {
    Body driven = wall({0, 0, 0}), struck = ball(2.0, 0.5, {0, 0, 0.5});
    driven.velocity_world = {0, 0, 2};
    const Contact contact{{0, 0, 0}, wall_is_a ? Vector3d(-kUp) : kUp};
    const double found = student().collision_impulse_without_rotation(
        contact, wall_is_a ? driven : struck, wall_is_a ? struck : driven, 0.5);
    expect_near(
        found, 6.0, kImpulseRoundoff * 6.0, "N s",
        {.scene =
             std::string(
                 "a floor that rises at 2 m/s meets a resting 2 kg ball, e = 0.5; the floor is ") +
             (wall_is_a ? "A" : "B"),
         .slip = likely(found,
                        {{0.0,
                          "an immovable body taken to be at rest: infinite mass says nothing about "
                          "its velocity"},
                         {4.0, kForgotOnePlusE},
                         {2.0, kOnlyE},
                         {5.0, kSquaredE},
                         {-6.0, kWrongSign}},
                        "inverse masses or relative velocity"),
         .handout = equation("8")});
  }
  Body lowered = wall({0, 0, 1});
  lowered.velocity_world = {0, 0, -1};
  const std::string slip =
      "infinite mass on both sides: the denominator is 0, and no impulse can do anything";
  expect_near(student().collision_impulse_without_rotation({{0, 0, 0}, kUp}, lowered,
                                                           wall({0, 0, -1}), 0.5),
              0.0, 0.0, "N s",
              {.scene = "a driven wall (infinite mass, 1 m/s) meets another wall",
               .slip = slip,
               .handout = equation("8"),
               .no_number = slip});
}

TEST(ImpulseWithoutRotation, IsRightInEveryUnit) {
  Body a = ball(2.0, 0.5, {0, 0, 1}), b = ball(6.0, 0.5, {0, 0, 0});
  a.velocity_world = {0, 0, -1};
  b.velocity_world = {0, 0, 2};
  const bool plain =
      std::abs(student().collision_impulse_without_rotation({{0, 0, 0.5}, kUp}, a, b, 0.5) -
               6.75) <= kImpulseRoundoff * 6.75;
  for (const Units& units : changes_of_unit()) {
    const Encounter e = scaled({{{0, 0, 0.5}, kUp}, a, b}, units.length, units.mass, units.time);
    const double size = units.mass * units.length / units.time,
                 found = student().collision_impulse_without_rotation(e.contact, e.a, e.b, 0.5);
    expect_near(
        found, 6.75 * size, kImpulseRoundoff * 6.75 * size, "N s",
        {.scene =
             "A, 2 kg at -1 m/s, meets B, 6 kg at +2 m/s, along n = +z; e = 0.5; " + show(units),
         .slip = slip_of_units(plain,
                               "an absolute threshold: bodies approach where u_n < 0, and both are "
                               "of infinite mass where 1/m_a + 1/m_b is exactly 0"),
         .handout = equation("8")});
  }
}

TEST(CollisionImpulse, CentralHitReversesVelocityScaledByRestitution) {
  Body a = ball(2.0, 0.5, {0, 0, 0.5});
  a.velocity_world = {0, 0, -3};
  const double found = student().collision_impulse({{0, 0, 0}, kUp}, a, wall({0, 0, -1}), 0.5);
  // Exact: j = (1 + e) m |v| = 1.5 * 2 * 3 = 9 N s. The arm is along n, so rotation adds nothing.
  expect_near(found, 9.0, kImpulseRoundoff * 9.0, "N s",
              {.scene = "a 2 kg ball at 3 m/s hits a wall, e = 0.5",
               .slip = likely(found,
                              {{6.0, kForgotOnePlusE},
                               {3.0, kOnlyE},
                               {7.5, kSquaredE},
                               {-9.0, kWrongSign},
                               {0.0, kCalledSeparating}},
                              "inverse mass or relative velocity"),
               .handout = equation("9")});
}

TEST(CollisionImpulse, OffCentreHitTurnsPartOfTheBlow) {
  Body a = block({5, 3, 1});
  a.velocity_world = {0, 0, -4};
  const double found = student().collision_impulse({{6, 3, 0}, kUp}, a, wall({0, 0, 0}), 0.5);
  // r = (1, 0, -1), r x n = (0, -1, 0), so the denominator is 1/2 + 1/2 and j = 1.5 * 4 / 1.
  expect_near(found, 6.0, kImpulseRoundoff * 6.0, "N s",
              {.scene = "a 2 kg block, moments 1, 2, 4 kg m^2, falls at 4 m/s and lands 1 m off "
                        "centre on a floor, e = 0.5",
               .slip = likely(found,
                              {{12.0, "the rotation term of the denominator is missing"},
                               {4.0, kForgotOnePlusE},
                               {2.0, kOnlyE},
                               {5.0, kSquaredE},
                               {-6.0, kWrongSign},
                               {0.0, kCalledSeparating},
                               {6.0 / 27.5, "the arm starts at the world's origin: r = p - x"},
                               {2.4, "inertia where inverse inertia belongs"}},
                              "the rotation term of the denominator, n . [(I^-1 (r x n)) x r]"),
               .handout = equation("9")});
}

TEST(CollisionImpulse, TurnedBlockNeedsItsInertiaInTheWorldFrame) {
  Body a = block({5, 3, 1});
  a.world_from_body = third_turn();
  a.velocity_world = {0, 0, -4};
  const double found = student().collision_impulse({{6, 3, 0}, kUp}, a, wall({0, 0, 0}), 0.5);
  // About the world's y the block now has the moment of its own x, 1 kg m^2: denominator 1/2 + 1.
  expect_near(
      found, 4.0, kImpulseRoundoff * 4.0, "N s",
      {.scene =
           "a 2 kg block falls at 4 m/s and lands 1 m off centre on a floor, e = 0.5; it is turned "
           "by 120 degrees about (1, 1, 1): moments 4, 1, 2 kg m^2 about world x, y, z",
       .slip = likely(found,
                      {{6.0, "body inertia where world inertia belongs: I^-1 = R I_body^-1 R^T"},
                       {8.0, "R and R^T swapped: I^-1 = R I_body^-1 R^T"},
                       {12.0, "the rotation term of the denominator is missing"},
                       {8.0 / 3.0, kForgotOnePlusE},
                       {4.0 / 3.0, kOnlyE},
                       {10.0 / 3.0, kSquaredE},
                       {-4.0, kWrongSign}},
                      "world inertia: I^-1 = R I_body^-1 R^T"),
       .handout = equation("9")});
}

TEST(CollisionImpulse, SpinAloneCanCauseACollision) {
  Body a = block({5, 3, 1});
  a.omega_world = {0, 3, 0};
  const double found = student().collision_impulse({{6, 3, 0}, kUp}, a, wall({0, 0, 0}), 0.5);
  // w x r = (-3, 0, -3): u_n = -3, denominator 1.
  expect_near(found, 4.5, kImpulseRoundoff * 4.5, "N s",
              {.scene = "a block that hovers but spins at 3 rad/s touches the floor with a corner "
                        "1 m off centre, e = 0.5",
               .slip = likely(found,
                              {{0.0,
                                "relative velocity without rotation, or r x w for w x r: the "
                                "touching point moves at v + w x r"},
                               {3.0, kForgotOnePlusE},
                               {1.5, kOnlyE},
                               {3.75, kSquaredE},
                               {-4.5, kWrongSign}},
                              "velocity of the touching point, v + w x r"),
               .handout = equation("5")});
}

TEST(CollisionImpulse, BothBodiesYield) {
  Body a = block({5, 3, 1});
  const Body b = ball(2.0, 1.0, {6, 3, -1});
  a.velocity_world = {0, 0, -4};
  const double found = student().collision_impulse({{6, 3, 0}, kUp}, a, b, 0.5);
  expect_near(
      found, 4.0, kImpulseRoundoff * 4.0, "N s",
      {.scene =
           "the block falls at 4 m/s, 1 m off its centre, on top of a resting 2 kg ball, e = 0.5",
       .slip = likely(found,
                      {{6.0, "the other body's share of the denominator is missing"},
                       {-4.0, kWrongSign},
                       {8.0 / 3.0, kForgotOnePlusE},
                       {4.0 / 3.0, kOnlyE},
                       {10.0 / 3.0, kSquaredE},
                       {0.0, kCalledSeparating}},
                      "the denominator sums over both bodies"),
       .handout = equation("9")});
}

// Rounding: u_n is a sum of twelve products of up to 3 m/s that is -5 m/s, the denominator one of
// nine times nine; kImpulseRoundoff * 10 times j.
constexpr double kSkewRoundoff = 10 * kImpulseRoundoff;

TEST(CollisionImpulse, TwoTurnedBodiesMeetOnASkewNormal) {
  const Encounter e = skew_encounter();
  for (const double restitution : {0.0, 0.25, 1.0}) {
    const double j = collision_impulse_by(e, restitution),
                 found = student().collision_impulse(e.contact, e.a, e.b, restitution);
    expect_near(
        found, j, kSkewRoundoff * j, "N s",
        {.scene = "two lopsided bodies (full inertia tensors), both turned and spinning, meet off "
                  "their centres; n = (2, -1, 2) / 3, e = " +
                  show(restitution),
         .slip = likely(found, slips_of_impulse(e, restitution),
                        "both arms, both spins, the whole inertia tensors in the world frame"),
         .handout = equation("9")});
  }
}

TEST(CollisionImpulse, DrivenWallsMoveAndTurn) {
  for (const bool wall_is_a : {false, true}) {
    Encounter e = skew_encounter();
    Body& driven = wall_is_a ? e.a : e.b;
    const Body moving = driven;
    driven = wall(moving.com_world);
    driven.velocity_world = moving.velocity_world;
    driven.omega_world = moving.omega_world;
    const double j = collision_impulse_by(e, 0.25),
                 found = student().collision_impulse(e.contact, e.a, e.b, 0.25);
    expect_near(
        found, j, kSkewRoundoff * j, "N s",
        {.scene = std::string("a driven wall that moves and turns is ") + (wall_is_a ? "A" : "B") +
                  "; n = (2, -1, 2) / 3, e = 0.25",
         .slip = likely(found, slips_of_impulse(e, 0.25),
                        "the wall's velocity v + w x r, and no inverse mass or inertia of it"),
         .handout = equation("9")});
  }
}

TEST(CollisionImpulse, IsRightInEveryUnit) {
  const Encounter e = skew_encounter();
  const double j = collision_impulse_by(e, 0.25);
  const bool plain =
      std::abs(student().collision_impulse(e.contact, e.a, e.b, 0.25) - j) <= kSkewRoundoff * j;
  for (const Units& units : changes_of_unit()) {
    const Encounter other = scaled(e, units.length, units.mass, units.time);
    const double size = units.mass * units.length / units.time,
                 found = student().collision_impulse(other.contact, other.a, other.b, 0.25);
    expect_near(
        found, j * size, kSkewRoundoff * j * size, "N s",
        {.scene = "two lopsided bodies meet on a skew normal, e = 0.25; " + show(units),
         .slip = slip_of_units(plain,
                               "an absolute threshold: bodies approach where u_n < 0, and both are "
                               "of infinite mass where the denominator is exactly 0"),
         .handout = equation("9")});
  }
}

TEST(CollisionImpulse, SeparatingBodiesGetNone) {
  if (!gives_impulses()) return;
  Body a = ball(2.0, 0.5, {0, 0, 0.5});
  a.velocity_world = {0, 0, 3};
  const double found = student().collision_impulse({{0, 0, 0}, kUp}, a, wall({0, 0, -1}), 0.5);
  expect_near(found, 0.0, 0.0, "N s",
              {.scene = "a 2 kg ball leaves a wall at 3 m/s, e = 0.5",
               .slip = "impulse applied to separating bodies: it would pull them together",
               .handout = equation("9")});
}

TEST(CollisionImpulse, TwoWallsExchangeNone) {
  if (!gives_impulses()) return;
  Body a = wall({0, 0, 1});
  a.velocity_world = {0, 0, -1};
  const double found = student().collision_impulse({{0, 0, 0}, kUp}, a, wall({0, 0, -1}), 0.5);
  expect_near(
      found, 0.0, 0.0, "N s",
      {.scene = "a driven wall (infinite mass, 1 m/s) meets another wall",
       .slip = "infinite mass on both sides: the denominator is 0, and no impulse can do anything",
       .handout = equation("9"),
       .no_number =
           "infinite mass on both sides: the denominator is 0, and no impulse can do anything"});
}

}  // namespace
}  // namespace tumble::testing
