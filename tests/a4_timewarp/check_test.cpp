// The time of the next check (A4.2), and the decision on a collision check (A4.3).
#include "tests/a4_timewarp/a4_fixtures.h"

namespace tumble::a4_testing {
namespace {

constexpr double kStep = 0.125;  // exact in doubles, as are the times below

void expect_next(double gap, double speed, double acceleration, double expected,
                 const std::string& slip) {
  const double found = a4_module().next_check_time(2.0, gap, speed, acceleration, kStep);
  // A square root, a division and some sums of numbers of size 10.
  expect_near(found, expected, 10 * kEps * 10, "s",
              {.scene = "t = 2 s, gap " + show(gap) + " m, closing at most at " + show(speed) +
                        " m/s, acceleration at most " + show(acceleration) + " m/s^2, h = 0.125 s",
               .slip = slip,
               .handout = equation(2)});
}

TEST(NextCheckTime, IsWhenTheGapMayHaveClosed) {
  expect_next(1.0, 2.0, 0.0, 2.5,
              "gap / speed is how long it takes at least; it is counted from now");
  expect_next(0.3, 1.0, 0.0, 2.3,
              "gap / speed is how long it takes at least; it is counted from now");
  expect_next(0.5, 0.0, 1.0, 3.0, "from rest: sqrt(2 gap / a)");
  expect_next(2.0, 1.0, 2.0, 3.0,
              "gap = v s + a s^2 / 2: with both, neither gap / v nor sqrt(2 gap / a)");
}

TEST(NextCheckTime, IsAtLeastAStepAhead) {
  const std::string slip =
      "max(h, s): closer looks are creeping, which is what the conservative method does";
  expect_next(0.001, 2.0, 0.0, 2.125, slip);
  expect_next(0.0, 2.0, 9.81, 2.125, slip);
  expect_next(0.0, 0.0, 0.0, 2.125,
              "0 / 0: bodies that touch and do not move are looked at after a step");
}

TEST(NextCheckTime, IsAtMostTenStepsAhead) {
  const std::string slip =
      "min(10 h, ...): a check that waits holds global virtual time back at its safe time";
  expect_next(100.0, 1.0, 0.0, 3.25, slip);
  expect_next(1.0, 0.0, 0.0, 3.25, slip);
}

TEST(NextCheckTime, IsRightInEveryUnit) {
  // A gap of 1e-30 m that closes at as many metres per second, and one of 1e30 m: s is the same, in
  // powers of two exactly.
  const bool plain = std::abs(a4_module().next_check_time(2.0, 2.0, 1.0, 2.0, kStep) - 3.0) < 1e-12;
  const std::string slip = plain
                               ? "an absolute threshold: only a gap of exactly 0, or a speed and "
                                 "an acceleration of exactly 0, are cases of their own"
                               : "the same in metres is wrong, too: see the tests before this one";
  for (const double unit : {0x1p-100, 0x1p100}) {
    expect_next(2.0 * unit, 1.0 * unit, 2.0 * unit, 3.0, slip);
    expect_next(1.0 * unit, 2.0 * unit, 0.0, 2.5, slip);
  }
  // the textbook form of the root cancels here and gives 0.9992; s is 1 less 5e-15
  expect_next(1.0, 1.0, 1e-14, 3.0, slip);
}

// ---- Collision checks --------------------------------------------------------------------------

CheckFinding disjoint(double gap) { return {std::nullopt, gap, 2.0, 0.0}; }

TEST(OnCollisionCheck, DisjointBodiesAreSafeUpToNow) {
  const ScheduledEvent event = collision_check(A, B, 0.25, 0.5);
  const CheckDecision found = a4_module().on_collision_check(event, disjoint(1.0), kStep);
  const Story story{
      .scene =
          "A and B were looked at in [0.25, 0.5] s: disjoint, 1 m apart, closing at most at 2 m/s",
      .slip =
          found.next.safe_time == 0.25
              ? "the safe time stands still: the same interval would be looked at again and again"
          : found.next.safe_time == 0.5
              ? "the next look is due at next_check_time, counted from the time of this one"
              : "safe up to the time of the check, no farther: what comes after it was not looked "
                "at",
      .handout = equation(3)};
  expect_true(!found.collides, "no impact", "an impact", story);
  expect_times(found.next, event, 0.5, 1.0, story);
}

TEST(OnCollisionCheck, DisjointBodiesGoOn) {
  const CheckDecision near =
      a4_module().on_collision_check(collision_check(A, B, 0.25, 0.5), disjoint(0.0), kStep);
  const Story story{
      .scene = "A and B were looked at in [0.25, 0.5] s: disjoint, and at 0.5 s their gap is 0",
      .slip = "nobody goes back where nothing was found",
      .handout = equation(3)};
  expect_rollbacks(near.rollbacks, {}, story);
  expect_near(near.next.stamp.time, 0.625, 0.0, "s (next look)", story);
}

TEST(OnCollisionCheck, AnImpactSendsBothBackToIt) {
  const Stamp contact = impact(0.375, A, B, 2);
  const CheckDecision found = a4_module().on_collision_check(collision_check(A, B, 0.25, 0.5),
                                                             {contact, 0.0, 2.0, 0.0}, kStep);
  const Story story{.scene =
                        "the check of A and B looked at [0.25, 0.5] s and found them to meet at "
                        "0.375 s (microstep 2)",
                    .slip =
                        "both go back to the stamp of the impact: not to the safe time, not to the "
                        "time of the check",
                    .handout = equation(3)};
  expect_true(found.collides, "an impact", "no impact",
              {.scene = story.scene,
               .slip = "an impact in the past is an impact: this is what rollback is for",
               .handout = story.handout});
  expect_rollbacks(found.rollbacks, {back(A, contact), back(B, contact)}, story);
  expect_times(found.next, collision_check(A, B, 0.25, 0.5), 0.375, 0.375,
               {.scene = story.scene,
                .slip = "the next check is this one with its two times replaced: its microstep is "
                        "the check's, not the impact's",
                .handout = story.handout});
}

TEST(OnCollisionCheck, AWallIsNotSentBack) {
  const Stamp contact = impact(0.375, C, kWall);
  const CheckDecision found = a4_module().on_collision_check(
      collision_check(C, kWall, 0.25, 0.5, {C}), {contact, 0.0, 2.0, 0.0}, kStep);
  expect_rollbacks(found.rollbacks, {back(C, contact)},
                   {.scene = "C meets the wall at 0.375 s; the receivers of the check are {C}",
                    .slip = "receivers go back, not the bodies of the stamp: a wall is no process",
                    .handout = equation(3)});
}

TEST(OnCollisionCheck, AfterAnImpactTheCheckGoesOnFromThere) {
  const ScheduledEvent event = collision_check(A, B, 0.25, 0.5);
  const CheckDecision found =
      a4_module().on_collision_check(event, {impact(0.375, A, B), 0.0, 2.0, 0.0}, kStep);
  expect_times(
      found.next, event, 0.375, 0.375,
      {.scene = "the check of A and B looked at [0.25, 0.5] s and found them to meet at 0.375 s",
       .slip = found.next.safe_time == 0.5 ? "safe up to 0.5 s was true of the motion that is "
                                             "undone: after the impact they move otherwise"
                                           : "safe time and time are those of the impact",
       .handout = equation(3)});
}

}  // namespace
}  // namespace tumble::a4_testing
