// Contact groups under rollback: a hit that is found late rolls back the later changes of a group,
// its split or its formation. Membership is read from the segments that flights name at each
// commit, a thousand times per run; rollbacks from the record of local virtual times.
#include <algorithm>
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "framework/effects/point_force/point_force.h"
#include "tests/engines/event_process_scenes.h"
#include "tests/engines/taught_laws.h"

namespace tumble::testing {
namespace {

using engines::Membership;

// Three blocks fall 2 to 8 cm and rest on each other from t1 = sqrt(2 * 0.08 / 9.81) = 0.1277 s on;
// from 0.35 s on the top one is pulled up, and at t2, when it would not touch the others within two
// steps, it leaves the group.
constexpr double kFused = 0.1277, kPulled = 0.35, kSplit = 0.38, kEnd = 0.6;  // [s]; t2 < kSplit
constexpr int kBlocks[] = {1, 2, 3}, kShot = 4;
constexpr int kFrames = 1000;
constexpr double kShotSpeed = 8.0;  // [m/s]

// The shot's centre stops 0.15 m from the tower's axis, half a block and its own radius.
double way_to_the_tower(double hit_s) { return 0.15 + kShotSpeed * hit_s; }

/// @param hit_s  when the shot hits the middle block; it starts high enough to reach 0.32 m by then
scene::Scene tower(double hit_s) {
  std::vector<scene::BodySpec> bodies{plane("floor", {0, 0, 0}, {0, 0, 1})};
  for (int i = 0; i < 3; ++i)
    bodies.push_back(box("block" + std::to_string(i), {0.1, 0.1, 0.1}, 1.0, {0, 0, 0.12 + 0.23 * i},
                         Vector3d::Zero()));
  bodies.push_back(ball("shot", 0.05, 0.4,
                        {-way_to_the_tower(hit_s), 0, 0.32 + 0.5 * 9.81 * hit_s * hit_s},
                        {kShotSpeed, 0, 0}));
  for (scene::BodySpec& body : bodies) {
    body.restitution = 0.0;
    body.friction = 0.4;
  }
  scene::Scene scene = scene_of(bodies, kEnd, kEarth);
  scene.contact = scene::ContactSpec{};
  scene.effects.of<effects::PointForceSpec>().push_back(
      {"block2", {0, 0, 25.0}, {0, 0, 0.5}, kPulled, 0.1});
  return scene;
}

struct Seen {
  std::vector<Membership> members;  // by frame
  Trajectory run;                   // with virtual times
};

Seen run_and_look(const std::string& engine, const scene::Scene& scene, const Laws& laws,
                  engines::RunOptions options = {}) {
  Seen seen;
  VirtualTimes times;
  TrajectoryRecorder recorder;
  options.engine = engine;
  options.frame_rate_hz = kFrames / kEnd;
  options.timewarp = engines::fast_timewarp(&times);
  options.on_membership = [&](const Membership& membership) { seen.members.push_back(membership); };
  engines::run_scene(scene, laws, options, recorder);
  seen.run = recorder.trajectory();
  if (seen.run.virtual_times.moves.empty()) seen.run.virtual_times = times;
  return seen;
}

const Membership& at(const Seen& seen, double t) {
  return seen.members.at(static_cast<std::size_t>(std::floor(t * kFrames / kEnd)));
}

std::vector<int> blocks_leads(const Membership& membership) {
  std::vector<int> leads;
  for (const int block : kBlocks)
    leads.push_back(membership.first_members[static_cast<std::size_t>(block)]);
  return leads;
}

// Equal at all times; and exactly the members' flights name one segment.
void expect_the_references_members(const Seen& reference, const Seen& seen) {
  EXPECT_EQ(difference(reference.run, seen.run), "");
  ASSERT_GE(reference.members.size(), static_cast<std::size_t>(kFrames));
  ASSERT_EQ(reference.members.size(), seen.members.size());
  for (std::size_t k = 0; k < seen.members.size(); ++k) {
    const Membership& now = seen.members[k];
    ASSERT_EQ(reference.members[k].time, now.time);
    ASSERT_EQ(reference.members[k].first_members, now.first_members) << "at " << now.time << " s";
    for (std::size_t i = 0; i < now.segments.size(); ++i) {
      ASSERT_EQ(reference.members[k].segments[i] < 0, now.segments[i] < 0)
          << "body " << i << " at " << now.time << " s";
      for (std::size_t j = 0; j < i; ++j)
        ASSERT_EQ(now.segments[i] >= 0 && now.segments[i] == now.segments[j],
                  now.first_members[i] == now.first_members[j])
            << "bodies " << i << " and " << j << " at " << now.time << " s";
    }
  }
}

/// Whether a body beyond `from` was rolled back to `to` or earlier, at once or state by state.
bool went_back(const Trajectory& run, int body, double from, double to) {
  const std::vector<std::string>& names = run.virtual_times.processes;
  const int process = static_cast<int>(
      std::find(names.begin(), names.end(), run.bodies[static_cast<std::size_t>(body)].name) -
      names.begin());
  double stood = 0.0;  // before its rollback [s]
  bool is_going_back = false;
  for (const VirtualTimes::Move& move : run.virtual_times.moves) {
    if (move.process != process) continue;
    if (!is_going_back) stood = move.from_s;
    is_going_back = move.to_s <= move.from_s;
    if (is_going_back && stood > from && move.to_s <= to) return true;
  }
  return false;
}

double time_of_hit(const Trajectory& run) {
  for (const Event& event : run.events)
    if (event.kind == EventKind::kCollision && event.body_b == kShot && event.body_a > 0)
      return event.time;
  return kUnset;
}

// A leaked segment or group check would have stopped the run already; here it is counted.
void expect_nothing_leaked(const Seen& reference, const Seen& seen) {
  const auto& counts = seen.run.counters.counts;
  EXPECT_EQ(counts.at("passages_begun"), counts.at("passages_let_go"));
  // with those that were rolled back
  EXPECT_GT(counts.at("passages_begun"), reference.run.counters.counts.at("passages_begun"));
}

/// The shot moves from the start, or a callback turns it towards the tower after all other
/// processes have reached the end.
struct LateShot {
  scene::Scene scene;
  std::vector<engines::Callback> callbacks;
  explicit LateShot(double hit_s) : scene(tower(hit_s)) {
    constexpr double kTurned = 0.004;  // [s]
    scene::BodySpec& shot = scene.bodies[kShot];
    shot.velocity_m_s = Vector3d(-kShotSpeed, 0, 0);
    // so that it has the position of the other variant when it is turned
    shot.position_m.x() += 2 * kShotSpeed * kTurned;
    callbacks = {{kTurned, {kShot}, [](int, RigidBodyState& state) {
                    state.momentum_world.x() = 0.4 * kShotSpeed;
                  }}};
  }
};

/// A check of the shot that finds nothing is due again at `due_s` only; safe times then cover the
/// interval between.
Laws looking_late(double due_s) {
  Laws laws = taught_reference_laws();
  laws.scheduling.on_collision_check = [right = laws.scheduling.on_collision_check, due_s](
                                           const ScheduledEvent& event, const CheckFinding& finding,
                                           double step) {
    CheckDecision decision = right(event, finding, step);
    if (!decision.collides && event.stamp.body_b == kShot && event.stamp.body_a > 0)
      decision.next.stamp.time = std::max(decision.next.stamp.time, due_s);
    return decision;
  };
  return laws;
}

// ---- Hit between fusion and split ------------------------------------------------------------

constexpr double kHitBetween = 0.24;

TEST(TowerOfThree, FusesAndSplitsAsItsTestsSuppose) {
  LateShot missing(kHitBetween);
  const Seen seen = run_and_look("ordered", missing.scene, reference_laws());
  ASSERT_TRUE(std::isnan(time_of_hit(seen.run)));
  // the top one is still falling
  EXPECT_EQ(blocks_leads(at(seen, kFused - 0.002)), (std::vector{1, 1, 3}));
  EXPECT_EQ(blocks_leads(at(seen, kFused + 0.002)), (std::vector{1, 1, 1}));
  EXPECT_EQ(blocks_leads(at(seen, kPulled - 0.002)), (std::vector{1, 1, 1}));
  EXPECT_EQ(blocks_leads(at(seen, kSplit)), (std::vector{1, 1, 3}));
  // s: the block has moved by rounding only
  EXPECT_NEAR(time_of_hit(run_and_look("ordered", tower(kHitBetween), reference_laws()).run),
              kHitBetween, 1e-3);
}

void expect_the_split_was_taken_back(const Seen& seen) {
  for (const int block : kBlocks)
    EXPECT_TRUE(went_back(seen.run, block, kSplit, kHitBetween + 1e-3))
        << "block " << block << ", which had split off by then";
}

TEST(TowerOfThree, WithASplitRolledBackByALateHitHasTheReferencesMembersInTheFastEngine) {
  const LateShot late(kHitBetween);
  engines::RunOptions options;
  options.callbacks = late.callbacks;
  const Seen reference = run_and_look("ordered", late.scene, reference_laws(), options);
  ASSERT_NEAR(time_of_hit(reference.run), kHitBetween, 1e-3);
  options.faults.late_callbacks = true;
  const Seen seen = run_and_look("tw", late.scene, reference_laws(), options);
  expect_the_references_members(reference, seen);
  expect_the_split_was_taken_back(seen);
  expect_nothing_leaked(reference, seen);
}

TEST(TowerOfThree, WithASplitRolledBackByALateHitHasTheReferencesMembersInTheTaughtEngine) {
  const Seen reference = run_and_look("ordered", tower(kHitBetween), taught_reference_laws());
  const Seen seen = run_and_look("tw", tower(kHitBetween), looking_late(0.5));
  expect_the_references_members(reference, seen);
  expect_the_split_was_taken_back(seen);
  expect_nothing_leaked(reference, seen);
}

// ---- Hit before the group formed -------------------------------------------------------------

constexpr double kHitBefore = 0.05;  // s: before any contact

// The blocks were in contact and separated again before the hit was found; after it each is a
// process of its own.
void expect_the_group_was_dissolved(const Seen& reference, const Seen& seen) {
  expect_the_references_members(reference, seen);
  ASSERT_NEAR(time_of_hit(seen.run), kHitBefore, 1e-3);
  constexpr double kBorn = kFused + 1e-4;  // [s]; before it the top block was alone, falling
  for (const int block : kBlocks)
    EXPECT_TRUE(went_back(seen.run, block, kSplit, kBorn)) << "block " << block;
  const Membership& before = at(seen, kHitBefore - 0.005);
  const Membership& after = at(seen, kHitBefore + 0.01);
  for (const Membership* now : {&before, &after}) {
    std::set<int> segments;
    for (const int block : kBlocks) {
      EXPECT_EQ(now->first_members[static_cast<std::size_t>(block)], block)
          << "at " << now->time << " s";
      const int segment = now->segments[static_cast<std::size_t>(block)];
      EXPECT_TRUE(segment < 0 || segments.insert(segment).second)
          << "block " << block << " shares a queue at " << now->time << " s";
    }
  }
  expect_nothing_leaked(reference, seen);
}

TEST(TowerOfThree, HitBelowItsBirthIsDissolvedInTheFastEngine) {
  const LateShot late(kHitBefore);
  engines::RunOptions options;
  options.callbacks = late.callbacks;
  const Seen reference = run_and_look("ordered", late.scene, reference_laws(), options);
  options.faults.late_callbacks = true;
  expect_the_group_was_dissolved(reference,
                                 run_and_look("tw", late.scene, reference_laws(), options));
}

TEST(TowerOfThree, HitBelowItsBirthIsDissolvedInTheTaughtEngine) {
  expect_the_group_was_dissolved(
      run_and_look("ordered", tower(kHitBefore), taught_reference_laws()),
      run_and_look("tw", tower(kHitBefore), looking_late(0.5)));
}

}  // namespace
}  // namespace tumble::testing
