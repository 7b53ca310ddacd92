// Contact groups (A4.4, A4.5) and callbacks (A4.6).
#include <algorithm>

#include "tests/a4_timewarp/a4_fixtures.h"

namespace tumble::a4_testing {
namespace {

using Groups = std::vector<std::vector<std::int32_t>>;

void expect_groups(const Groups& found, const Groups& expected, const Story& story) {
  expect_true(found == expected, show(expected), show(found), story);
}

TEST(ContactGroups, AreWhoHangsTogether) {
  expect_groups(a4_module().contact_groups(
                    {A, B, C, D, E}, {{C, E, kInfinity}, {A, B, kInfinity}, {B, C, kInfinity}}),
                {{A, B, C, E}, {D}},
                {.scene = "contacts C-E, A-B, B-C among {A, B, C, D, E}",
                 .slip = "A and E hang together through B and C, in whatever order the contacts "
                         "come; D touches nobody and is a group alone",
                 .handout = equation(4)});
}

TEST(ContactGroups, AreNotConnectedByAWall) {
  expect_groups(a4_module().contact_groups(
                    {A, B, C}, {{A, kWall, kInfinity}, {B, kWall, kInfinity}, {B, C, kInfinity}}),
                {{A}, {B, C}},
                {.scene = "A and B lie on one floor, C lies on B",
                 .slip = "a wall connects nobody: it is not among the bodies",
                 .handout = equation(4)});
}

TEST(ContactGroups, KnowBodiesByTheirNumbers) {
  const std::vector<std::int32_t> bodies{7, 12, 100, 4000};
  for (const std::int32_t floor : {-1, 0, 50, 5000})
    expect_groups(a4_module().contact_groups(
                      bodies, {{12, 4000, kInfinity},
                               {std::min(floor, 7), std::max(floor, 7), kInfinity},
                               {std::min(floor, 100), std::max(floor, 100), kInfinity}}),
                  {{7}, {12, 4000}, {100}},
                  {.scene = "bodies 7, 12, 100 and 4000; 12 touches 4000, 7 and 100 lie on wall " +
                            std::to_string(floor),
                   .slip = "the number of a body is not its place in the list, and a wall is "
                           "what is not in it, whatever its number",
                   .handout = equation(4)});
}

TEST(OnGroupCheck, AGroupStaysWhileItsContactsHold) {
  const ScheduledEvent event = group_check({A, B, C}, 1.0, 1.5);
  const GroupDecision found =
      a4_module().on_group_check(event, {{A, B, kInfinity}, {B, C, 1.75}}, 0.125);
  const Story story{
      .scene = "a tower of A, B, C is looked at in [1, 1.5] s; B and C will part at 1.75 s",
      .slip = "what opens later is found by a later check",
      .handout = equation(5)};
  expect_true(!found.changes && found.rollbacks.empty(), "the group stays, nobody goes back",
              std::string(found.changes ? "it changes, " : "it stays, ") + show(found.rollbacks),
              story);
  expect_true(found.groups.empty(), "no groups: nothing changes", show(found.groups), story);
  expect_times(found.next, event, 1.5, 1.625, story);
}

// What opens may be a contact with a wall, and the group stays one; the check may be of a later
// microstep.
TEST(OnGroupCheck, AWallMayBeWhatOpens) {
  ScheduledEvent event = group_check({A, B}, 1.0, 1.5);
  event.stamp.microstep = 3;
  const GroupDecision found =
      a4_module().on_group_check(event, {{A, B, kInfinity}, {B, kWall, 1.25}}, 0.125);
  Stamp opened = event.stamp;
  opened.time = 1.25;
  const Story story{
      .scene =
          "A and B are looked at in [1, 1.5] s, microstep 3; B leaves the wall at 1.25 s, and "
          "A and B touch for ever",
      .slip =
          "a contact with a wall opens, too: all go back to the stamp of the check with the "
          "time of the opening, even where the group stays one",
      .handout = equation(5)};
  expect_true(found.changes, "the group changes", "it stays", story);
  expect_groups(found.groups, {{A, B}}, story);
  expect_rollbacks(found.rollbacks, {back(A, opened), back(B, opened)}, story);
  expect_times(found.next, event, 1.25, 1.25, story);
}

TEST(OnGroupCheck, AGroupSplitsWhereAContactOpens) {
  const ScheduledEvent event = group_check({A, B, C}, 1.0, 1.5);
  const GroupDecision found = a4_module().on_group_check(
      event, {{A, kWall, kInfinity}, {A, B, kInfinity}, {B, C, 1.25}}, 0.125);
  const Stamp split{1.25, 0, WorkKind::kGroup, A, -1};
  const Story story{
      .scene = "a tower of A, B, C on a floor is looked at in [1, 1.5] s; B and C part at 1.25 s",
      .slip =
          "all members go back to where the contact opens, and what it held apart are two groups",
      .handout = equation(5)};
  expect_true(found.changes, "the group changes", "it stays", story);
  expect_groups(found.groups, {{A, B}, {C}}, story);
  expect_rollbacks(found.rollbacks, {back(A, split), back(B, split), back(C, split)}, story);
  expect_times(found.next, event, 1.25, 1.25, story);
}

TEST(OnGroupCheck, OnlyTheFirstOpeningCounts) {
  const GroupDecision found = a4_module().on_group_check(
      group_check({A, B, C, D}, 1.0, 1.5), {{A, B, 1.375}, {B, C, 1.125}, {C, D, 1.25}}, 0.125);
  expect_groups(
      found.groups, {{A, B}, {C, D}},
      {.scene = "a row A, B, C, D is looked at in [1, 1.5] s: B-C opens at 1.125 s, C-D at 1.25 s, "
                "A-B at 1.375 s",
       .slip =
           "after the first opening everything moves otherwise: the later ones may never happen",
       .handout = equation(5)});
  expect_near(found.next.safe_time, 1.125, 0.0, "s (safe time)",
              {.scene = "a row A, B, C, D is looked at in [1, 1.5] s: B-C opens first, at 1.125 s",
               .slip = "the earliest of all, not the first in the list",
               .handout = equation(5)});
}

// ---- Callbacks ---------------------------------------------------------------------------------

TEST(OnCallback, WhoIsLaterComesBack) {
  ScheduledEvent event = callback(A, 0.5);
  event.receivers = {A, B, D};
  const std::vector<LocalTime> local_times{{D, 0.75}, {C, 0.9}, {B, 0.5}, {A, 1.0}};
  const std::vector<Rollback> found = a4_module().on_callback(event, local_times);
  const auto has = [&](std::int32_t body) {
    return std::any_of(found.begin(), found.end(),
                       [&](const Rollback& rollback) { return rollback.body == body; });
  };
  expect_rollbacks(
      found, {back(A, event.stamp), back(D, event.stamp)},
      {.scene = "a callback at 0.5 s is received by A, B, D; local virtual times: A 1 s, B 0.5 s, "
                "C 0.9 s, D 0.75 s",
       .slip =
           has(C) ? "C does not receive it: it is not concerned"
           : has(B)
               ? "B stands at 0.5 s: it has done nothing later, or it is not among the receivers"
               : "receivers later than the callback go back to its stamp, by body",
       .handout = equation(6)});
}

TEST(OnCallback, TimesAreComparedAsTheyAre) {
  const ScheduledEvent event = callback(A, 0.5);
  expect_rollbacks(a4_module().on_callback(event, {{A, just_after(0.5)}}), {back(A, event.stamp)},
                   {.scene = "a callback of A at 0.5 s; A stands one double later",
                    .slip = "a margin: later is later, however little",
                    .handout = equation(6)});
}

}  // namespace
}  // namespace tumble::a4_testing
