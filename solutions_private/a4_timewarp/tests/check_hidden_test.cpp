#include <cmath>

#include "framework/core/random.h"
#include "tests/a4_timewarp/a4_fixtures.h"

namespace tumble::a4_testing {
namespace {

TEST(NextCheckTime, ClosesTheGapExactly) {
  Random random(421);
  for (int i = 0; i < 300; ++i) {
    const double v = std::pow(10.0, random.between(-3, 3)),
                 a = random.below(4) == 0 ? 0.0 : std::pow(10.0, random.between(-9, 2)),
                 s = random.between(0.2, 1.9), h = 0.2;
    const double gap = v * s + a * s * s / 2,
                 found = a4_module().next_check_time(0.0, gap, v, a, h);
    // Some ten roundings of s. The root in its school form loses half the digits where a is small.
    expect_near(found, std::max(h, s), 20 * kEps * 2, "s",
                {.scene = "gap " + show(gap) + " m, v " + show(v) + " m/s, a " + show(a) +
                          " m/s^2, h 0.2 s, t = 0",
                 .slip = "the root (-v + sqrt(v^2 + 2 a gap)) / a cancels where a is small, and "
                         "divides by 0 where it is 0",
                 .handout = equation(2)});
  }
}

TEST(OnCollisionCheck, BothEndsOfTheIntervalAreInIt) {
  for (const double tc : {0.25, 0.5}) {
    const Stamp contact = impact(tc, B, D);
    const ScheduledEvent event = collision_check(B, D, 0.25, 0.5);
    const CheckDecision found =
        a4_module().on_collision_check(event, {contact, 0.0, 1.0, 0.0}, 0.125);
    const Story story{
        .scene = "the check of B and D looked at [0.25, 0.5] s and found them to meet at " +
                 show(tc) + " s",
        .slip =
            "an impact at an end of the interval is an impact; both bodies go back even if they "
            "stand right there",
        .handout = equation(3)};
    expect_true(found.collides, "an impact", "no impact", story);
    expect_rollbacks(found.rollbacks, {back(B, contact), back(D, contact)}, story);
    expect_times(found.next, event, tc, tc, story);
  }
}

TEST(OnCollisionCheck, LooksAgainWhenItMay) {
  Random random(422);
  for (int i = 0; i < 50; ++i) {
    const double h = 0.05, s = random.between(0.06, 0.4), v = random.between(0.1, 3),
                 a = random.between(0, 5), t = random.between(0, 9);
    const ScheduledEvent event = collision_check(A, C, t - 0.1, t);
    const CheckDecision found =
        a4_module().on_collision_check(event, {std::nullopt, v * s + a * s * s / 2, v, a}, h);
    expect_near(found.next.stamp.time, t + s, 40 * kEps * 10, "s (next look)",
                {.scene = "a check at " + show(t) + " s: disjoint, v " + show(v) + " m/s, a " +
                          show(a) + " m/s^2, h 0.05 s",
                 .slip = "next_check_time, from the time of the check",
                 .handout = equation(3)});
    expect_near(found.next.safe_time, t, 0.0, "s (safe time)",
                {.scene = "a check at " + show(t) + " s: disjoint",
                 .slip = "safe up to the check",
                 .handout = equation(3)});
  }
}

TEST(OnGroupCheck, TheEndsOfTheIntervalCount) {
  for (const double opens : {1.0, 1.5}) {
    const ScheduledEvent event = group_check({B, C, D}, 1.0, 1.5);
    const GroupDecision found =
        a4_module().on_group_check(event, {{C, D, opens}, {B, C, opens}, {B, kWall, 1.75}}, 0.125);
    const Story story{.scene = "B, C, D in a row; B-C and C-D both open at " + show(opens) +
                               " s, an end of [1, 1.5] s",
                      .slip = "all that opens at the first opening is open: three groups",
                      .handout = equation(5)};
    const std::vector<std::vector<std::int32_t>> expected{{B}, {C}, {D}};
    expect_true(found.changes && found.groups == expected, show(expected),
                found.changes ? show(found.groups) : "no change", story);
    expect_times(found.next, event, opens, opens, story);
  }
}

TEST(OnCallback, NeedsNothingWhereNobodyIsLater) {
  ScheduledEvent event = callback(B, 1.0);
  expect_rollbacks(a4_module().on_callback(event, {{A, 2.0}, {B, 1.5}}), {back(B, event.stamp)},
                   {.scene = "a callback of B at 1 s; B stands at 1.5 s, A at 2 s",
                    .slip = "the receiver that is later comes back",
                    .handout = equation(6)});
  expect_rollbacks(a4_module().on_callback(event, {{A, 2.0}, {B, 1.0}}), {},
                   {.scene = "a callback of B at 1 s; B stands at 1 s, A at 2 s",
                    .slip = "B has done nothing later",
                    .handout = equation(6)});
}

}  // namespace
}  // namespace tumble::a4_testing
