// The paper's four scenes, small: every event-driven engine commits one trace, and a world of all
// bodies agrees until chaos; arms throw their blocks, rocks slide down the mountain and stay on it.
#include <algorithm>
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "framework/effects/motor/motor.h"
#include "framework/scene/sized_scenes.h"
#include "tests/engines/event_process_scenes.h"
#include "tests/engines/event_scenes.h"
#include "tests/engines/reference_laws.h"
#include "tests/support/whole.h"

namespace tumble::testing::paper_scenes_test {
namespace {

const Laws& laws() {
  static const Laws reference = reference_laws();
  return reference;
}

Trajectory run_with(const std::string& engine, const scene::Scene& scene) {
  return run_by(engine, scene, {}, 60.0, laws());
}

int body_named(const Trajectory& run, const std::string& name) {
  for (std::size_t i = 0; i < run.bodies.size(); ++i)
    if (run.bodies[i].name == name) return static_cast<int>(i);
  return -1;
}

bool touch(const Frame& frame, int a, int b) {
  return std::any_of(frame.contacts.begin(), frame.contacts.end(), [&](const ContactPoint& point) {
    return std::pair(point.body_a, point.body_b) == std::pair(std::min(a, b), std::max(a, b));
  });
}

double farthest_apart(const Trajectory& x, const Trajectory& y, double until) {
  double farthest = 0.0;
  for (std::size_t k = 0;
       k < std::min(x.frames.size(), y.frames.size()) && x.frames[k].time <= until; ++k)
    for (std::size_t i = 0; i < x.bodies.size(); ++i)
      farthest = std::max(farthest,
                          (x.frames[k].poses[i].com_world - y.frames[k].poses[i].com_world).norm());
  return farthest;
}

/// @param until  duration of the comparison with a world of all bodies [s]; @param within [m]
void expect_engines_agree(const scene::Scene& scene, std::size_t least_events, double until,
                          double within) {
  const Trajectory reference = run_with("ordered", scene);
  ASSERT_EQ(reference.stopped_by, "");
  EXPECT_GE(reference.events.size(), least_events);
  for (const char* engine : {"tw", "ca"})
    EXPECT_EQ(difference(reference, run_with(engine, scene)), "") << engine;
  scene::Scene part = scene;
  part.duration_s = until;
  const Trajectory rd = run_with("rd", part);
  ASSERT_EQ(rd.stopped_by, "");
  EXPECT_LT(farthest_apart(reference, rd, until), within);
  for (const Frame& frame : reference.frames) ASSERT_GE(frame.smallest_gap, 0.0) << frame.time;
}

// All engines find the impacts of free bodies up to rounding. RK4 adds 1e-10 m to rotating
// molecules at this step, and each collision multiplies it, by up to a hundred.
TEST(PaperScenes, AtomsAgree) {
  scene::Scene scene = sized("atoms", 12, 1.0);
  scene.step_s = 1.0 / 480.0;
  expect_engines_agree(scene, 10, 0.5, 1e-6);
}

// Contacts of wheels are of second order in the step, and steps end at other times in a world of
// all bodies than in a process.
TEST(PaperScenes, CarsAgree) { expect_engines_agree(sized("cars", 9, 1.2), 3, 0.5, 1e-3); }

TEST(PaperScenes, RobotsAgree) { expect_engines_agree(sized("robots", 1, 0.7), 2, 0.5, 1e-3); }

// Until rocks have been in persistent contact for some steps.
TEST(PaperScenes, AvalancheAgrees) {
  expect_engines_agree(sized("avalanche", 5, 1.5), 10, 0.5, 1e-3);
}

// A perfectly inelastic domino hits the next: wherever in a step the impact is, all contacts of the
// two take part in it, with the floor's friction. Both worlds are right to the order of the step,
// so their difference vanishes with it; an impact that is resolved alone, before the floor reacts,
// leaves 2 mm at any step.
TEST(PaperScenes, DominoesAgreeAsTheirStepsGoToNothing) {
  scene::Scene scene = sized("dominoes_row", 2, 0.2);
  const auto apart = [&](int finer) {
    scene::Scene fine = scene;
    fine.step_s = scene.step_s / finer;
    return farthest_apart(run_with("tw", fine), run_with("rd", fine), scene.duration_s);
  };
  const double coarse = apart(1), fine = apart(16);
  EXPECT_GT(coarse, 1e-4);  // m: their steps differ, so a difference exists
  EXPECT_LT(fine, 1e-4);    // m: a sixteenth of the 1.2 mm at the scene's own step
  EXPECT_LT(8 * fine, coarse);
}

// With located impacts the floor under the hit domino reacts at that instant, by the laws'
// impulses. A later reaction, as a persistent contact with friction, leaves 2 mm too.
TEST(PaperScenes, DominoesWithLocatedImpactsAgree) {
  scene::Scene scene = sized("dominoes_row", 2, 0.1);
  scene.contact->plastic_impacts = scene::PlasticImpacts::kLocated;
  scene.step_s /= 4;
  const Trajectory tw = run_with("tw", scene), rd = run_with("rd", scene);
  EXPECT_EQ(difference(run_with("ordered", scene), tw), "");
  ASSERT_TRUE(std::any_of(tw.events.begin(), tw.events.end(), [&](const Event& event) {
    return event.kind == EventKind::kCollision && event.body_b == body_named(tw, "domino_2");
  }));
  // m: 1e-11 from rounding, multiplied by the alternating impacts of corners
  EXPECT_LT(farthest_apart(tw, rd, scene.duration_s), 1e-9);
}

// ---- The first collisions of each body, by all engines -----------------------------------------

// per body: after so many a rounding has grown to a millionth of its path
constexpr std::size_t kFirst = 5;
constexpr double kSameInstant = 1e-6;  // s

/// Times of each body's first collisions, without pairs in persistent contact: a world of all
/// bodies resolves their impacts within its steps and records them at the steps' ends.
std::vector<std::vector<double>> first_collisions(const Trajectory& run,
                                                  const std::set<std::pair<int, int>>& left_out) {
  std::vector<std::vector<double>> times(run.bodies.size());
  for (const Event& event : run.events)
    for (const int body : {event.body_a, event.body_b})
      if (event.kind == EventKind::kCollision && !left_out.contains({event.body_a, event.body_b}) &&
          !run.bodies[static_cast<std::size_t>(body)].immovable &&
          times[static_cast<std::size_t>(body)].size() < kFirst)
        times[static_cast<std::size_t>(body)].push_back(event.time);
  return times;
}

void expect_the_first_collisions_agree(const scene::Scene& scene, std::size_t least) {
  const Trajectory tw = run_with("tw", scene), ca = run_with("ca", scene),
                   rd = run_with("rd", scene);
  std::set<std::pair<int, int>> lying;
  for (const Trajectory* run : {&tw, &ca, &rd})
    for (const Event& event : run->events)
      if (event.kind == EventKind::kContact) lying.insert({event.body_a, event.body_b});
  const auto expected = first_collisions(tw, lying);
  std::size_t compared = 0;
  for (const Trajectory* run : {&ca, &rd}) {
    ASSERT_EQ(run->stopped_by, "");
    const auto found = first_collisions(*run, lying);
    for (std::size_t i = 0; i < expected.size(); ++i) {
      ASSERT_EQ(found[i].size(), expected[i].size())
          << run->info.engine << ", " << tw.bodies[i].name;
      for (std::size_t k = 0; k < found[i].size(); ++k, ++compared)
        EXPECT_NEAR(found[i][k], expected[i][k], kSameInstant)
            << run->info.engine << ", collision " << k << " of " << tw.bodies[i].name;
    }
  }
  EXPECT_GE(compared, 2 * least);
}

// Wheels roll, which is of second order in the step; pendula swing and hit each other.
TEST(FirstCollisions, OfCarsAndPendulaAgree) {
  expect_the_first_collisions_agree(sized("cars", 20, 1.5), 8);
}

// Rocks that rotate and fall, RK4 in a world of all bodies: an error of 1e-6 s at 1/240 s becomes
// 1e-9 s at a quarter of that. From 0.7 s on rocks have been in contact, and an impact multiplies
// the error of contacts with one impulse per step.
TEST(FirstCollisions, OfRocksAgree) {
  scene::Scene scene = sized("avalanche", 24, 0.6);
  scene.step_s = 1.0 / 960.0;
  expect_the_first_collisions_agree(scene, 20);
}

// An arm hits nothing before it throws: the comparison is the throw, and all positions until the
// block lands.
TEST(FirstCollisions, OfARobotIsItsThrowWhichAgrees) {
  const scene::Scene scene = sized("robots", 1, 0.62);
  const Trajectory tw = run_with("tw", scene);
  const auto thrown = [&](const Trajectory& run) {
    double time = kUnset;
    for (const Event& event : run.events)
      if (event.kind == EventKind::kBreak &&
          run.bodies[static_cast<std::size_t>(event.body_b)].name == "block_1_1")
        time = event.time;
    return time;
  };
  ASSERT_GT(thrown(tw), 0.3);
  for (const char* engine : {"ca", "rd"}) {
    const Trajectory run = run_with(engine, scene);
    EXPECT_NEAR(thrown(run), thrown(tw), kSameInstant) << engine;
    EXPECT_LT(farthest_apart(tw, run, scene.duration_s), 1e-6) << engine;  // m
  }
}

// rd steps both robots together: where the block in one hand begins to slide, the other robot's
// step is cut too. The sliding of a held block is right to the order of the step only, so this
// moves it by at most the error of the step.
TEST(FirstCollisions, OfTwoRobotsAgreeAsFarAsTheirStepIsRight) {
  TUMBLE_ONLY_WHOLE();
  scene::Scene scene = sized("robots", 2, 0.35), finer = scene;
  // a quarter changes nothing: contacts of links use shorter steps of their own
  finer.step_s = scene.step_s / 8;
  const Trajectory tw = run_with("tw", scene);
  const double of_the_step = farthest_apart(tw, run_with("tw", finer), scene.duration_s);
  EXPECT_LT(of_the_step, 1e-3);  // m
  EXPECT_EQ(difference(tw, run_with("ca", scene)), "");
  EXPECT_LT(farthest_apart(tw, run_with("rd", scene), scene.duration_s), of_the_step);
}

Trajectory run_on(int threads, const scene::Scene& scene, const engines::FaultInjection& faults,
                  const std::vector<engines::Callback>& callbacks = {},
                  const std::string& engine = "tw") {
  engines::RunOptions options;
  options.engine = engine;
  options.faults = faults;
  options.threads = threads;
  options.callbacks = callbacks;
  return run_as_told(std::move(options), scene, laws());
}

// Rolled-back work relative to committed work: nowhere more than all, and small on average, also
// with delayed threads.
TEST(PaperScenes, UndoLittleOfTheirWork) {
  engines::FaultInjection delayed;
  delayed.seed = 14;
  delayed.delay_s = 1e-5;
  for (const int threads : {1, 2}) {
    double sum = 0.0;
    const std::vector<scene::Scene> scenes{sized("atoms", 60, 1.0), sized("cars", 30, 1.0),
                                           sized("robots", 2, 0.7), sized("avalanche", 10, 1.0)};
    for (const scene::Scene& scene : scenes) {
      const Trajectory run =
          run_on(threads, scene, threads > 1 ? delayed : engines::FaultInjection{});
      ASSERT_EQ(run.stopped_by, "") << scene.name;
      const double undone = static_cast<double>(run.counters.counts.at("undone_integrations")),
                   committed = static_cast<double>(run.counters.counts.at("integrations")) - undone;
      EXPECT_LE(undone, committed) << scene.name << ", " << threads << " threads";
      // real threads, each with its own work
      EXPECT_TRUE(threads == 1 || run.counters.counts.at("least_events_of_a_thread") > 10)
          << scene.name;
      sum += undone / committed;
    }
    EXPECT_LE(sum / static_cast<double>(scenes.size()), 0.15) << threads << " threads";
  }
}

// Of processes that fuse and split across territories, too.
TEST(PaperScenes, AreCommittedAndCountedTheSameHoweverThreadsAreDelayed) {
  for (const scene::Scene& scene :
       {sized("avalanche", 60, 0.5), sized("cars", 12, 0.2), tower_and_projectile(5.0)}) {
    const Trajectory one = run_on(1, scene, {});
    for (const int threads : {2, 4}) {
      const Trajectory plain = run_on(threads, scene, {});
      EXPECT_EQ(difference(one, plain), "") << scene.name << ", " << threads << " threads";
      for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        engines::FaultInjection delayed;
        delayed.seed = seed;
        delayed.delay_s = 2e-5;
        EXPECT_EQ(run_on(threads, scene, delayed).counters.counts, plain.counters.counts)
            << scene.name << ", " << threads << " threads, seed " << seed;
      }
    }
  }
}

// A row falls, each domino onto the next, until the last has been hit; then a callback holds the
// first at the start of its fall. Groups that fused, split and fused again along the row are rolled
// back, each body once.
TEST(LateEvent, AtTheFirstOfARowOfDominoesRollsEachBackOnce) {
  engines::FaultInjection late;
  late.late_callbacks = true;
  for (const int n : {3, 6, 12}) {
    const scene::Scene row = sized("dominoes_row", n, 0.15 * n + 0.3);
    const std::vector<engines::Callback> hold{
        {0.05,
         {body_named(run_with("tw", sized("dominoes_row", n, 0.0)), "domino_1")},
         [](int, RigidBodyState& state) {
           state.momentum_world.setZero();
           state.angular_momentum_world.setZero();
         }}};
    const Trajectory reference = run_on(1, row, {}, hold, "ordered"),
                     run = run_on(1, row, late, hold);
    EXPECT_EQ(difference(reference, run), "") << n;
    EXPECT_EQ(run.counters.counts.at("rollbacks"), static_cast<std::uint64_t>(n)) << n;
    EXPECT_GE(run.counters.counts.at("anti_messages"), static_cast<std::uint64_t>(n - 1)) << n;
  }
}

// Where the reference takes too long, timewarp in its own order replaces it; in smaller rows,
// above, its trace is the reference's.
TEST(LateEvent, AtTheFirstOfALongRowOfDominoesRollsEachBackOnce) {
  constexpr int kDominoes = 24;
  engines::FaultInjection late;
  late.late_callbacks = true;
  const scene::Scene row = sized("dominoes_row", kDominoes, 0.15 * kDominoes + 0.3);
  const std::vector<engines::Callback> hold{
      {0.05,
       {body_named(run_with("tw", sized("dominoes_row", kDominoes, 0.0)), "domino_1")},
       [](int, RigidBodyState& state) {
         state.momentum_world.setZero();
         state.angular_momentum_world.setZero();
       }}};
  const Trajectory in_order = run_on(1, row, {}, hold), run = run_on(1, row, late, hold);
  ASSERT_EQ(in_order.stopped_by, "");
  EXPECT_EQ(difference(in_order, run), "");
  EXPECT_EQ(run.counters.counts.at("rollbacks"), static_cast<std::uint64_t>(kDominoes));
  EXPECT_GE(run.counters.counts.at("anti_messages"), static_cast<std::uint64_t>(kDominoes - 1));
  EXPECT_EQ(run.counters.counts.at("passages_begun"), run.counters.counts.at("passages_let_go"));
}

TEST(Robots, CarryABlockAndThrowItOverTheirShoulder) {
  const Trajectory run = run_with("tw", sized("robots", 1, 1.2));
  ASSERT_EQ(run.stopped_by, "");
  const int block = body_named(run, "block_1_1"), hand = body_named(run, "hand_1"),
            shoulder = body_named(run, "arm_1_1");
  ASSERT_TRUE(block >= 0 && hand >= 0 && shoulder >= 0);
  const auto x_of = [&](const Frame& frame) {
    return frame.poses[static_cast<std::size_t>(block)].com_world.x() -
           run.frames.front().poses[static_cast<std::size_t>(shoulder)].com_world.x();
  };
  EXPECT_LT(x_of(run.frames.front()), -1.3);  // behind, at the end of the arm
  double highest = 0.0, flies = 0.0;
  for (const Frame& frame : run.frames) {
    highest = std::max(highest, frame.poses[static_cast<std::size_t>(block)].com_world.z());
    const bool lifted = frame.time > 0.02 && frame.time < 0.3;
    EXPECT_TRUE(!lifted || touch(frame, hand, block)) << frame.time;
    if (!touch(frame, hand, block)) flies = std::max(flies, x_of(frame));
  }
  EXPECT_GT(highest, 1.8);  // m, from 0.9 m
  EXPECT_GT(flies, 1.0);    // m, on the other side
}

TEST(Avalanche, RocksComeDownTheMountainAndTouchIt) {
  const Trajectory run = run_with("tw", sized("avalanche", 4, 2.0));
  ASSERT_EQ(run.stopped_by, "");
  const int mountain = body_named(run, "mountain_1");
  ASSERT_GE(mountain, 0);
  // By impacts, or by resting and rolling.
  bool touches = std::any_of(run.events.begin(), run.events.end(), [&](const Event& event) {
    return event.kind == EventKind::kCollision &&
           (event.body_a == mountain || event.body_b == mountain);
  });
  for (const Frame& frame : run.frames)
    touches = touches || std::any_of(frame.contacts.begin(), frame.contacts.end(),
                                     [&](const ContactPoint& point) {
                                       return point.body_a == mountain || point.body_b == mountain;
                                     });
  EXPECT_TRUE(touches);
  for (std::size_t i = 0; i < run.bodies.size(); ++i) {
    if (run.bodies[i].immovable) continue;
    const Vector3d way =
        run.frames.back().poses[i].com_world - run.frames.front().poses[i].com_world;
    // m; gravity alone makes them fall less than 1.3 m
    EXPECT_LT(way.z(), -1.5) << run.bodies[i].name;
    EXPECT_GT(way.x(), 0.5) << run.bodies[i].name;  // downhill
    EXPECT_GT(run.frames.back().poses[i].com_world.z(), 0.0) << run.bodies[i].name;
  }
}

// ---- Located perfectly inelastic impacts, in a scoop driven by motors ------------------------

scene::Scene robot_with_located_impacts() {
  scene::Scene scene = sized("robots", 1, 0.35);
  scene.contact->plastic_impacts = scene::PlasticImpacts::kLocated;
  return scene;
}

TEST(Robots, WithLocatedImpactsComeToTheirEnd) {
  for (const char* engine : {"rd", "tw"}) {
    const Trajectory run = run_by(engine, robot_with_located_impacts(), {}, 60.0, reference_laws());
    EXPECT_EQ(run.stopped_by, "") << engine;
    EXPECT_GT(run.events.size(), 1U) << engine;  // the scoop begins to push
    EXPECT_LT(run.counters.counts.at("discontinuities"), 1000U) << engine;
  }
}

// A scoop's corners slide over its block: confused with each other in the middle of a step, they
// cause 0.02 m at every step.
TEST(Robots, ComeToOneMotionAtEveryStep) {
  scene::Scene scene = robot_with_located_impacts();
  const Trajectory coarse = run_by("rd", scene, {}, 60.0, reference_laws());
  scene.step_s /= 8;
  const Trajectory fine = run_by("rd", scene, {}, 60.0, reference_laws());
  // m: 3e-4 of a reach of 2 m, by a friction law of first order
  EXPECT_LT(farthest_apart(coarse, fine, scene.duration_s), 1e-3);
}

// A torque held for 1/960 s that brakes an eighth of the arm's inertia by 60 N m s/rad reverses it,
// faster each time.
TEST(Robots, WhoseMotorsOvershootAreStoppedAtOnceAndNamed) {
  scene::Scene scene = robot_with_located_impacts();
  for (effects::MotorSpec& motor : scene.effects.of<effects::MotorSpec>())
    motor.damping_n_m_s_rad = 60.0 * motor.stiffness_n_m_rad / 6000.0;
  for (const char* engine : {"rd", "tw"}) {
    const Trajectory run = run_by(engine, scene, {}, 60.0, reference_laws());
    for (const char* word : {"at t = ", "_1_", "period_s"})
      EXPECT_NE(run.stopped_by.find(word), std::string::npos) << engine << ": " << run.stopped_by;
    // links at 1e4 rad/s collide often; an engine stops at 20,000 impacts per step, and this is the
    // second or third step
    EXPECT_LT(run.events.size(), 50000U) << engine;
  }
}

}  // namespace
}  // namespace tumble::testing::paper_scenes_test
