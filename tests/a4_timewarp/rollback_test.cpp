// The bodies of a rollback and their times (A4.7, A4.8); events after it (A4.9).
#include <algorithm>

#include "tests/a4_timewarp/a4_fixtures.h"

namespace tumble::a4_testing {
namespace {

const Stamp kHit = impact(0.5, A, E);  // the impact that rolls A back in these stories

TEST(AntiMessages, UnsendWhatCameAfter) {
  const std::vector<Effect> effects{effect(0.25, A, B), effect(0.75, A, C), effect(1.0, A, D)};
  expect_rollbacks(a4_module().anti_messages(effects, back(A, kHit)),
                   {back(C, impact(0.75, A, C)), back(D, impact(1.0, A, D))},
                   {.scene = "A hit B at 0.25 s, C at 0.75 s, D at 1 s, and goes back to 0.5 s",
                    .slip = "what A did before 0.5 s stands; what it did later never happened, and "
                            "its partners forget it from where it began",
                    .handout = equation(7)});
  const Stamp split{0.75, 0, WorkKind::kGroup, A, -1}, called{1.0, 0, WorkKind::kCallback, A, -1};
  expect_rollbacks(a4_module().anti_messages({{split, {A, B, C}}, {called, {A, D}}}, back(A, kHit)),
                   {back(B, split), back(C, split), back(D, called)},
                   {.scene = "a group of A, B and C came apart at 0.75 s, a callback at 1 s was "
                             "received by A and D; A goes back to 0.5 s",
                    .slip = "impacts are not all that is unsent: a group's change and a callback "
                            "are effects like others, whatever kind their stamp is of",
                    .handout = equation(7)});
}

TEST(AntiMessages, UnsendWhatHappenedAtTheVeryStamp) {
  expect_rollbacks(
      a4_module().anti_messages({effect(0.5, A, B), effect(0.5, A, C), effect(0.75, A, D)},
                                back(A, impact(0.5, A, C))),
      {back(C, impact(0.5, A, C)), back(D, impact(0.75, A, D))},
      {.scene = "A hit B and C, both at 0.5 s, and D at 0.75 s; it goes back to its impact with C",
       .slip = "'at the stamp and later' in the order of stamps, not of times: the impact with B "
               "comes before, that with C is undone itself",
       .handout = equation(7)});
}

TEST(AntiMessages, GoToPartnersOnly) {
  const std::vector<Effect> effects{effect(0.75, B, C), effect(0.75, A, kWall, {A}),
                                    effect(1.0, A, D), effect(1.25, D, E)};
  expect_rollbacks(a4_module().anti_messages(effects, back(A, kHit)), {back(D, impact(1.0, A, D))},
                   {.scene = "B hit C at 0.75 s, A the wall at 0.75 s, A hit D at 1 s, D hit E at "
                             "1.25 s; A goes back to 0.5 s",
                    .slip = "impacts without A are not A's to unsend, walls get no messages, and "
                            "what D did is for D to unsend",
                    .handout = equation(7)});
}

TEST(PlanRollback, FollowsTheChain) {
  const std::vector<Effect> effects{effect(0.75, A, B), effect(1.0, B, C), effect(1.25, C, D)};
  expect_rollbacks(
      a4_module().plan_rollback(effects, {back(A, kHit)}),
      {back(A, kHit), back(B, impact(0.75, A, B)), back(C, impact(1.0, B, C)),
       back(D, impact(1.25, C, D))},
      {.scene =
           "A hit B at 0.75 s, then B hit C at 1 s, then C hit D at 1.25 s; A goes back to 0.5 s",
       .slip = "a forgotten anti-message: a body that goes back unsends in turn, each only as far "
               "as the message that reached it",
       .handout = equation(8)});
}

TEST(PlanRollback, LeavesAloneWhomNothingReaches) {
  const std::vector<Effect> effects{effect(0.25, A, B), effect(0.75, A, kWall, {A}),
                                    effect(0.875, C, kWall, {C}), effect(1.0, C, D),
                                    effect(1.25, B, E)};
  expect_rollbacks(a4_module().plan_rollback(effects, {back(A, impact(0.5, A, D))}),
                   {back(A, impact(0.5, A, D))},
                   {.scene = "A hit B at 0.25 s and the wall at 0.75 s; C hit the wall at 0.875 s "
                             "and D at 1 s; B hit E at 1.25 s. A goes back to 0.5 s",
                    .slip = "rollback of everyone: only chains of effects after the rollback "
                            "count; the wall conducts nothing",
                    .handout = equation(8)});
}

TEST(PlanRollback, TheEarliestMessageCounts) {
  const std::vector<Effect> effects{effect(0.75, A, B), effect(1.0, A, C), effect(0.875, B, C)};
  expect_rollbacks(
      a4_module().plan_rollback(effects, {back(A, kHit)}),
      {back(A, kHit), back(B, impact(0.75, A, B)), back(C, impact(0.875, B, C))},
      {.scene =
           "A hit B at 0.75 s and C at 1 s; in between, at 0.875 s, B hit C. A goes back to 0.5 s",
       .slip = "C is told twice, and goes back to the earlier of the two; a body that was reached "
               "once may be reached again, deeper",
       .handout = equation(8)});
}

TEST(PlanRollback, ADeeperMessageIsFollowedAgain) {
  // C is rolled back first to 1.25 (no effect of it after that), then to 0.75, which includes its
  // impact with D.
  std::vector<Effect> effects{effect(1.25, A, C), effect(1.0, C, D), effect(0.75, B, C),
                              effect(0.625, A, B)};
  // in any order
  for (int order = 0; order < 2; ++order, std::reverse(effects.begin(), effects.end()))
    expect_rollbacks(
        a4_module().plan_rollback(effects, {back(A, kHit)}),
        {back(A, kHit), back(B, impact(0.625, A, B)), back(C, impact(0.75, B, C)),
         back(D, impact(1.0, C, D))},
        {.scene = "A hit B at 0.625 s, B hit C at 0.75 s, C hit D at 1 s, A hit C at 1.25 s. A "
                  "goes back to 0.5 s",
         .slip = "C is reached at 1.25 s and then deeper, at 0.75 s: only the deeper one reaches D",
         .handout = equation(8)});
}

TEST(PlanRollback, TakesSeveralRollbacksAtOnce) {
  const Stamp meeting = impact(0.5, A, B);
  const std::vector<Effect> effects{effect(0.75, B, C), effect(0.25, B, D)};
  expect_rollbacks(a4_module().plan_rollback(
                       effects, {back(B, meeting), back(A, meeting), back(B, impact(0.625, B, E))}),
                   {back(A, meeting), back(B, meeting), back(C, impact(0.75, B, C))},
                   {.scene = "B hit D at 0.25 s and C at 0.75 s; A and B go back to 0.5 s, and B "
                             "is told 0.625 s as well",
                    .slip = "each body once, to the earliest of its stamps, by body",
                    .handout = equation(8)});
}

// ---- Events after a rollback -------------------------------------------------------------------

const ScheduledEvent kCheck = collision_check(A, B, 0.5, 0.75);

void expect_after(const ScheduledEvent& event, const std::vector<Rollback>& rollbacks,
                  double safe_time, double time, const std::string& what, const std::string& slip) {
  expect_times(a4_module().after_rollback(event, rollbacks), event, safe_time, time,
               {.scene = show(event) + "; " + what, .slip = slip, .handout = equation(9)});
}

TEST(AfterRollback, BeforeTheSafeTimeTheCheckMovesThere) {
  expect_after(kCheck, {back(B, impact(0.25, B, C))}, 0.25, 0.25, "B goes back to 0.25 s",
               "A and B were verified disjoint on a motion that is undone: from 0.25 s on they "
               "must be looked at again");
  expect_after(
      kCheck,
      {back(A, impact(0.375, A, C)), back(B, impact(0.25, B, C)), back(D, impact(0.125, C, D))},
      0.25, 0.25, "A goes back to 0.375 s, B to 0.25 s, D to 0.125 s",
      "the earliest of its receivers counts; D is none");
}

TEST(AfterRollback, FromTheSafeTimeOnTheCheckStays) {
  // otherwise a function that never moves a check would pass
  expect_after(kCheck, {back(A, impact(0.25, A, C))}, 0.25, 0.25, "A goes back to 0.25 s",
               "before the safe time the check moves");
  const std::string slip = "[safe, time] has yet to be looked at, on whatever motion there is then";
  expect_after(kCheck, {back(A, impact(0.5, A, C))}, 0.5, 0.75,
               "A goes back to 0.5 s, its safe time", slip);
  expect_after(kCheck, {back(A, impact(0.625, A, C))}, 0.5, 0.75,
               "A goes back to 0.625 s, between safe time and time", slip);
  expect_after(kCheck, {back(A, impact(0.875, A, C))}, 0.5, 0.75, "A goes back to 0.875 s", slip);
  expect_after(kCheck, {back(C, impact(0.25, C, D))}, 0.5, 0.75, "C goes back to 0.25 s",
               "C does not receive it");
}

TEST(AfterRollback, TimesAreComparedAsTheyAre) {
  const double earlier = just_before(0.5);
  expect_after(kCheck, {back(A, impact(earlier, A, C))}, earlier, earlier,
               "A goes back to one double before its safe time",
               "a margin: what was verified on a motion that is undone is no longer so, however "
               "little of it");
}

TEST(AfterRollback, MovesNothingElse) {
  expect_after(group_check({A, B, C}, 0.5, 0.75), {back(C, impact(0.25, C, D))}, 0.25, 0.25,
               "C goes back to 0.25 s", "a group check moves like a check of a pair");
  expect_after(callback(A, 0.5), {back(A, impact(0.25, A, C))}, 0.5, 0.5, "A goes back to 0.25 s",
               "a callback happens at its own time: it was not verified, it is due");
  expect_after(redraw(0.5), {back(A, impact(0.25, A, C))}, kInfinity, 0.5, "A goes back to 0.25 s",
               "a frame is drawn at its own time");
}

}  // namespace
}  // namespace tumble::a4_testing
