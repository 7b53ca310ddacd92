// Whole scenes by the framework's teaching timewarp with the decisions under test, against the
// ordered run. Every decision takes part, so a wrong one may fail all of these: the tests of each
// decision should pass first.
#include <algorithm>

#include "tests/a4_timewarp/scene_fixtures.h"

namespace tumble::a4_testing {
namespace {

std::uint64_t count(const Trajectory& run, const char* name) {
  return run.counters.counts.at(name);
}

TEST(Scheduler, FindsAnImpactInThePast) {
  const Trajectory run = expect_the_references_trace(
      scene_of({ball("A", {-1, 0, 0}, {1, 0, 0}), ball("B", {0, 0, 0}, {0, 0, 0})}, 2.0, 0.3), 1,
      "A meets B at 0.8 s; the step is 0.3 s");
  expect_true(count(run, "rollbacks") == 2, "two rollbacks: both had gone to 0.9 s",
              std::to_string(count(run, "rollbacks")),
              {.scene = "A meets B at 0.8 s; the step is 0.3 s",
               .slip = "a rollback too many or too few",
               .handout = "handouts/a4_timewarp.md#whole-runs"});
}

TEST(Scheduler, UndoesAnImpactForALateHit) {
  const scene::Scene scene =
      scene_of({ball("A", {-1, 0, 0}, {1.05, 0, 0}), ball("B", {0, 0, 0}, {0, 0, 0}),
                ball("C", {0.05, 1.5, 0}, {0, -2.1, 0})},
               2.0, 0.2);
  const Trajectory run = expect_the_references_trace(
      scene, 2, "A meets B at 0.762 s; then C is found to have met B at 0.622 s (scene late_hit)");
  expect_true(
      count(run, "anti_messages") == 1, "one anti-message",
      std::to_string(count(run, "anti_messages")),
      {.scene = "scene late_hit",
       .slip = "the impact of A and B was worked at before C's was found, and must be taken back",
       .handout = "handouts/a4_timewarp.md#whole-runs"});
}

TEST(Scheduler, HandsABlowAlongARow) {
  std::vector<scene::BodySpec> bodies{wall("left", {-1.5, 0, 0}, {1, 0, 0}),
                                      wall("right", {1.5, 0, 0}, {-1, 0, 0})};
  for (int i = 0; i < 5; ++i)
    bodies.push_back(ball("ball " + std::to_string(i + 1),
                          {-0.8 + 0.3 * i - (i == 0 ? 0.3 : 0.0), 0, 0},
                          {i == 0 ? 2.0 : 0.0, 0, 0}));
  expect_the_references_trace(scene_of(bodies, 5.0, 0.25), 15,
                              "five balls in a row between two walls, the first one moving");
}

TEST(Scheduler, KeepsABoxOfBallsInOrder) {
  expect_the_references_trace(balls_in_a_box(6, 401, 2.5), 15, "six balls in a box");
}

TEST(Scheduler, DoesNotDisturbWhoIsFarAway) {
  // Left: a pair that collides often. Right: a ball without partners.
  std::vector<scene::BodySpec> bodies{
      wall("left", {-0.5, 0, 0}, {1, 0, 0}), ball("A", {-0.2, 0, 0}, {1, 0, 0}),
      ball("B", {0.2, 0, 0}, {-1.3, 0, 0}), ball("lone", {30, 0, 0}, {0, 0.4, 0})};
  const Trajectory run =
      expect_the_references_trace(scene_of(bodies, 3.0, 0.25), 3,
                                  "A and B meet near a wall; 30 m away a lone ball goes its way");
  for (const VirtualTimes::Move& move : run.virtual_times.moves)
    if (move.to_s < move.from_s &&
        run.virtual_times.processes[static_cast<std::size_t>(move.process)] == "lone")
      return expect_true(false, "the lone ball is never rolled back",
                         "it goes back from " + show(move.from_s) + " to " + show(move.to_s) + " s",
                         {.scene = "A and B meet near a wall; 30 m away a lone ball goes its way",
                          .slip = "rollback of everyone: that is what retroactive detection does",
                          .handout = equation(8)});
}

TEST(Scheduler, SplitsAHeapWhereItsContactsOpen) {
  const Trajectory run =
      expect_the_references_trace(heap_of_balls({0.05, 0.02, 0.8}, 0.45), 6,
                                  "a ball drops between two that touch on a floor; they slide "
                                  "apart, and another one falls on them");
  if (!run.stopped_by.empty()) return;
  const auto opened = std::count_if(run.events.begin(), run.events.end(), [](const Event& event) {
    return event.kind == EventKind::kBreak;
  });
  expect_true(opened >= 2, "contacts that open", std::to_string(opened),
              {.scene = "a ball drops between two that touch on a floor; they slide apart, "
                        "and another one falls on them",
               .slip = "contact_groups or on_group_check: the heap did not come apart",
               .handout = equation(5)});
}

TEST(Scheduler, ForgetsWhatIsCertain) {
  const Trajectory run =
      expect_the_references_trace(balls_in_a_box(3, 402, 8.0), 25, "three balls in a box for 8 s");
  // 80 steps per ball and more than as many states of checks and impacts, if nothing were
  // discarded. No check waits longer than ten steps, so at most some 20 states per ball are needed.
  expect_true(count(run, "states_kept") <= 3 * 30, "at most 90 states at any time",
              std::to_string(count(run, "states_kept")),
              {.scene = "three balls in a box for 8 s, steps of 0.1 s",
               .slip = "states_to_purge forgets nothing, or global virtual time lags behind",
               .handout = equation(12)});
}

}  // namespace
}  // namespace tumble::a4_testing
