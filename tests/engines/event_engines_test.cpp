// Event-driven engines in scenes with a known outcome: ties, cradles, Zeno, chains of events at one
// instant, elastic gas.
#include <algorithm>
#include <cmath>
#include <memory>

#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/core/random.h"
#include "framework/engines/base/run_counters.h"
#include "framework/engines/events/flight_run.h"
#include "tests/engines/event_scenes.h"
#include "tests/support/places.h"

namespace tumble::testing {
namespace {

const char* const kEventEngines[] = {"ordered", "ca", "tw"};

// Rows along x in which every other ball rests and is hit from both sides at the same instant;
// numbers are exact in binary.
scene::Scene lattice(int nx, int ny, int nz, double duration) {
  std::vector<scene::BodySpec> bodies;
  for (int i = 0; i < nx; ++i)
    for (int j = 0; j < ny; ++j)
      for (int k = 0; k < nz; ++k) {
        const double velocity = i % 4 == 0 ? 0.5 : i % 4 == 2 ? -0.5 : 0.0;
        bodies.push_back(
            ball("ball", 0.0625, 1.0, {0.25 * i, 0.25 * j, 0.25 * k}, {velocity, 0, 0}));
        bodies.back().name += std::to_string(bodies.size());
      }
  return scene_of(std::move(bodies), duration);
}

// What a discontinuity has noted counts as it is committed, as often as there are such events.
TEST(Commit, CountsWhatADiscontinuityHasNoted) {
  const scene::Scene scene = lattice(2, 1, 1, 1.0);
  const Laws laws = test_laws();
  engines::RunOptions options;
  options.engine = "ordered";
  TrajectoryRecorder recorder;
  engines::FlightRun run(scene, laws, options, recorder);
  for (const double time : {0.25, 0.5, 0.75}) {
    engines::Discontinuity discontinuity;
    discontinuity.key = {time, 0, engines::StampKind::kProcess, 0, -1};
    discontinuity.is_silent = true;
    if (time > 0.3) {
      discontinuity.noted = std::make_unique<engines::RunWatch>();
      discontinuity.noted->note(engines::RunWatch::Kind::kContactUnsolved, "'ball1'",
                                {1.0, engines::kContactSolved, time, 0.0});
    }
    run.commit(discontinuity);
  }
  const std::vector<RunFault> faults = run.counters.watch.faults();
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_EQ(faults[0].kind, "contact_unsolved");
  EXPECT_EQ(faults[0].count, 2U);
  EXPECT_EQ(faults[0].first_s, 0.5);
}

TEST(Ties, OfALatticeThatCollidesAtOnceEndTheSameInEveryOrder) {
  const scene::Scene scene = lattice(10, 10, 10, 0.8);
  const Trajectory reference = run_by("ordered", scene, {}, 5.0);
  const auto at_once = std::count_if(
      reference.events.begin(), reference.events.end(),
      [&](const Event& event) { return event.time == reference.events.front().time; });
  ASSERT_GE(at_once, 700);
  ASSERT_EQ(difference(reference, run_by("ca", scene, {}, 5.0)), "");
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const Trajectory run =
        run_by("tw", scene, {seed, true, seed % 2 == 0 ? 0.1 : 0.0, 0, 0.0}, 5.0);
    ASSERT_EQ(difference(reference, run), "") << "seed " << seed;
    // N s; a thousand balls of 1 kg, 0.5 m/s
    EXPECT_LT((run.frames.back().momentum_world - run.frames.front().momentum_world).norm(), 1e-12);
  }
}

// Along three axes at once: where rows of all three cross, a ball is hit from six sides at the same
// instant, in no natural order.
TEST(Ties, OfImpactsAlongThreeAxesEndTheSameInEveryOrder) {
  scene::Scene scene = lattice(6, 6, 6, 0.8);
  for (scene::BodySpec& body : scene.bodies)
    for (int axis = 0; axis < 3; ++axis) {
      const int place = static_cast<int>(std::lround(4 * body.position_m[axis])) % 4;
      body.velocity_m_s[axis] = place == 0 ? 0.5 : place == 2 ? -0.5 : 0.0;
    }
  const Trajectory reference = run_by("ordered", scene, {}, 5.0);
  ASSERT_EQ(reference.stopped_by, "");
  std::vector<int> blows(scene.bodies.size());  // at the first instant, by body
  for (const Event& event : reference.events)
    if (event.time == reference.events.front().time)
      for (const int body : {event.body_a, event.body_b}) ++blows[static_cast<std::size_t>(body)];
  ASSERT_GE(std::count_if(blows.begin(), blows.end(), [](int count) { return count >= 6; }), 8);
  ASSERT_EQ(difference(reference, run_by("ca", scene, {}, 5.0)), "");
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    engines::RunOptions options;
    options.engine = "tw";
    options.threads = seed % 4 == 0 ? 2 : 1;
    options.faults = {seed, true, 0.0, 0, 0.0};
    options.frame_rate_hz = 5.0;
    const Trajectory run = run_as_told(std::move(options), scene, test_laws());
    EXPECT_EQ(difference(reference, run), "") << "seed " << seed;
    // N s; 216 balls of 1 kg, 0.9 m/s
    EXPECT_LT((run.frames.back().momentum_world - run.frames.front().momentum_world).norm(), 1e-12);
  }
}

TEST(Cradle, WithGapsPassesTheImpactOnInOrder) {
  for (const int n : {5, 12, 50}) {
    std::vector<scene::BodySpec> bodies;
    for (int i = 0; i < n; ++i)
      bodies.push_back(
          ball("ball" + std::to_string(i), 0.1, 1.0, {i * (0.2 + 1e-9), 0, 0}, Vector3d::Zero()));
    bodies[0].position_m.x() = -1.0;
    bodies[0].velocity_m_s.x() = 2.0;
    for (const char* engine : kEventEngines) {
      const Trajectory run = run_by(engine, scene_of(bodies, 1.0));
      ASSERT_EQ(run.events.size(), static_cast<std::size_t>(n - 1))
          << engine << ", " << n << " balls";
      for (int i = 0; i + 1 < n; ++i) EXPECT_EQ(run.events[static_cast<std::size_t>(i)].body_a, i);
      // m/s: 50 roundings are 1e-14
      EXPECT_NEAR(run.frames.back().poses.back().velocity_world.x(), 2.0, 1e-9);
    }
  }
}

// A row of touching balls, the first of which comes from afar; the bodies are numbered from that
// end or from the other: then each effect has lower bodies than its cause, and must still come
// after it.
scene::Scene touching_row(int n, bool from_the_end) {
  std::vector<scene::BodySpec> bodies;
  for (int i = 0; i < n; ++i) {
    const int place = from_the_end ? n - 1 - i : i;
    bodies.push_back(ball("ball" + std::to_string(i), 0.125, 1.0,
                          {place == 0 ? -1.0 : 0.25 * place, 0, 0},
                          {place == 0 ? 2.0 : 0.0, 0, 0}));
  }
  return scene_of(std::move(bodies), 1.0);
}

void expect_the_blow_to_pass(const Trajectory& run, int n, bool from_the_end) {
  ASSERT_EQ(run.events.size(), static_cast<std::size_t>(n - 1));
  for (int k = 0; k + 1 < n; ++k) {
    const Event& event = run.events[static_cast<std::size_t>(k)];
    EXPECT_EQ(event.time, run.events.front().time) << "blow " << k;
    EXPECT_EQ(std::min(event.body_a, event.body_b), from_the_end ? n - 2 - k : k) << "blow " << k;
  }
  for (int i = 0; i < n; ++i)
    EXPECT_EQ(run.frames.back().poses[static_cast<std::size_t>(i)].velocity_world.x(),
              i == (from_the_end ? 0 : n - 1) ? 2.0 : 0.0)
        << "ball " << i;
}

TEST(Cradle, ThatTouchesPassesTheImpactOnInOneInstantByMicrosteps) {
  for (const int n : {5, 12, 50})
    for (const bool from_the_end : {false, true}) {
      const scene::Scene scene = touching_row(n, from_the_end);
      for (const char* engine : kEventEngines) {
        SCOPED_TRACE(std::string(engine) + ", " + std::to_string(n) + " balls");
        expect_the_blow_to_pass(run_by(engine, scene), n, from_the_end);
      }
      for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed) + ", " + std::to_string(n) + " balls");
        engines::RunOptions options;
        options.engine = "tw";
        options.threads = seed % 2 == 0 ? 2 : 1;
        options.faults = {seed, true, 0.5, 0, 0.0};
        expect_the_blow_to_pass(run_as_told(std::move(options), scene, test_laws()), n,
                                from_the_end);
      }
    }
}

// Bounces of a ball with e = 0.5 from 1 m end at sqrt(2 h / g) (1 + e) / (1 - e) = 1.3546 s.
TEST(Zeno, ComesToRestInFiniteTimeAndFewEvents) {
  std::vector<scene::BodySpec> bodies{plane("floor", {0, 0, 0}, {0, 0, 1}),
                                      ball("ball", 0.1, 1.0, {0, 0, 1.1}, Vector3d::Zero())};
  bodies[1].restitution = 0.5;
  for (const char* engine : kEventEngines) {
    const Trajectory run = run_by(engine, scene_of(bodies, 3.0, Vector3d(0, 0, -9.81)));
    EXPECT_EQ(run.stopped_by, "") << engine;
    ASSERT_LT(run.events.size(), 60U) << engine;
    ASSERT_EQ(run.events.back().kind, EventKind::kRest) << engine;
    // s: the bounces below the restitution threshold of 1e-3 m/s would take another 4e-4
    EXPECT_NEAR(run.events.back().time, std::sqrt(2.0 / 9.81) * 3.0, 1e-3) << engine;
    EXPECT_EQ(run.frames.back().poses[1].velocity_world.norm(), 0.0);
    EXPECT_NEAR(run.frames.back().poses[1].com_world.z(), 0.1, 1e-12);
  }
}

// Other bodies move on while it comes to rest: global virtual time passes the instant at which its
// bounces accumulate, and the run ends.
TEST(Zeno, AmongOtherMoversDoesNotHoldUpGlobalVirtualTime) {
  const double gathers = std::sqrt(2.0 / 9.81) * 3.0;  // s: 1.3546
  std::vector<scene::BodySpec> bodies{plane("floor", {0, 0, 0}, {0, 0, 1}),
                                      ball("ball", 0.1, 1.0, {0, 0, 1.1}, Vector3d::Zero())};
  bodies[1].restitution = 0.5;
  for (int i = 0; i < 6; ++i)
    bodies.push_back(ball("other" + std::to_string(i), 0.1, 1.0,
                          {2.0 + 0.5 * (i % 3), 0.5 * (i / 3), 0.5 + 0.1 * i},
                          {i % 3 == 0 ? 0.3 : -0.3, 0, 0}));
  const scene::Scene scene = scene_of(bodies, 3.0, Vector3d(0, 0, -9.81));
  const Trajectory reference = run_by("ordered", scene);
  for (const int threads : {1, 2}) {
    VirtualTimes times;
    TrajectoryRecorder recorder;
    engines::RunOptions options;
    options.engine = "tw";
    options.timewarp = engines::fast_timewarp(&times);
    options.threads = threads;
    engines::run_scene(scene, test_laws(), options, recorder);
    EXPECT_EQ(difference(reference, recorder.trajectory()), "") << threads << " threads";
    EXPECT_EQ(recorder.trajectory().frames.back().time, 3.0) << threads << " threads";
    const std::vector<Event>& events = recorder.trajectory().events;
    const auto of_ball = [](const Event& event) { return event.body_a == 1 || event.body_b == 1; };
    EXPECT_LT(std::count_if(events.begin(), events.end(), of_ball), 60) << threads << " threads";
    const auto rest = std::find_if(events.begin(), events.end(), [&](const Event& event) {
      return event.kind == EventKind::kRest && of_ball(event);
    });
    ASSERT_NE(rest, events.end()) << threads << " threads";
    EXPECT_NEAR(rest->time, gathers, 1e-3) << threads << " threads";  // s: as above
    EXPECT_GT(
        std::count_if(events.begin(), events.end(),
                      [&](const Event& event) { return !of_ball(event) && event.time > gathers; }),
        10)
        << threads << " threads";
    EXPECT_LT(times.moves.front().global_virtual_time_s, gathers) << threads << " threads";
    EXPECT_GT(times.moves.back().global_virtual_time_s, 2.0 * gathers) << threads << " threads";
  }
}

TEST(ZeroLookAhead, IsOrderedByMicrostepAndAnEndlessChainIsReported) {
  // A ball that fills the space between two walls bounces between them without time passing.
  std::vector<scene::BodySpec> bodies{plane("left", {-0.125, 0, 0}, {1, 0, 0}),
                                      plane("right", {0.125, 0, 0}, {-1, 0, 0}),
                                      ball("ball", 0.125, 1.0, {0, 0, 0}, {1, 0, 0})};
  for (const char* engine : kEventEngines) {
    const Trajectory run = run_by(engine, scene_of(bodies, 1.0));
    EXPECT_NE(run.stopped_by.find("time stands still"), std::string::npos)
        << engine << ": " << run.stopped_by;
    EXPECT_NE(run.stopped_by.find("'ball'"), std::string::npos) << engine << ": " << run.stopped_by;
    EXPECT_NE(run.stopped_by.find("need \"contact\": {} in the scene"), std::string::npos)
        << engine << ": " << run.stopped_by;
  }
}

// The sink refuses what lies before earlier output: a commit is final.
class OrderOfCommits final : public TrajectorySink {
 public:
  void begin(const TrajectoryInfo&, const std::vector<TrajectoryBody>&) override {}
  void frame(const Frame& frame) override { take(frame.time); }
  void event(const Event& event) override { take(event.time); }
  void end(const Counters&, const std::string&) override {}
  double last = 0.0;
  long backward = 0, taken = 0;

 private:
  void take(double t) {
    backward += t < last ? 1 : 0;
    last = std::max(last, t);
    ++taken;
  }
};

TEST(CommitSafety, NothingIsCommittedThatIsRolledBack) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    OrderOfCommits sink;
    engines::RunOptions options;
    options.engine = "tw";
    options.timewarp = engines::fast_timewarp();
    options.faults = {seed, true, 0.3, 7, 0.2};
    engines::run_scene(sized("gas", 100, 2.0), test_laws(), options, sink);
    EXPECT_GT(sink.taken, 400);
    EXPECT_EQ(sink.backward, 0) << "seed " << seed;
  }
}

// From the record of each change, on one thread and two, with random execution order and forced
// rollbacks.
TEST(CommitSafety, GlobalVirtualTimeNeverFalls) {
  for (const int threads : {1, 2})
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      VirtualTimes times;
      OrderOfCommits sink;
      engines::RunOptions options;
      options.engine = "tw";
      options.timewarp = engines::fast_timewarp(&times);
      options.threads = threads;
      options.faults = {seed, true, 0.3, 7, 0.2};
      engines::run_scene(sized("gas", 60, 1.0), test_laws(), options, sink);
      ASSERT_GT(times.moves.size(), 500U);
      int back = 0, fallen = 0;
      for (std::size_t k = 1; k < times.moves.size(); ++k) {
        back += times.moves[k].to_s < times.moves[k].from_s ? 1 : 0;
        fallen +=
            times.moves[k].global_virtual_time_s < times.moves[k - 1].global_virtual_time_s ? 1 : 0;
      }
      EXPECT_GT(back, 20) << threads << " threads, seed " << seed;
      EXPECT_EQ(fallen, 0) << threads << " threads, seed " << seed;
    }
}

// How many moves are known at each frame.
class MovesAtFrames final : public TrajectorySink {
 public:
  explicit MovesAtFrames(const VirtualTimes& times) : times_(times) {}
  void begin(const TrajectoryInfo&, const std::vector<TrajectoryBody>&) override {}
  void frame(const Frame&) override { counts.push_back(times_.moves.size()); }
  void event(const Event&) override {}
  void end(const Counters&, const std::string&) override {}

  std::vector<std::size_t> counts;

 private:
  const VirtualTimes& times_;
};

// A page draws them while the run goes; the moves of one ball are few.
TEST(VirtualTimes, OfTheFastSchedulerAreKnownWhileItRuns) {
  for (const int bodies : {1, 60})
    for (const int threads : {1, 2}) {
      VirtualTimes times;
      MovesAtFrames sink(times);
      engines::RunOptions options;
      options.engine = "tw";
      options.timewarp = engines::fast_timewarp(&times);
      options.threads = threads;
      engines::run_scene(sized("gas", bodies, 5.0), test_laws(), options, sink);
      ASSERT_GT(sink.counts.size(), 10U);
      EXPECT_GT(sink.counts[sink.counts.size() / 2], 0U) << bodies << " on " << threads;
      EXPECT_LT(sink.counts[sink.counts.size() / 2], times.moves.size()) << bodies;
      EXPECT_TRUE(std::is_sorted(sink.counts.begin(), sink.counts.end()));
    }
}

// More than 10^5 impacts, each of which moves two local virtual times or one, and advances between.
TEST(VirtualTimesOfALongRun, AreTheFirstOnesInEpochsToo) {
  VirtualTimes times;
  OrderOfCommits sink;
  engines::RunOptions options;
  options.engine = "tw";
  options.timewarp = engines::fast_timewarp(&times);
  options.faults.regions = 2;
  options.frame_rate_hz = 1.0;
  engines::run_scene(sized("gas", 300, 250.0), test_laws(), options, sink);
  EXPECT_TRUE(times.is_cut);
  EXPECT_EQ(times.moves.size(), engines::kMostMoves);
  EXPECT_LT(times.moves.back().global_virtual_time_s, 250.0);
}

TEST(ElasticGas, KeepsItsEnergyAndNothingOverlapsAtAnyRedraw) {
  const Trajectory run = run_by("tw", sized("gas", 300, 250.0), {}, 1.0);
  ASSERT_GT(run.events.size(), 100000U);
  const double energy = run.frames.front().kinetic_energy;
  // Each collision rounds two velocities: a random walk of 1e5 steps of eps is 4e-14, a drift in
  // one direction 1e-11.
  for (const Frame& frame : run.frames) ASSERT_NEAR(frame.kinetic_energy, energy, 1e-10 * energy);
  for (const Frame& frame : run.frames) {
    double smallest = 1.0;
    for (std::size_t i = 6; i < frame.poses.size(); ++i)  // after the six walls
      for (std::size_t j = i + 1; j < frame.poses.size(); ++j)
        smallest =
            std::min(smallest, (frame.poses[i].com_world - frame.poses[j].com_world).norm() - 0.2);
    EXPECT_GE(smallest, 0.0);
    EXPECT_LE(frame.smallest_gap, smallest);
    EXPECT_GE(frame.smallest_gap, 0.0);
  }
}

// Retroactive detection steps by the laws' own integrator; before chaos it finds the same impacts.
TEST(Engines, AgreeOverTheFirstFiveCollisionsOfEachBody) {
  const scene::Scene scene = sized("gas", 60, 2.0);
  const Trajectory by_events = run_by("tw", scene), by_steps = run_by("rd", scene);
  std::vector<std::vector<double>> expected(by_events.bodies.size()), found = expected;
  for (const auto& [run, times] : {std::pair{&by_events, &expected}, std::pair{&by_steps, &found}})
    for (const Event& event : run->events)
      for (const int body : {event.body_a, event.body_b})
        (*times)[static_cast<std::size_t>(body)].push_back(event.time);
  std::size_t compared = 0;
  for (std::size_t i = 6; i < expected.size(); ++i)
    for (std::size_t k = 0; k < std::min({expected[i].size(), found[i].size(), std::size_t{5}});
         ++k, ++compared)
      EXPECT_NEAR(expected[i][k], found[i][k], 1e-6) << "collision " << k << " of body " << i;
  EXPECT_GT(compared, 200U);
}

// With closed forms retroactive detection computes the same flights: rotating molecules collide at
// the same times, much longer than with RK4.
TEST(Engines, AgreeOnTumblingSolidsWhereRetroactiveDetectionGoesInClosedFormToo) {
  const scene::Scene scene = sized("atoms", 30, 1.0);
  const Trajectory expected = run_by("tw", scene);
  TrajectoryRecorder recorder;
  engines::RunOptions options;
  options.propagator = "auto";
  engines::run_scene(scene, test_laws(), options, recorder);
  const Trajectory& found = recorder.trajectory();
  ASSERT_GE(expected.events.size(), 60U);
  for (std::size_t k = 0; k < 60; ++k) {
    // s: roundings, grown tenfold a collision at most
    EXPECT_NEAR(found.events[k].time, expected.events[k].time, 1e-9) << "event " << k;
    EXPECT_EQ(found.events[k].body_a, expected.events[k].body_a) << "event " << k;
    EXPECT_EQ(found.events[k].body_b, expected.events[k].body_b) << "event " << k;
  }
}

TEST(Engines, FollowAShakenPlaneAndABallAtRest) {
  std::vector<scene::BodySpec> bodies{plane("shaken", {0, 0, 0}, {0, 0, 1}),
                                      plane("still", {0, 0, -3}, {0, 0, 1})};
  bodies[0].motion = scene::PrescribedMotion{Vector3d::Zero(), Vector3d(0, 0, 0.02), 20.0};
  for (int i = 0; i < 4; ++i)
    bodies.push_back(
        ball("ball" + std::to_string(i), 0.1, 1.0, {0.5 * i, 0, 0.4 + 0.1 * i}, Vector3d::Zero()));
  expect_the_references_trace(scene_of(bodies, 3.0, Vector3d(0, 0, -9.81)), 10);
}

// ---- w h ---------------------------------------------------------------------------------------

// A ball between two walls at 1.8 m/s with 1.8 m for its centre: a bounce each second, the first at
// 0.5 s. In 10 s that is D = 10, and w h = 2 D h / T.
TEST(DiscontinuitiesPerBodyAndStep, OfABallBetweenTwoWallsAreTwoForEachBounceInEveryEngine) {
  const std::vector<scene::BodySpec> bodies{plane("left", {-1, 0, 0}, {1, 0, 0}),
                                            plane("right", {1, 0, 0}, {-1, 0, 0}),
                                            ball("ball", 0.1, 1.0, {0, 0, 0}, {1.8, 0, 0})};
  for (const double step : {1.0 / 30.0, 1.0 / 240.0}) {
    scene::Scene scene = scene_of(bodies, 10.0);
    scene.step_s = step;
    for (const char* engine : {"rd", "ordered", "ca", "tw"}) {
      const Trajectory run = run_by(engine, scene);
      EXPECT_EQ(run.counters.counts.at("discontinuities"), 10U) << engine;
      EXPECT_DOUBLE_EQ(engines::discontinuities_a_body_and_step(run), 2.0 * step) << engine;
    }
  }
}

TEST(DiscontinuitiesPerBodyAndStep, OfManyBallsAreTheSameInEveryEngine) {
  const scene::Scene scene = sized("gas", 60, 1.0);
  const Trajectory reference = run_by("ordered", scene);
  const double w_h = engines::discontinuities_a_body_and_step(reference);
  // only impacts, in one second
  EXPECT_DOUBLE_EQ(w_h, 2.0 * static_cast<double>(reference.events.size()) * scene.step_s / 60.0);
  for (const char* engine : {"rd", "ca", "tw"})
    EXPECT_DOUBLE_EQ(engines::discontinuities_a_body_and_step(run_by(engine, scene)), w_h)
        << engine;
}

TEST(DiscontinuitiesPerBodyAndStep, CountAnImpactOnceForAnyNumberOfImpulsesAndNoContactOfTheStart) {
  const auto event = [](double time, EventKind kind, int a, int b) {
    return Event{time, kind, a, b, Vector3d::Zero(), Vector3d::UnitZ(), 0.0, 0.0};
  };
  TrajectoryRecorder recorder;
  engines::DiscontinuityCount count(recorder);
  count.begin({}, {});
  count.event(event(0.0, EventKind::kContact, 0, 1));  // in contact from the start
  // one impact on a pair of touching bodies, passed back and forth
  count.event(event(0.5, EventKind::kCollision, 0, 2));
  count.event(event(0.5, EventKind::kCollision, 2, 3));
  count.event(event(0.5, EventKind::kCollision, 0, 2));
  count.event(event(0.5, EventKind::kCollision, 2, 3));
  count.event(event(0.5, EventKind::kContact, 0, 2));  // no rebound: the same discontinuity
  count.event(event(0.0, EventKind::kSlide, 0, 1));    // slides from the start
  // counted separately: no engine ends a step of all bodies for it
  count.event(event(0.75, EventKind::kStick, 0, 2));
  count.event(event(0.75, EventKind::kBreak, 0, 2));
  count.event(event(0.8, EventKind::kCollision, 0, 2));  // again, later
  count.event(event(0.9, EventKind::kSleep, 0, -1));
  count.end({}, "");
  EXPECT_EQ(recorder.trajectory().events.size(), 11U);  // all are passed on
  EXPECT_EQ(recorder.trajectory().counters.counts.at("discontinuities"), 4U);
  EXPECT_EQ(recorder.trajectory().counters.counts.at("sliding_changes"), 1U);
}

// A point has no size from which a grid could follow; only the floor can be hit.
TEST(Engines, TakeOneBodyNoneAndOneWithoutSize) {
  for (const char* engine : kEventEngines) {
    EXPECT_EQ(run_by(engine, scene_of({plane("floor", {0, 0, 0}, {0, 0, 1})}, 0.5)).frames.size(),
              31U)
        << engine;
    const Trajectory run =
        run_by(engine, scene_of({plane("floor", {0, 0, 0}, {0, 0, 1}),
                                 ball("point", 0.0, 1.0, {0, 0, 1}, Vector3d::Zero())},
                                1.0, Vector3d(0, 0, -9.81)));
    ASSERT_EQ(run.events.size(), 1U) << engine;
    EXPECT_NEAR(run.events[0].time, std::sqrt(2.0 / 9.81), 1e-15) << engine;
  }
}

// A row of more bodies than are compared pair by pair in a frame (200), none of which has a size.
TEST(Engines, MeasureTheSmallestGapOfManyPointMasses) {
  std::vector<scene::BodySpec> bodies;
  for (int i = 0; i < 201; ++i)
    bodies.push_back(ball("point" + std::to_string(i), 0.0, 1.0, {0.125 * i, 0, 0}, {0, 0, 1}));
  for (const char* engine : kEventEngines) {
    const Trajectory run = run_by(engine, scene_of(bodies, 0.02), {}, 100.0);
    ASSERT_EQ(run.frames.size(), 3U) << engine;
    // exact: differences of multiples of 1/8
    for (const Frame& frame : run.frames) EXPECT_EQ(frame.smallest_gap, 0.125) << engine;
  }
}

// Islands with their own local virtual times have no common step at whose end they could fall
// asleep.
TEST(Engines, RefuseSleepAndSaySo) {
  scene::Scene scene = scene_of(
      {ball("ball", 0.1, 1.0, {0, 0, 1}, Vector3d::Zero()), plane("floor", {0, 0, 0}, {0, 0, 1})},
      1.0);
  scene.contact = scene::ContactSpec{};
  scene.contact->sleep = true;
  Laws laws = test_laws();  // sleep is refused before a law of contacts is needed
  laws.ends_in_contact = [](double, double, double) { return true; };
  laws.contact_forces = [](const MatrixXd&, const VectorXd& b) {
    return VectorXd(VectorXd::Zero(b.size()));
  };
  for (const char* engine : kEventEngines) {
    try {
      run_by(engine, scene, {}, 60.0, laws);
      FAIL() << engine << " took a scene with sleep";
    } catch (const UserError& error) {
      EXPECT_NE(std::string(error.what()).find("\"sleep\""), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find("--engine rd"), std::string::npos) << error.what();
    }
  }
}

// Six bodies that do not bounce fly at each other, turning, without persistent contacts.
scene::Scene cluster(std::uint64_t seed) {
  Random random(seed);
  const auto vector = [&](double most) {
    return Vector3d(random.between(-most, most), random.between(-most, most),
                    random.between(-most, most));
  };
  std::vector<scene::BodySpec> bodies;
  for (int k = 0; k < 6; ++k) {
    const Vector3d place = (k % 2 == 0 ? 1.2 : -1.2) * Vector3d::Unit(k / 2) + vector(0.2);
    bodies.push_back(ball("body" + std::to_string(k), random.between(0.25, 0.35), 1.0, place,
                          -1.2 * place + vector(0.3)));
    if (k == 1 || k == 2)
      bodies.back().shape = scene::ModelSpec{
          test::source_dir() + (k == 1 ? "/models/l_shape.3ds" : "/models/rock_2.3ds"), "", 0.25};
    bodies.back().mass_kg = random.between(0.4, 6.0);
    bodies.back().omega_world_rad_s = vector(4.0);
    bodies.back().restitution = 0.0;
  }
  scene::Scene scene = scene_of(std::move(bodies), 0.7);
  scene.step_s = 1.0 / 240.0;
  return scene;
}

// They press each other, meet within microseconds, and are sent apart at a millimetre a second:
// time goes on, and what lies between two impacts is found in few looks at gaps.
TEST(BodiesThatDoNotBounce, MeetAndPartWithoutStandingStill) {
  int clusters = 0;
  for (const std::uint64_t seed : {13, 16}) {
    const scene::Scene scene = cluster(seed);
    for (const std::string engine : {"rd", "ordered"}) {
      const Trajectory run = run_by(engine, scene);
      EXPECT_EQ(run.stopped_by, "") << "seed " << seed << ", " << engine;
      clusters += run.events.size() > 300 ? 1 : 0;
      // Ten or so pairs are searched after each, few of them for long (256 looks and some): 150 to
      // 500 at each. Bounds of fixed normals alone take 2000.
      EXPECT_LT(run.counters.counts.at("gap_evaluations"), 700 * run.events.size())
          << "seed " << seed << ", " << engine;
    }
  }
  EXPECT_EQ(clusters, 4) << "the lot does not try what it is about";
}

}  // namespace
}  // namespace tumble::testing
