// Global virtual time (A4.10), commits up to it (A4.11), and fossil collection before it (A4.12).
#include <algorithm>

#include "tests/a4_timewarp/a4_fixtures.h"

namespace tumble::a4_testing {
namespace {

void expect_gvt(const std::vector<LocalTime>& local_times,
                const std::vector<ScheduledEvent>& events, double expected,
                const std::string& scene, const std::string& slip) {
  const double found = a4_module().global_virtual_time(local_times, events);
  expect_true(found == expected, show(expected) + " s", show(found) + " s",
              {.scene = scene, .slip = slip, .handout = equation(10)});
}

TEST(GlobalVirtualTime, IsTheLeastLocalTime) {
  expect_gvt({{A, 0.75}, {B, 0.5}, {C, 1.0}}, {collision_check(A, C, 0.625, 0.875)}, 0.5,
             "local times A 0.75 s, B 0.5 s, C 1 s; a check with safe time 0.625 s",
             "the least of all: B may still do anything from 0.5 s on");
}

TEST(GlobalVirtualTime, IsHeldBackBySafeTimes) {
  expect_gvt({{A, 0.75}, {B, 0.5}, {C, 1.0}},
             {collision_check(A, C, 0.625, 0.875), collision_check(A, B, 0.25, 0.75)}, 0.25,
             "local times A 0.75 s, B 0.5 s, C 1 s; checks with safe times 0.625 and 0.25 s",
             "without safe times: the check of A and B may find an impact at 0.25 s, in the past "
             "of all three");
}

TEST(GlobalVirtualTime, ACallbackHoldsItBackARedrawDoesNot) {
  expect_gvt({{A, 1.0}, {B, 1.25}}, {redraw(0.5), callback(A, 0.75)}, 0.75,
             "local times A 1 s, B 1.25 s; a redraw at 0.5 s, a callback at 0.75 s",
             "safe times, not times: a redraw changes nothing, its safe time is infinite");
}

TEST(GlobalVirtualTime, IsInfiniteWhereNothingIsLeft) {
  expect_gvt({{A, 0.5}}, {}, 0.5, "one process at 0.5 s, no event", "the least local time");
  expect_gvt({}, {}, kInfinity, "neither process nor event",
             "the least of nothing is infinite, not 0 and not the largest number you can think of");
}

TEST(MayCommit, WhatIsEarlierThanGlobalVirtualTime) {
  const Story story{.scene = "global virtual time is 0.5 s",
                    .slip =
                        "what is earlier is certain, what is later is not: a frame shown too early "
                        "cannot be taken back",
                    .handout = equation(11)};
  expect_true(a4_module().may_commit(impact(0.375, A, B), 0.5),
              "the impact at 0.375 s may be committed", "it may not", story);
  expect_true(!a4_module().may_commit(impact(0.625, A, B), 0.5), "the impact at 0.625 s may not",
              "it may", story);
  expect_true(a4_module().may_commit(redraw(0.25).stamp, 0.5), "the frame of 0.25 s may be shown",
              "it may not", story);
  expect_true(!a4_module().may_commit(redraw(0.75).stamp, 0.5), "the frame of 0.75 s may not",
              "it may", story);
}

TEST(MayCommit, NothingAtGlobalVirtualTimeItself) {
  const Story story{.scene = "global virtual time is 0.5 s",
                    .slip = "< and not <=: at 0.5 s itself something may yet come before it",
                    .handout = equation(11)};
  expect_true(!a4_module().may_commit(impact(0.5, A, B), 0.5),
              "the impact at 0.5 s may not be committed", "it may", story);
  expect_true(!a4_module().may_commit(redraw(0.5).stamp, 0.5),
              "the frame of 0.5 s may not be shown", "it may", story);
  expect_true(a4_module().may_commit(redraw(0.5).stamp, kInfinity),
              "when nothing is left to happen it may be shown", "it may not", story);
}

TEST(MayCommit, TimesAreComparedAsTheyAre) {
  const Story story{
      .scene = "global virtual time is 0.5 s; an impact one double before it, and one after",
      .slip = "a margin: what is earlier is certain, however little",
      .handout = equation(11)};
  expect_true(a4_module().may_commit(impact(just_before(0.5), A, B), 0.5),
              "the first may be committed", "it may not", story);
  expect_true(!a4_module().may_commit(impact(just_after(0.5), A, B), 0.5), "the second may not",
              "it may", story);
}

void expect_purged(const std::vector<double>& times, double gvt, std::uint32_t expected,
                   const std::string& slip) {
  std::string list;
  for (const double time : times) list += (list.empty() ? "" : ", ") + show(time);
  const std::uint32_t found = a4_module().states_to_purge(times, gvt);
  expect_true(
      found == expected, std::to_string(expected) + " of them", std::to_string(found),
      {.scene = "states at " + list + " s; global virtual time is " + show(gvt) + " s",
       .slip =
           found < expected ? "forgets too little: memory grows with the length of the run" : slip,
       .handout = equation(12)});
}

TEST(StatesToPurge, KeepsTheLastOneBeforeGlobalVirtualTime) {
  const std::string slip =
      "purged too early: a body that goes back to global virtual time starts from the last state "
      "before it";
  expect_purged({0.0, 0.125, 0.25, 0.375, 0.5}, 0.3, 2, slip);
  expect_purged({0.0, 0.125, 0.25, 0.375, 0.5}, 0.45, 3, slip);
}

TEST(StatesToPurge, AStateAtGlobalVirtualTimeMayBeUndone) {
  const std::string slip =
      "purged too early: the state at global virtual time may be what an impact made that is still "
      "taken back";
  expect_purged({0.0, 0.125, 0.25, 0.375}, 0.25, 1, slip);
  expect_purged({0.0, 0.125, 0.25, 0.25, 0.25}, 0.25, 1, slip);
}

TEST(StatesToPurge, LeavesOneAlways) {
  expect_purged({0.0, 0.125, 0.25}, 1.0, 2,
                "all of them are old, and the last is where the body goes on from");
  expect_purged({0.0, 0.125, 0.25}, kInfinity, 2,
                "all of them are old, and the last is where the body goes on from");
  expect_purged({0.5, 0.625}, 0.5, 0, "no state is earlier: there is nothing to forget");
}

TEST(StatesToPurge, TimesAreComparedAsTheyAre) {
  const double gvt = 0.25;
  const std::uint32_t found =
      a4_module().states_to_purge({0.0, 0.125, just_before(gvt), just_after(gvt)}, gvt);
  expect_true(found == 2, "2 of them", std::to_string(found),
              {.scene = "states at 0, 0.125 s, one double before 0.25 s and one after; global "
                        "virtual time is 0.25 s",
               .slip = "a margin: a state that is earlier is the last one before global virtual "
                       "time, however little it is earlier",
               .handout = equation(12)});
}

// Two calls of each function in one process: the first fills a static variable, which makes the
// second wrong.
TEST(Decisions, KeepNothingBetweenCalls) {
  const auto expect_kept = [](bool first_is_right, bool second_is_right,
                              const std::string& function, int number) {
    expect_true(first_is_right && second_is_right, "two right answers",
                !first_is_right ? "the first is wrong" : "the first is right, the second is wrong",
                {.scene = "two calls of " + function + ", each with other data",
                 .slip = first_is_right ? kKept : function + " itself: see its own tests",
                 .handout = equation(number)});
  };
  using Groups = std::vector<std::vector<std::int32_t>>;
  const Groups first = a4_module().contact_groups({A, B, C}, {{A, B, kInfinity}}),
               second = a4_module().contact_groups({A, B, C}, {{B, C, kInfinity}});
  expect_kept(first == Groups{{A, B}, {C}}, second == Groups{{A}, {B, C}}, "contact_groups", 4);
  const auto plan = [](std::int32_t body, double time) {
    return a4_module().plan_rollback({effect(0.75, B, C)}, {back(body, impact(time, D, E))});
  };
  const std::vector<Rollback> one = plan(A, 0.25), two = plan(B, 0.5);
  const auto is = [](const std::vector<Rollback>& found, const std::vector<Rollback>& expected) {
    return found.size() == expected.size() &&
           std::equal(found.begin(), found.end(), expected.begin(),
                      [](const Rollback& x, const Rollback& y) { return same(x, y); });
  };
  expect_kept(is(one, {back(A, impact(0.25, D, E))}),
              is(two, {back(B, impact(0.5, D, E)), back(C, impact(0.75, B, C))}), "plan_rollback",
              8);
  const double early = a4_module().global_virtual_time({{A, 0.25}}, {}),
               late = a4_module().global_virtual_time({{A, 0.75}}, {});
  expect_kept(early == 0.25, late == 0.75, "global_virtual_time", 10);
  const double near = a4_module().next_check_time(2.0, 1.0, 2.0, 0.0, 0.125),
               later = a4_module().next_check_time(4.0, 1.0, 1.0, 0.0, 0.125);
  expect_kept(near == 2.5, later == 5.0, "next_check_time", 2);
}

}  // namespace
}  // namespace tumble::a4_testing
