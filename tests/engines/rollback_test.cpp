// A rolled-back state is as if its future had never been computed: states, groups, events and the
// cells of the grid, to the last byte; and the final committed trace is the reference's.
#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include "framework/core/random.h"
#include "framework/engines/timewarp/taught_logical_process.h"
#include "tests/engines/event_process_scenes.h"
#include "tests/engines/reference_laws.h"

namespace tumble::testing::rollback_test {
namespace {

using engines::RollbackCheck;
using engines::StateSnapshot;

const Laws& laws() {
  static const Laws reference = reference_laws();
  return reference;
}

/// The first difference of two byte sequences, in words; empty: none.
std::string parting(const char* what, const std::string& before, const std::string& after) {
  if (before == after) return "";
  const auto at = std::mismatch(before.begin(), before.end(), after.begin(), after.end()).first -
                  before.begin();
  return std::string(what) + ": " + std::to_string(before.size()) + " and " +
         std::to_string(after.size()) + " bytes, the first that differs is " + std::to_string(at) +
         "; ";
}

/// The injections of one run.
struct Trials {
  std::set<int> steps;
  int count = 0;
  std::string first_difference;
  Trajectory run;
};

Trials roll_back_in(const scene::Scene& scene, int every, int threads, int first,
                    const std::vector<engines::Callback>& callbacks = {}, int most_steps = 50) {
  Trials trials;
  RollbackCheck watch;
  watch.every = every;
  watch.first = first;
  watch.most_steps = most_steps;
  watch.report = [&](double t, int steps, const StateSnapshot& before, const StateSnapshot& after) {
    ++trials.count;
    trials.steps.insert(steps);
    const std::string difference = parting("states", before.states, after.states) +
                                   parting("groups", before.groups, after.groups) +
                                   parting("events", before.events, after.events) +
                                   parting("cells", before.cells, after.cells);
    if (trials.first_difference.empty() && !difference.empty())
      trials.first_difference = "back to " + std::to_string(t) + " s after " +
                                std::to_string(steps) + " steps: " + difference;
  };
  TrajectoryRecorder recorder;
  engines::RunOptions options;
  options.engine = "tw";
  options.timewarp = engines::fast_timewarp(nullptr, &watch);
  options.threads = threads;
  options.callbacks = callbacks;
  engines::run_scene(scene, laws(), options, recorder);
  trials.run = recorder.trajectory();
  return trials;
}

void expect_as_if_it_had_never_been(const scene::Scene& scene, int every, int least_trials,
                                    const std::vector<engines::Callback>& callbacks = {}) {
  TrajectoryRecorder reference;
  engines::RunOptions options;
  options.engine = "ordered";
  options.callbacks = callbacks;
  engines::run_scene(scene, laws(), options, reference);
  for (const int threads : {1, 2}) {
    // steps, or epochs of some steps each
    const Trials trials = roll_back_in(scene, threads == 1 ? every : 1, threads, 20, callbacks,
                                       threads == 1 ? 50 : 7);
    EXPECT_EQ(trials.first_difference, "") << scene.name << ", " << threads << " threads";
    EXPECT_EQ(difference(reference.trajectory(), trials.run), "")
        << scene.name << ", " << threads << " threads";
    EXPECT_GE(trials.count, threads == 1 ? least_trials : 2)
        << scene.name << ", " << threads << " threads";
    EXPECT_GT(trials.steps.size(), 1U) << scene.name;  // long and short
  }
}

/// In several runs, each continuing the sequence of lengths of the last; an injection that the end
/// of the run cuts short counts with the steps it took.
void expect_every_length_from_one_to_fifty(const scene::Scene& scene, int every, int threads) {
  constexpr int kMostRuns = 20, kStride = 17;  // of the check: from one length to the next
  std::set<int> all_steps;
  int tried = 0;
  for (int k = 0; k < kMostRuns && all_steps.size() < 50; ++k) {
    const Trials trials = roll_back_in(scene, every, threads, kStride * tried % 50);
    ASSERT_EQ(trials.first_difference, "")
        << scene.name << ", " << threads << " threads, run " << k;
    all_steps.insert(trials.steps.begin(), trials.steps.end());
    tried += std::max(1, trials.count - 1);  // the last may have been cut
  }
  for (int steps = 1; steps <= 50; ++steps)
    EXPECT_TRUE(all_steps.contains(steps))
        << scene.name << ", " << threads << " threads: never " << steps << " steps";
}

TEST(RollbackRestore, LeavesNoByteOfBallsChangedAfterOneToFiftySteps) {
  const scene::Scene scene = sized("gas", 60, 2.0);
  expect_as_if_it_had_never_been(scene, 100, 10);
  expect_every_length_from_one_to_fifty(sized("gas", 60, 10.0), 400, 1);
  expect_every_length_from_one_to_fifty(sized("gas", 60, 30.0), 1, 2);  // epochs
}

TEST(RollbackRestore, LeavesNoByteOfTumblingSolidsChanged) {
  expect_as_if_it_had_never_been(sized("atoms", 30, 0.6), 60, 5);
}

// Towers fuse and split between the two times: groups and the flights of the events that changed
// them are restored.
TEST(RollbackRestore, LeavesNoByteOfGroupsInContactChanged) {
  expect_as_if_it_had_never_been(tower_and_projectile(5.0), 12, 10);
  expect_as_if_it_had_never_been(sized("avalanche", 12, 0.5), 100, 5);
}

// Rocks that roll over each other: in a tower at rest little happens in so many steps.
TEST(RollbackRestore, LeavesNoByteOfGroupsChangedAfterOneToFiftySteps) {
  for (const int threads : {1, 2})
    expect_every_length_from_one_to_fifty(sized("avalanche", 8, 1.5), threads == 1 ? 120 : 10,
                                          threads);
}

TEST(RollbackRestore, LeavesNoByteOfLinkedBodiesChangedAfterOneToFiftySteps) {
  for (const int threads : {1, 2})
    expect_every_length_from_one_to_fifty(pendula_and_balls(5, 5.0), threads == 1 ? 60 : 5,
                                          threads);
}

TEST(RollbackRestore, LeavesNoByteOfLinkedBodiesChanged) {
  expect_as_if_it_had_never_been(pendula_and_balls(5, 0.8), 25, 10);
  expect_as_if_it_had_never_been(sized("robots", 1, 0.3), 30, 2);
}

// A callback that was executed and rolled back is pending again.
TEST(RollbackRestore, LeavesCallbacksAsTheyWere) {
  const std::vector<engines::Callback> callbacks{
      {0.25, {0, 1, 4}, [](int, RigidBodyState& state) { state.momentum_world.y() += 0.3; }},
      {0.5, {2}, [](int, RigidBodyState& state) { state.momentum_world.x() -= 0.2; }}};
  expect_as_if_it_had_never_been(pendula_and_balls(4, 0.8), 28, 8, callbacks);
}

// The snapshot is detailed enough to differ between two times.
TEST(RollbackRestore, WouldShowADifference) {
  std::vector<StateSnapshot> seen;
  RollbackCheck watch;
  watch.every = 20;
  watch.report = [&](double, int, const StateSnapshot& before, const StateSnapshot&) {
    seen.push_back(before);
  };
  TrajectoryRecorder recorder;
  engines::RunOptions options;
  options.engine = "tw";
  options.timewarp = engines::fast_timewarp(nullptr, &watch);
  engines::run_scene(tower_and_projectile(5.0), laws(), options, recorder);
  ASSERT_GE(seen.size(), 3U);
  for (std::size_t k = 1; k < seen.size(); ++k) {
    EXPECT_NE(seen[k - 1].states, seen[k].states);
    EXPECT_NE(seen[k - 1].events, seen[k].events);
    EXPECT_NE(seen[k - 1].cells, seen[k].cells);
  }
  EXPECT_NE(seen.front().groups, seen.back().groups);
}

// The box of the teaching timewarp: six heaps, whose removed entries are deleted when they reach
// the top.
// Boxes of a body at rest, in uniform motion, and in an oscillation; global virtual time leaves
// three at a time.
TEST(SweptBox, KeepsNoMoreThanTwiceWhatIsThereHoweverManyStepsHavePassed) {
  const auto speeds = {Vector3d(0, 0, 0), Vector3d(0.5, -0.25, 0), Vector3d(1, 2, -3)};
  for (const Vector3d& speed : speeds) {
    engines::SweptBox swept;
    Vector3d middle = Vector3d::Zero();
    for (std::uint64_t id = 0; id < 10'000; ++id) {
      if (id >= 3) swept.remove(id - 3);
      middle += (speed.x() == 1.0 && id % 200 >= 100 ? -1.0 : 1.0) * speed;
      swept.add(id, {middle - Vector3d::Ones(), middle + Vector3d::Ones()});
      ASSERT_LE(swept.kept(), 2 * std::min<std::size_t>(id + 1, 3) + 16)
          << "step " << id << " at " << speed.transpose() << " m a step";
      if (id % 7 == 0) {  // and the box encloses the last three
        const engines::Box box = swept.box();
        ASSERT_TRUE((box.low.array() <= middle.array() - 1).all() &&
                    (box.high.array() >= middle.array() + 1).all());
        ASSERT_LE((box.high - box.low - Vector3d::Constant(2)).cwiseAbs().maxCoeff(),
                  2 * speed.cwiseAbs().maxCoeff());
      }
    }
  }
}

TEST(SweptBox, IsTheSameBytesAfterOneToFiftyStepsAndARollback) {
  Random random(11);
  const auto any_box = [&] {
    const Vector3d low(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1));
    return engines::Box{low, low + Vector3d::Constant(random.between(0.1, 1.0))};
  };
  for (int steps = 1; steps <= 50; ++steps) {
    engines::SweptBox swept;
    std::uint64_t id = 0;
    for (int k = 0; k < 5; ++k) swept.add(id++, any_box());
    const engines::Box before = swept.box();
    for (int k = 0; k < steps; ++k) {
      swept.add(id++, any_box());
      if (k % 7 == 0) swept.box();
    }
    for (int k = 0; k < steps; ++k) swept.remove(--id);
    const engines::Box after = swept.box();
    EXPECT_TRUE(before.low == after.low && before.high == after.high) << steps << " steps";
  }
}

}  // namespace
}  // namespace tumble::testing::rollback_test
