// Linked bodies, bodies under forces and bodies in persistent contact are logical processes: every
// event-driven engine commits the same trace of them, in any order of execution, and agrees with a
// world of all bodies.
#include <algorithm>
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "tests/support/places.h"
#include "framework/core/cpu_time.h"
#include "framework/core/error.h"
#include "framework/engines/events/flight_world.h"
#include "framework/truths/memory_scene.h"
#include "tests/engines/event_process_scenes.h"
#include "tests/engines/reference_laws.h"
#include "tests/support/whole.h"

namespace tumble::testing {
namespace {

using engines::FaultInjection;

const Laws& laws() {
  static const Laws reference = reference_laws();
  return reference;
}

Trajectory run_with(const std::string& engine, const scene::Scene& scene,
                    const FaultInjection& faults = {}) {
  return run_by(engine, scene, faults, 60.0, laws());
}

scene::Scene course_scene(const std::string& name, double duration) {
  scene::Scene scene = scene::load_scene(std::filesystem::path(test::source_dir()) /
                                         "assignments/a3_constraints/scenes" / (name + ".json"));
  scene.duration_s = std::min(scene.duration_s, duration);
  return scene;
}

void expect_one_trace(const scene::Scene& scene, std::size_t least) {
  const Trajectory reference = run_with("ordered", scene);
  ASSERT_EQ(reference.stopped_by, "");
  ASSERT_GE(reference.events.size(), least);
  for (const char* engine : {"tw", "ca"})
    EXPECT_EQ(difference(reference, run_with(engine, scene)), "") << engine;
}

// ---- One trace ---------------------------------------------------------------------------------

TEST(LogicalProcesses, LinkedInTheCoursesScenesCommitTheReferencesTrace) {
  expect_one_trace(course_scene("newtons_cradle", 1.0), 4);
  expect_one_trace(course_scene("newtons_cradle_springs", 1.0), 4);
  expect_one_trace(course_scene("robot_arm", 0.5), 0);
}

TEST(LogicalProcesses, InPersistentContactInTheCoursesScenesCommitTheReferencesTrace) {
  expect_one_trace(course_scene("drop_a_box", 1.5), 4);
  expect_one_trace(course_scene("dropped_on_a_hung_block", 0.6), 30);
  expect_one_trace(course_scene("card_tent", 0.8), 4);
  expect_one_trace(course_scene("bounce_to_rolling", 1.0), 4);
  const scene::Scene dominoes = course_scene("dominoes", 0.4);
  EXPECT_EQ(difference(run_with("ordered", dominoes), run_with("tw", dominoes)), "");
}

TEST(LogicalProcesses, AmongFreeBodiesCommitTheReferencesTrace) {
  expect_one_trace(pendula_and_balls(6, 1.2), 15);
  expect_one_trace(tower_and_projectile(5.0), 15);
}

// ---- Adversarial orders ----------------------------------------------------------------------

void expect_hard_orders_change_nothing(const scene::Scene& scene, int seeds) {
  const Trajectory reference = run_with("ordered", scene);
  std::uint64_t rollbacks = 0, anti_messages = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    const Trajectory run =
        run_with("tw", scene, {static_cast<std::uint64_t>(seed), true, 0.15, 5, 0.05});
    ASSERT_EQ(difference(reference, run), "") << "seed " << seed;
    rollbacks += run.counters.counts.at("rollbacks");
    anti_messages += run.counters.counts.at("anti_messages");
  }
  EXPECT_GT(rollbacks, static_cast<std::uint64_t>(5 * seeds));
  EXPECT_GT(anti_messages, static_cast<std::uint64_t>(seeds));
}

TEST(AdversarialOrderOfProcesses, LeavesLinkedBodiesTraceAsItIs) {
  expect_hard_orders_change_nothing(pendula_and_balls(5, 0.9), 20);
}

// Towers fuse, are hit, come apart, and all of it is rolled back repeatedly, also to times before a
// group formed.
TEST(AdversarialOrderOfProcesses, LeavesGroupsInContactAsTheyAre) {
  expect_hard_orders_change_nothing(tower_and_projectile(5.0), 20);
}

// ---- Groups that fuse and split --------------------------------------------------------------

/// Pairs in persistent contact at a time, from a run's events.
std::set<std::pair<int, int>> together(const Trajectory& run, double t) {
  std::set<std::pair<int, int>> pairs;
  for (const Event& event : run.events) {
    if (event.time > t) break;
    if (event.kind == EventKind::kContact) pairs.insert({event.body_a, event.body_b});
    if (event.kind == EventKind::kBreak) pairs.erase({event.body_a, event.body_b});
  }
  return pairs;
}

Trajectory run_on(int threads, const scene::Scene& scene) {
  TrajectoryRecorder recorder;
  engines::RunOptions options;
  options.engine = "tw";
  options.timewarp = engines::fast_timewarp();
  options.threads = threads;
  options.faults.delay_s = 1e-5;
  engines::run_scene(scene, laws(), options, recorder);
  return recorder.trajectory();
}

// The tower fuses block by block; the shot hits it while it stands, and is found late. A leaked
// segment or change would stop the run.
TEST(ContactGroup, ThatSplitsUnderRollbackHasTheReferencesMembersAtAllTimes) {
  const scene::Scene scene = tower_and_projectile(5.0);
  const Trajectory reference = run_with("ordered", scene);
  for (const Trajectory& run :
       {run_with("tw", scene, {7, true, 0.3, 4, 0.2}), run_on(2, scene), run_on(4, scene)}) {
    std::size_t most = 0, least = 100;
    for (int k = 0; k <= 1000; ++k) {
      const double t = scene.duration_s * k / 1000;
      const auto expected = together(reference, t);
      ASSERT_EQ(expected, together(run, t)) << "at " << t;
      most = std::max(most, expected.size());
      if (t > 0.5) least = std::min(least, expected.size());
    }
    EXPECT_EQ(difference(reference, run), "");
    EXPECT_GE(most, 3U);     // it stood
    EXPECT_LT(least, most);  // and came apart
  }
}

TEST(LogicalProcesses, OnSeveralThreadsCommitTheReferencesTrace) {
  for (const auto& [scene, least] : {std::pair{pendula_and_balls(8, 0.8), 10},
                                     {sized("avalanche", 24, 0.5), 20},
                                     {sized("cars", 8, 0.1), 0}}) {
    const Trajectory reference = run_with("ordered", scene);
    ASSERT_GE(reference.events.size(), static_cast<std::size_t>(least)) << scene.name;
    for (const int threads : {2, 4})
      EXPECT_EQ(difference(reference, run_on(threads, scene)), "")
          << scene.name << ", " << threads << " threads";
  }
}

// ---- Bounds ------------------------------------------------------------------------------------

// For rocks a body's history of flights would grow too long; for bobs, which swing on one flight,
// the steps of their segments.
TEST(CapOfStates, OfEightIsKeptByProcessesAndChangesNothing) {
  TUMBLE_ONLY_WHOLE();
  for (const scene::Scene& scene : {sized("avalanche", 24, 2.5), pendula_and_balls(5, 0.9)}) {
    const Trajectory reference = run_with("ordered", scene);
    ASSERT_EQ(reference.stopped_by, "") << scene.name;
    const auto run_capped = [&](int threads, int most_states) {
      engines::RunOptions options;
      options.engine = "tw";
      options.threads = threads;
      options.most_states = most_states;
      // random order up to a second ahead of global virtual time
      if (threads == 1) options.faults = {3, true, 1.0, 0, 0.0};
      return run_as_told(std::move(options), scene, laws());
    };
    const Trajectory free = run_capped(1, 0);
    EXPECT_EQ(difference(reference, free), "") << scene.name;
    if (scene.name == "avalanche") {
      EXPECT_GT(free.counters.counts.at("most_states_of_a_body"), 8U);
    }
    for (const int threads : {1, 2}) {
      const Trajectory capped = run_capped(threads, 8);
      EXPECT_EQ(difference(reference, capped), "") << scene.name << ", " << threads << " threads";
      EXPECT_GT(capped.counters.counts.at("held_back"), 0U)
          << scene.name << ", " << threads << " threads";
      EXPECT_LE(capped.counters.counts.at("most_states_of_a_body"), 8U)
          << scene.name << ", " << threads << " threads";
    }
  }
}

// ---- Callbacks ---------------------------------------------------------------------------------

Trajectory run_with_callbacks(const std::string& engine, const scene::Scene& scene,
                              const std::vector<engines::Callback>& callbacks,
                              const FaultInjection& faults = {}) {
  engines::RunOptions options;
  options.engine = engine;
  options.faults = faults;
  options.callbacks = callbacks;
  return run_as_told(std::move(options), scene, laws());
}

// Each acts on all balls at once, whose local virtual times are later by then.
TEST(LateCallback, ActsOnceInTheCommittedTraceHoweverOftenItWasRolledBack) {
  const scene::Scene scene = sized("gas", 60, 1.0);
  std::vector<engines::Callback> callbacks;
  std::vector<int> all;
  for (int i = 0; i < static_cast<int>(scene.bodies.size()); ++i)
    if (!scene.bodies[static_cast<std::size_t>(i)].immovable) all.push_back(i);
  int calls = 0;
  for (const double time : {0.31, 0.31, 0.6180339})
    callbacks.push_back({time, all, [&calls](int body, RigidBodyState& state) {
                           ++calls;
                           state.momentum_world += Vector3d(0.1, 0.02 * (body % 5), -0.1);
                         }});
  const Trajectory reference = run_with_callbacks("ordered", scene, callbacks);
  ASSERT_EQ(calls, 180);
  const auto acts = [](const Trajectory& run) {
    return std::count_if(run.events.begin(), run.events.end(),
                         [](const Event& event) { return event.kind == EventKind::kControl; });
  };
  EXPECT_EQ(acts(reference), 180);
  EXPECT_EQ(difference(reference, run_with_callbacks("ca", scene, callbacks)), "");
  EXPECT_EQ(difference(reference, run_with_callbacks("tw", scene, callbacks)), "");
  calls = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Trajectory run = run_with_callbacks("tw", scene, callbacks, {seed, true, 0.2, 7, 0.1});
    ASSERT_EQ(difference(reference, run), "") << "seed " << seed;
    EXPECT_EQ(acts(run), 180);
  }
  EXPECT_GT(calls, 20 * 180);  // some were rolled back
  // Executed last, each finds its sixty balls at the end of the run: the first alone rolls back at
  // least 50 of them.
  engines::FaultInjection late;
  late.late_callbacks = true;
  const Trajectory run = run_with_callbacks("tw", scene, {callbacks[0]}, late);
  EXPECT_EQ(difference(run_with_callbacks("ordered", scene, {callbacks[0]}), run), "");
  EXPECT_EQ(acts(run), 60);
  EXPECT_GE(run.counters.counts.at("rollbacks"), 50U);
  EXPECT_GT(run.counters.counts.at("undone_integrations"), 50U);
}

TEST(LateCallback, ChangesProcessesToo) {
  const scene::Scene scene = pendula_and_balls(4, 0.8);
  const std::vector<engines::Callback> callbacks{
      {0.25, {0, 1, 4}, [](int, RigidBodyState& state) { state.momentum_world.y() += 0.3; }}};
  const Trajectory reference = run_with_callbacks("ordered", scene, callbacks);
  EXPECT_EQ(difference(reference, run_with_callbacks("ca", scene, callbacks)), "");
  for (std::uint64_t seed = 1; seed <= 10; ++seed)
    ASSERT_EQ(difference(reference,
                         run_with_callbacks("tw", scene, callbacks, {seed, true, 0.2, 5, 0.05})),
              "")
        << "seed " << seed;
}

// The tower has fallen together, been hit and come apart when a callback throws its lowest block up
// before all that.
// A ball hits a chain of n balls at 0.3 s; a callback that is executed late turns it back at 0.1 s.
// So one event of n + 1 processes is rolled back, and the ball tells the n others.
TEST(LateCallback, ThatUndoesAnImpactOnAChainCountsAnAntiMessageForEachOfItsBodies) {
  for (const int n : {2, 3, 6}) {
    scene::Scene scene;
    scene.name = "chain";
    scene.duration_s = 0.5;
    scene.bodies.push_back(ball("shot", 0.1, 1.0, {-0.5, 0, 0}, {1, 0, 0}));
    for (int i = 0; i < n; ++i) {
      scene.bodies.push_back(
          ball("link" + std::to_string(i), 0.1, 1.0, {0, 0.5 * (i - n / 2), 0}, {0, 0, 0}));
      if (i > 0)
        scene.effects.of<effects::RodSpec>().push_back(
            {"rod" + std::to_string(i),
             {"link" + std::to_string(i - 1), Vector3d::Zero()},
             {"link" + std::to_string(i), Vector3d::Zero()},
             0.5});
    }
    scene.stabilisation = scene::StabilisationSpec{};
    ASSERT_EQ(run_with("tw", scene).counters.counts.at("discontinuities"), 1U) << n;
    engines::RunOptions options;
    options.engine = "tw";
    options.faults.late_callbacks = true;
    options.callbacks = {
        {0.1, {0}, [](int, RigidBodyState& state) { state.momentum_world.x() = -1.0; }}};
    const Trajectory run = run_as_told(std::move(options), scene, laws());
    ASSERT_EQ(run.stopped_by, "") << n;
    ASSERT_EQ(run.events.size(), 1U) << n;
    EXPECT_EQ(run.events[0].kind, EventKind::kControl) << n;
    EXPECT_EQ(run.counters.counts.at("anti_messages"), static_cast<std::uint64_t>(n)) << n;
  }
}

TEST(LateCallback, BelowAGroupsBirthDissolvesIt) {
  const scene::Scene scene = tower_and_projectile(5.0);
  const std::vector<engines::Callback> callbacks{{0.02, {1}, [](int, RigidBodyState& state) {
                                                    state.momentum_world = Vector3d(0.4, 0.0, 0.5);
                                                  }}};
  engines::FaultInjection late;
  late.late_callbacks = true;
  const Trajectory reference = run_with_callbacks("ordered", scene, callbacks),
                   run = run_with_callbacks("tw", scene, callbacks, late);
  EXPECT_EQ(difference(reference, run), "");
  // all three blocks, as messages to one segment
  EXPECT_GE(run.counters.counts.at("rollbacks"), 3U);
  EXPECT_GT(run.counters.counts.at("undone_integrations"), 20U);
}

// A ball flies to 0.37 s, between two steps, is turned there, and turned again by two callbacks at
// the run's last instant, in their order.
TEST(Callback, ActsAtItsInstantInEveryEngine) {
  const Vector3d start(0, 0, 5), thrown(1.0, 0, 2.0), turned(-0.5, 0.25, 3.0);
  scene::Scene scene = scene_of(
      {ball("ball", 0.1, 2.0, start, thrown), ball("other", 0.1, 1.0, {5, 0, 9}, Vector3d::Zero())},
      0.8, kEarth);
  const std::vector<engines::Callback> callbacks{
      {0.37, {0}, [&](int, RigidBodyState& state) { state.momentum_world = 2.0 * turned; }},
      {0.8, {0}, [](int, RigidBodyState& state) { state.momentum_world = Vector3d(1, 1, 1); }},
      {0.8, {0, 1}, [](int, RigidBodyState& state) { state.momentum_world *= 3.0; }}};
  const Vector3d at_turn = start + 0.37 * thrown + 0.5 * 0.37 * 0.37 * kEarth,
                 at_end = at_turn + 0.43 * turned + 0.5 * 0.43 * 0.43 * kEarth;
  for (const char* engine : {"rd", "ordered", "ca", "tw"}) {
    const Trajectory run = run_with_callbacks(engine, scene, callbacks);
    ASSERT_EQ(run.events.size(), 4U) << engine;
    const double times[] = {0.37, 0.8, 0.8, 0.8};
    const int bodies[] = {0, 0, 0, 1};
    for (std::size_t k = 0; k < 4; ++k) {
      EXPECT_EQ(run.events[k].kind, EventKind::kControl) << engine;
      EXPECT_EQ(run.events[k].time, times[k]) << engine;
      EXPECT_EQ(run.events[k].body_a, bodies[k]) << engine;
    }
    // 200 steps of parabolas, which every method of order 2 follows to roundings of 5 m.
    EXPECT_LT((run.events[0].point_world - at_turn).norm(), 1e-12) << engine;
    EXPECT_LT((run.frames.back().poses[0].com_world - at_end).norm(), 1e-12) << engine;
    EXPECT_EQ(run.frames.back().time, 0.8) << engine;
    // of 2 kg
    EXPECT_LT((run.frames.back().poses[0].velocity_world - Vector3d(1.5, 1.5, 1.5)).norm(), 1e-15)
        << engine;
    // ball 0 once at the end, ball 1 once
    EXPECT_EQ(run.counters.counts.at("discontinuities"), 3U) << engine;
  }
}

// A body at rest, in contact or asleep starts to move.
TEST(Callback, SetsWhatLiesInMotionInTheWorldOfAllBodies) {
  const auto kick = [](int, RigidBodyState& state) { state.momentum_world.z() = 2.0; };
  scene::Scene resting = scene_of(
      {plane("floor", {0, 0, 0}, {0, 0, 1}), ball("ball", 0.1, 1.0, {0, 0, 0.1}, Vector3d::Zero())},
      1.3, kEarth);
  resting.bodies[1].restitution = 0.0;
  scene::Scene lying = resting, asleep = resting;
  lying.contact = scene::ContactSpec{};
  asleep.contact = lying.contact;
  asleep.contact->sleep = true;
  for (const scene::Scene& scene : {resting, lying, asleep}) {
    const Trajectory run = run_with_callbacks("rd", scene, {{1.0, {1}, kick}});
    ASSERT_EQ(run.stopped_by, "");
    // 1.3 s is 0.3 s after the callback: 0.1 + 2 * 0.3 - 9.81 * 0.09 / 2 = 0.25855 m. The position
    // of the floor's contact is known to a contact margin.
    EXPECT_NEAR(run.frames.back().poses[1].com_world.z(), 0.1 + 2.0 * 0.3 - 0.5 * 9.81 * 0.09,
                1e-5);
    EXPECT_EQ(scene.contact && scene.contact->sleep,
              run.counters.counts.at("bodies_put_to_sleep") > 0);
  }
}

// Links, contacts, free flight: the same events in the same order, at times equal to the order of
// the step.
TEST(Callback, AgreesInEveryEngine) {
  const scene::Scene scene = pendula_and_balls(4, 0.5);
  const std::vector<engines::Callback> callbacks{
      {0.1234,
       {0, 1, 4},
       [](int body, RigidBodyState& state) {
         state.momentum_world += Vector3d(0.02 * body, 0.3, 0);
       }},
      {0.1234, {2}, [](int, RigidBodyState& state) { state.momentum_world.x() -= 0.2; }},
      {0.25, {3, 5}, [](int, RigidBodyState& state) { state.momentum_world.z() += 0.2; }}};
  const Trajectory reference = run_with_callbacks("ordered", scene, callbacks);
  for (const char* engine : {"ca", "tw"})
    EXPECT_EQ(difference(reference, run_with_callbacks(engine, scene, callbacks)), "") << engine;
  const Trajectory rd = run_with_callbacks("rd", scene, callbacks);
  ASSERT_EQ(rd.events.size(), reference.events.size());
  ASSERT_GE(rd.events.size(), 10U);
  for (std::size_t k = 0; k < rd.events.size(); ++k) {
    EXPECT_EQ(rd.events[k].kind, reference.events[k].kind) << k;
    EXPECT_EQ(rd.events[k].body_a, reference.events[k].body_a) << k;
    EXPECT_EQ(rd.events[k].body_b, reference.events[k].body_b) << k;
    // s: as without callbacks, below
    EXPECT_NEAR(rd.events[k].time, reference.events[k].time, 1e-6) << k;
  }
  // m
  for (std::size_t i = 0; i < rd.bodies.size(); ++i)
    EXPECT_LT(
        (rd.frames.back().poses[i].com_world - reference.frames.back().poses[i].com_world).norm(),
        1e-5)
        << rd.bodies[i].name;
}

// A pull along the rod changes nothing, whatever stabilisation the rod has: as after an impact,
// velocities are projected onto what links allow.
TEST(Callback, LeavesLinksAsLongAsTheyAre) {
  for (const scene::StabilisationKind kind :
       {scene::StabilisationKind::kNone, scene::StabilisationKind::kBaumgarte,
        scene::StabilisationKind::kProjection}) {
    scene::Scene scene = truths::straight_chain({1.0}, 1.0, -Vector3d::UnitZ(), kEarth);
    scene.stabilisation->kind = kind;
    scene.duration_s = 1.0;
    for (const char* engine : {"rd", "ordered", "ca", "tw"}) {
      const Trajectory run =
          run_with_callbacks(engine, scene, {{0.5, {0}, [](int, RigidBodyState& state) {
                                                state.momentum_world = Vector3d(0, 0, -1);
                                              }}});
      ASSERT_EQ(run.stopped_by, "") << engine;
      // m: it was at rest there
      EXPECT_NEAR(run.frames.back().poses[0].com_world.z(), -1.0, 1e-12) << engine;
    }
  }
}

// Engines compute from a local origin: a callback still sees world positions. Its changes of
// positions are ignored.
TEST(Callback, SeesPlacesOfTheWorldAndMovesNone) {
  const Vector3d far(1e6, 0, 0);
  const scene::Scene scene = scene_of({ball("ball", 0.1, 1.0, far, Vector3d::Zero())}, 0.2);
  for (const char* engine : {"rd", "ordered", "ca", "tw"}) {
    const Trajectory run = run_with_callbacks(
        engine, scene, {{0.1, {0}, [&](int, RigidBodyState& state) {
                           state.momentum_world =
                               Vector3d(0, (state.com_world - far).norm() < 1e-9 ? 1.0 : -1.0, 0);
                           state.com_world.setZero();
                         }}});
    // m: the spacing of doubles at 10^6 is 1e-10
    EXPECT_LT((run.frames.back().poses[0].com_world - far - Vector3d(0, 0.1, 0)).norm(), 1e-9)
        << engine;
  }
}

TEST(Callback, OnWhatCannotMoveIsRefused) {
  const scene::Scene scene = scene_of(
      {plane("floor", {0, 0, 0}, {0, 0, 1}), ball("ball", 0.1, 1.0, {0, 0, 1}, Vector3d::Zero())},
      0.1, kEarth);
  for (const char* engine : {"rd", "tw"})
    EXPECT_THROW(run_with_callbacks(engine, scene, {{0.05, {0}, [](int, RigidBodyState&) {}}}),
                 PreconditionError)
        << engine;
}

// ---- Agreement with a world of all bodies ----------------------------------------------------

// A step of fourth order that ends elsewhere: 1e-8 at 1/240 s, multiplied by some impacts.
constexpr double kTruncation = 1e-6;  // s, m

TEST(LogicalProcesses, MoveAsTheWorldOfAllBodiesDoes) {
  const scene::Scene scene = pendula_and_balls(6, 0.5);
  const Trajectory rd = run_with("rd", scene), tw = run_with("tw", scene);
  ASSERT_EQ(rd.events.size(), tw.events.size());
  ASSERT_GE(rd.events.size(), 6U);
  for (std::size_t k = 0; k < rd.events.size(); ++k) {
    EXPECT_EQ(rd.events[k].kind, tw.events[k].kind) << k;
    EXPECT_EQ(rd.events[k].body_a, tw.events[k].body_a) << k;
    EXPECT_NEAR(rd.events[k].time, tw.events[k].time, kTruncation) << k;
  }
  for (std::size_t i = 0; i < rd.bodies.size(); ++i)
    EXPECT_LT((rd.frames.back().poses[i].com_world - tw.frames.back().poses[i].com_world).norm(),
              10 * kTruncation)
        << rd.bodies[i].name;
}

TEST(LogicalProcesses, RecordWhatTheirLinksAndContactsPullAndPush) {
  const Trajectory run = run_with("tw", pendula_and_balls(2, 0.1));
  // m v^2 / l + m g at the lowest point, slightly slowed by drag: v^2 < 0.64.
  EXPECT_NEAR(run.frames.front().rod_tensions.at(0), 0.64 + 9.81, 1e-9);
  const Trajectory tower = run_with("tw", tower_and_projectile(0.1));
  double push = 0.0;
  for (const ContactPoint& point : tower.frames.back().contacts)
    push += point.body_a == 0 ? -point.force_on_a_world.z() : 0.0;
  // the weight of three blocks, and of the shot that has fallen beside them
  EXPECT_NEAR(push, 3.4 * 9.81, 1e-6 * 30);
}

TEST(SizedScenes, BeginApartAtTheirOwnSize) {
  for (const scene::SizedScene& sized_scene : scene::sized_scenes()) {
    const scene::Scene scene = sized(sized_scene.name, sized_scene.default_n, 1e-6);
    EXPECT_NO_THROW({  // an overlap at the start is refused
      const Trajectory run = run_with("rd", scene);
      EXPECT_EQ(run.stopped_by, "") << sized_scene.name;
      EXPECT_GE(run.frames.front().smallest_gap, 0.0) << sized_scene.name;
    }) << sized_scene.name;
  }
}

TEST(SizedScenes, BeginApartWhereTheyAreLarge) {
  TUMBLE_ONLY_WHOLE();
  for (const scene::SizedScene& sized_scene : scene::sized_scenes()) {
    // Each rock is a shape of its own to build; an arm has ten bodies, and each pair of links is
    // found by name.
    const int n = sized_scene.name == "avalanche" ? 1000
                  : sized_scene.name == "robots"  ? 500
                                                  : 20'000;
    const scene::Scene scene = sized(sized_scene.name, n, 1e-6);
    // an overlap at the start is refused
    EXPECT_NO_THROW(engines::FlightWorld(scene, "tw", laws(), {})) << sized_scene.name;
  }
}

// Four times the vehicles and pendula cost four times as much. A search of each world through all
// links, or all other worlds, would cost sixteen times; twice the linear ratio allows for caches.
// Other programs disturb single runs, so a ratio that is too large is measured again.
TEST(SettingUp, TakesTimeInProportionToTheNumberOfProcesses) {
  const Laws laws = reference_laws();
  const scene::Scene few = sized("cars", 2000, 1e-4), many = sized("cars", 8000, 1e-4);
  const auto seconds_of = [&](const scene::Scene& scene) {
    const double begin = cpu_seconds();
    run_by("tw", scene, {}, 60.0, laws);
    return cpu_seconds() - begin;
  };
  double of_few = 1e300, of_many = 1e300;
  for (int k = 0; k < 2 || (k < 8 && of_many >= 8.0 * of_few); ++k) {
    of_few = std::min(of_few, seconds_of(few));
    of_many = std::min(of_many, seconds_of(many));
  }
  EXPECT_LT(of_many, 8.0 * of_few);
}

// Nothing happens to a bob that swings by itself, so that "ordered" draws all frames at the run's
// end. Looking for the step of each among all before it cost sixteen times as much for four times
// the length; measured as above.
TEST(LongRuns, OfOneSegmentTakeTimeInProportionToTheirLength) {
  const auto seconds_of = [&](double duration) {
    scene::Scene scene = pendula_and_balls(1, duration);
    scene.bodies.resize(1);
    scene.effects.of<effects::PointForceSpec>().clear();
    const double begin = cpu_seconds();
    const Trajectory run = run_with("ordered", scene);
    EXPECT_EQ(run.stopped_by, "");
    EXPECT_NEAR(run.frames.back().time, duration, 1e-9);
    return cpu_seconds() - begin;
  };
  double of_short = 1e300, of_long = 1e300;
  for (int k = 0; k < 2 || (k < 4 && of_long >= 8.0 * of_short); ++k) {
    of_short = std::min(of_short, seconds_of(300.0));
    of_long = std::min(of_long, seconds_of(1200.0));
  }
  EXPECT_LT(of_long, 8.0 * of_short);
}

}  // namespace
}  // namespace tumble::testing
