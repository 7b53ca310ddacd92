// The teaching timewarp: with right decisions it commits the reference's trace; with wrong ones it
// stops with a message and never crashes.
#include <gtest/gtest.h>

#include "tests/support/places.h"
#include "framework/engines/run.h"
#include "framework/scene/load_scene.h"
#include "tests/engines/driven_scenes.h"
#include "tests/engines/event_process_scenes.h"
#include "tests/engines/failing_steps.h"
#include "tests/engines/taught_laws.h"

namespace tumble::testing {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Trajectory run_taught(const scene::Scene& scene, const Laws& laws,
                      const std::vector<engines::Callback>& callbacks = {},
                      const std::string& engine = "tw") {
  TrajectoryRecorder recorder;
  engines::RunOptions options;
  options.engine = engine;
  options.callbacks = callbacks;
  engines::run_scene(scene, laws, options, recorder);
  return recorder.trajectory();
}

std::string stop_of(const Laws& laws) { return run_taught(sized("gas", 10, 1.5), laws).stopped_by; }

TEST(TaughtTimewarp, CommitsTheReferencesTrace) {
  for (const auto& [name, n, duration, least] :
       {std::tuple("gas", 30, 2.0, 100), {"pong", 10, 3.0, 20}, {"atoms", 15, 0.7, 10}}) {
    const scene::Scene scene = sized(name, n, duration);
    const Trajectory reference = run_by("ordered", scene), run = run_taught(scene, taught_laws());
    ASSERT_GT(reference.events.size(), static_cast<std::size_t>(least)) << name;
    EXPECT_EQ(difference(reference, run), "") << name;
  }
}

// ---- Groups and callbacks ----------------------------------------------------------------------

void expect_the_references_trace_of(const scene::Scene& scene, std::size_t least,
                                    const std::vector<engines::Callback>& callbacks = {}) {
  const Trajectory reference = run_taught(scene, taught_reference_laws(), callbacks, "ordered"),
                   run = run_taught(scene, taught_reference_laws(), callbacks);
  ASSERT_EQ(reference.stopped_by, "") << scene.name;
  ASSERT_GE(reference.events.size(), least) << scene.name;
  EXPECT_EQ(difference(reference, run), "") << scene.name;
}

TEST(TaughtTimewarp, CommitsTheReferencesTraceOfLinkedBodies) {
  expect_the_references_trace_of(pendula_and_balls(5, 0.9), 10);
  expect_the_references_trace_of(sized("cars", 4, 0.3), 0);
}

// A ball that a wall, and one that a plane from below, wakes from its rest.
TEST(TaughtTimewarp, CommitsTheReferencesTraceOfADrivenBodyThatMeetsABallAtRest) {
  expect_the_references_trace_of(
      ball_and_driven(driven(wall_with_face_at(-0.4), {1.0, 0, 0}), 0.0, 0.32), 4);
  expect_the_references_trace_of(
      ball_and_driven(driven(plane("plane", {0, 0, -0.1}, Vector3d::UnitZ()), {0, 0, 0.5}), 0.0,
                      0.3),
      4);
}

// The step of an island that fails is computed ahead; an impact before it makes it never count.
TEST(TaughtTimewarp, GoesOnWhereAnImpactPreventsAFailingStep) {
  for (const double met_at : {0.45, 0.485, 0.495}) {
    const scene::Scene scene = pushed_carts(1, met_at, 0.8);
    const Laws laws = with_failing_steps(taught_laws());
    const Trajectory reference = run_taught(scene, laws, {}, "ordered"),
                     run = run_taught(scene, laws);
    ASSERT_EQ(reference.stopped_by, "") << met_at;
    EXPECT_EQ(difference(reference, run), "") << met_at;
  }
}

// What steps have noted counts where they stand: not of those that an impact prevents, and of all
// those in which a cube turns 4 rad, 32 of them.
TEST(TaughtTimewarp, CountsTheFaultsOfStepsThatStand) {
  const Laws laws = with_spinning_steps(taught_laws());
  for (const double met_at : {0.45, 0.485, 0.495}) {
    const scene::Scene scene = pushed_cube(met_at, 0.8);
    const Trajectory reference = run_taught(scene, laws, {}, "ordered"),
                     run = run_taught(scene, laws);
    ASSERT_EQ(reference.stopped_by, "") << met_at;
    ASSERT_EQ(faults_of(reference), "") << met_at;
    EXPECT_EQ(difference(reference, run), "") << met_at;
  }
  scene::Scene scene = pushed_cube(5.0, 0.5);
  scene.bodies[0].omega_world_rad_s = {255.0, 0.0, 0.0};
  const Trajectory reference = run_taught(scene, taught_laws(), {}, "ordered"),
                   run = run_taught(scene, taught_laws());
  ASSERT_EQ(reference.counters.faults.size(), 1U) << faults_of(reference);
  EXPECT_EQ(reference.counters.faults[0].count, 32U);
  EXPECT_EQ(difference(reference, run), "");
}

// Checks may be due as late as a scheduler likes: that of the ball comes after the callback here,
// which cannot act on a cart whose step has failed.
TEST(TaughtTimewarp, ACallbackAfterAFailingStepWaitsForTheImpactThatPreventsIt) {
  Laws laws = with_failing_steps(taught_laws());
  laws.scheduling.on_collision_check = [right = laws.scheduling.on_collision_check](
                                           const ScheduledEvent& event, const CheckFinding& finding,
                                           double step) {
    CheckDecision decision = right(event, finding, step);
    if (!decision.collides) decision.next.stamp.time += 0.1;
    return decision;
  };
  for (const double met_at : {0.45, 0.485, 0.495})
    for (const double called_at : {0.5, 0.51, 0.53, 0.56, 0.6}) {
      SCOPED_TRACE(std::to_string(met_at) + " s, callback at " + std::to_string(called_at) + " s");
      const scene::Scene scene = pushed_carts(1, met_at, 0.8);
      const std::vector<engines::Callback> kick{
          {called_at, {0}, [](int, RigidBodyState& state) { state.momentum_world.z() += 0.1; }}};
      const Trajectory reference = run_taught(scene, laws, kick, "ordered");
      ASSERT_EQ(reference.stopped_by, "");
      EXPECT_EQ(difference(reference, run_taught(scene, laws, kick)), "");
    }
  // nothing prevents it
  const Trajectory run =
      run_taught(pushed_carts(1, 5.0, 0.8), laws,
                 {{0.6, {0}, [](int, RigidBodyState& state) { state.momentum_world.z() += 0.1; }}});
  EXPECT_NE(run.stopped_by.find("at t = 0.500000 s, body 'cart0'"), std::string::npos)
      << run.stopped_by;
}

// The first cart has no step from 0.5 s on, the second none from 0.75 s. With a scheduler to which
// nothing is ever certain both callbacks wait until nothing else is left.
TEST(TaughtTimewarp, OfCallbacksThatWaitTheOneWhoseStepFailsFirstStopsTheRun) {
  Laws laws = with_failing_steps(taught_laws());
  laws.scheduling.global_virtual_time = [](const std::vector<LocalTime>&,
                                           const std::vector<ScheduledEvent>&) { return 0.0; };
  const auto kick = [](int, RigidBodyState& state) { state.momentum_world.z() += 0.1; };
  const Trajectory run =
      run_taught(pushed_carts(2, 5.0, 1.0), laws, {{0.8, {1}, kick}, {0.85, {0}, kick}});
  EXPECT_NE(run.stopped_by.find("at t = 0.500000 s, body 'cart0'"), std::string::npos)
      << run.stopped_by;
}

// Towers fuse, are hit and come apart; dominoes fall; an arm throws its block; rocks roll.
TEST(TaughtTimewarp, CommitsTheReferencesTraceOfGroupsInContact) {
  const Trajectory tower = run_taught(tower_and_projectile(5.0), taught_reference_laws());
  EXPECT_GT(tower.counters.counts.at("rollbacks"), 0U);
  expect_the_references_trace_of(tower_and_projectile(5.0), 15);
  expect_the_references_trace_of(sized("dominoes_row", 4, 0.5), 5);
  expect_the_references_trace_of(sized("robots", 1, 0.5), 1);
  expect_the_references_trace_of(sized("avalanche", 6, 0.6), 5);
}

TEST(TaughtTimewarp, CommitsTheReferencesTraceWithCallbacks) {
  const std::vector<engines::Callback> kicks{
      {0.21, {0, 1, 4}, [](int, RigidBodyState& state) { state.momentum_world.y() += 0.3; }},
      {0.21, {2}, [](int, RigidBodyState& state) { state.momentum_world.x() -= 0.2; }},
      {0.5017, {3}, [](int, RigidBodyState& state) { state.momentum_world.z() += 0.2; }}};
  expect_the_references_trace_of(pendula_and_balls(4, 0.8), 10, kicks);
  std::vector<int> all;
  const scene::Scene gas = sized("gas", 20, 1.0);
  for (int i = 0; i < static_cast<int>(gas.bodies.size()); ++i)
    if (!gas.bodies[static_cast<std::size_t>(i)].immovable) all.push_back(i);
  expect_the_references_trace_of(gas, 60, {{0.31, all, [](int body, RigidBodyState& state) {
                                              state.momentum_world +=
                                                  Vector3d(0.1, 0.02 * (body % 5), -0.1);
                                            }}});
  expect_the_references_trace_of(
      tower_and_projectile(5.0), 15,
      {{0.3, {2}, [](int, RigidBodyState& state) { state.momentum_world.z() += 1.0; }}});
}

TEST(TaughtTimewarp, StopsWhereGroupsAreWrong) {
  Laws laws = taught_reference_laws();
  laws.scheduling.contact_groups = [](const std::vector<std::int32_t>& bodies,
                                      const std::vector<GroupContact>&) {
    return std::vector<std::vector<std::int32_t>>{bodies};
  };
  EXPECT_NE(run_taught(tower_and_projectile(5.0), laws).stopped_by.find("contact_groups makes {"),
            std::string::npos);
  laws = taught_reference_laws();
  laws.scheduling.on_group_check = [right = laws.scheduling.on_group_check](
                                       const ScheduledEvent& event,
                                       const std::vector<GroupContact>& contacts, double step) {
    GroupDecision decision = right(event, contacts, step);
    if (decision.groups.size() > 1) decision.groups.pop_back();
    return decision;
  };
  EXPECT_NE(run_taught(tower_and_projectile(5.0), laws).stopped_by.find("on_group_check makes {"),
            std::string::npos);
  laws = taught_reference_laws();
  // a group for ever
  laws.scheduling.on_group_check = [](const ScheduledEvent& event, const std::vector<GroupContact>&,
                                      double step) {
    ScheduledEvent next = event;
    next.safe_time = event.stamp.time;
    next.stamp.time += step;
    return GroupDecision{false, {}, {}, next};
  };
  EXPECT_NE(run_taught(tower_and_projectile(5.0), laws).stopped_by, "");
}

// For any answer about groups and callbacks, the run ends with a message.
TEST(TaughtTimewarp, ToleratesAnyAnswerAboutGroups) {
  scene::Scene scene = tower_and_projectile(5.0);
  scene.duration_s = 0.3;
  const std::vector<engines::Callback> kick{
      {0.15, {1}, [](int, RigidBodyState& state) { state.momentum_world.z() += 0.5; }}};
  for (const double time : {-1.0, 0.0, 0.12, 1e9, kInfinity, -kInfinity, kUnset}) {
    Laws laws = taught_reference_laws();
    laws.scheduling.on_group_check = [right = laws.scheduling.on_group_check, time](
                                         const ScheduledEvent& event,
                                         const std::vector<GroupContact>& contacts, double step) {
      GroupDecision decision = right(event, contacts, step);
      decision.next.stamp.time = decision.next.safe_time = time;
      return decision;
    };
    EXPECT_NE(run_taught(scene, laws, kick).stopped_by, "") << time;
    laws = taught_reference_laws();
    laws.scheduling.on_group_check = [right = laws.scheduling.on_group_check, time](
                                         const ScheduledEvent& event,
                                         const std::vector<GroupContact>& contacts, double step) {
      GroupDecision decision = right(event, contacts, step);
      for (Rollback& rollback : decision.rollbacks) rollback.stamp.time = time;
      return decision;
    };
    EXPECT_NE(run_taught(scene, laws, kick).stopped_by, "") << time;
    laws = taught_reference_laws();
    laws.scheduling.on_callback = [time](const ScheduledEvent& event,
                                         const std::vector<LocalTime>&) {
      return std::vector<Rollback>{{event.receivers.front(), {time, 0, WorkKind::kCallback, 0, -1}},
                                   {1000, event.stamp}};
    };
    EXPECT_NE(run_taught(scene, laws, kick).stopped_by, "") << time;
  }
  for (const std::vector<std::vector<std::int32_t>>& groups :
       {std::vector<std::vector<std::int32_t>>{}, {{}}, {{-7}}, {{1000, 1}}, {{1}, {1}}}) {
    Laws laws = taught_reference_laws();
    laws.scheduling.contact_groups = [groups](const std::vector<std::int32_t>&,
                                              const std::vector<GroupContact>&) { return groups; };
    EXPECT_NE(run_taught(scene, laws).stopped_by, "");
  }
}

TEST(TaughtTimewarp, StopsWhereACallbackRollsBackNoBody) {
  Laws laws = taught_reference_laws();
  laws.scheduling.on_callback = [](const ScheduledEvent&, const std::vector<LocalTime>&) {
    return std::vector<Rollback>{};
  };
  const std::vector<engines::Callback> kick{
      {0.213, {0, 1}, [](int, RigidBodyState& state) { state.momentum_world.y() += 0.3; }}};
  const std::string stop = run_taught(pendula_and_balls(2, 0.4), laws, kick).stopped_by;
  EXPECT_NE(stop.find("a callback acts on"), std::string::npos) << stop;
  EXPECT_NE(stop.find("was not rolled back"), std::string::npos) << stop;
}

TEST(TaughtTimewarp, RecordsVirtualTimes) {
  const Trajectory run = run_taught(sized("gas", 10, 1.5), taught_laws());
  ASSERT_EQ(run.virtual_times.processes.size(), 10U);
  std::vector<double> local(10, 0.0);
  double gvt = 0.0;
  std::size_t back = 0;
  for (const VirtualTimes::Move& move : run.virtual_times.moves) {
    EXPECT_EQ(move.from_s, local[static_cast<std::size_t>(move.process)]);
    EXPECT_GE(move.global_virtual_time_s, gvt);
    EXPECT_GE(move.to_s, gvt);  // no rollback to before global virtual time
    local[static_cast<std::size_t>(move.process)] = move.to_s;
    gvt = move.global_virtual_time_s;
    back += move.to_s <= move.from_s ? 1 : 0;
  }
  EXPECT_EQ(back, run.counters.counts.at("rollbacks"));
  EXPECT_EQ(gvt, 1.5);
}

// Two balls that never meet, in 30,000 steps each: more moves than are recorded (50,000).
TEST(TaughtTimewarp, RecordsTheFirstVirtualTimesOfALongRunAndSaysThatThereAreMore) {
  scene::Scene scene = scene_of(
      {ball("A", 0.1, 1.0, {0, 0, 0}, {-1, 0, 0}), ball("B", 0.1, 1.0, {1, 0, 0}, {1, 0, 0})}, 0.3);
  scene.step_s = 1e-5;
  const Trajectory run = run_taught(scene, taught_laws());
  ASSERT_EQ(run.stopped_by, "");
  const VirtualTimes& times = run.virtual_times;
  EXPECT_TRUE(times.is_cut);
  ASSERT_LT(times.moves.size(), run.counters.counts.at("integrations"));
  // that of this move, and not the last of the run
  EXPECT_LE(times.moves.back().global_virtual_time_s, times.moves.back().to_s);
  EXPECT_FALSE(run_taught(sized("gas", 10, 0.1), taught_laws()).virtual_times.is_cut);
}

// Ends the run by an exception of its own at a beat.
class EndsAtABeat final : public TrajectorySink {
 public:
  struct Ended {};
  void begin(const TrajectoryInfo&, const std::vector<TrajectoryBody>&) override {}
  void frame(const Frame&) override { ++frames; }
  void event(const Event&) override {}
  void end(const Counters&, const std::string&) override {}
  void beat(double time_s) override {
    if (time_s > 0.5) throw Ended{};
    ++beats;
  }
  int frames = 0, beats = 0;
};

TEST(TaughtTimewarp, TellsHowFarTheReferenceIsAndMayBeEndedInIt) {
  EndsAtABeat sink;
  engines::RunOptions options;
  options.engine = "tw";
  options.frame_rate_hz = 10.0;
  EXPECT_THROW(engines::run_scene(sized("gas", 10, 1.5), taught_laws(), options, sink),
               EndsAtABeat::Ended);
  EXPECT_EQ(sink.frames, 0);
  EXPECT_EQ(sink.beats, 6);  // at 0, 0.1, ..., 0.5 s
}

TEST(TaughtTimewarp, StopsWhereAnImpactIsLost) {
  Laws laws = taught_laws();
  lose_impacts_after(0.5, laws);
  const std::string stop = stop_of(laws);
  EXPECT_NE(stop.find("is missing: expected"), std::string::npos) << stop;
}

// The law of impulses fails once, in the reference, which runs first: what comes later is compared
// with nothing.
TEST(TaughtTimewarp, SaysWhereTheReferenceStoppedAndNotThatAllIsItsOwn) {
  Laws laws = taught_laws();
  int left = 10;
  laws.collision_impulse = [right = laws.collision_impulse, &left](const Contact& contact,
                                                                   const Body& a, const Body& b,
                                                                   double restitution) {
    return --left == 0 ? kUnset : right(contact, a, b, restitution);
  };
  // a hundred impacts and more: CommitsTheReferencesTrace
  const Trajectory run = run_taught(sized("gas", 30, 2.0), laws);
  ASSERT_LT(left, 0);
  EXPECT_TRUE(run.stopped_by.starts_with("the ordered reference stopped: ")) << run.stopped_by;
  EXPECT_GT(run.events.size(), 10U);
  for (const std::string& notice : run.counters.notices)
    EXPECT_EQ(notice.find("committed trace"), std::string::npos) << notice;
}

TEST(TaughtTimewarp, StopsWhereAnAntiMessageIsMissing) {
  Laws laws = taught_laws();
  laws.scheduling.plan_rollback = [](const std::vector<Effect>&,
                                     const std::vector<Rollback>& first) { return first; };
  const Trajectory run = run_taught(
      scene::load_scene(test::source_dir() + "/assignments/a4_timewarp/scenes/late_hit.json"),
      laws);
  EXPECT_NE(run.stopped_by.find("anti-message"), std::string::npos)
      << "stopped by: " << run.stopped_by;
}

TEST(TaughtTimewarp, StopsWhereGlobalVirtualTimeIsTooLate) {
  Laws laws = taught_laws();
  laws.scheduling.global_virtual_time = [](const std::vector<LocalTime>& local_times,
                                           const std::vector<ScheduledEvent>&) {
    double least = kInfinity;
    for (const LocalTime& local : local_times) least = std::min(least, local.time);
    return least;
  };
  const std::string stop = stop_of(laws);
  EXPECT_NE(stop.find("global_virtual_time"), std::string::npos) << stop;
}

TEST(TaughtTimewarp, StopsWhereNothingBecomesCertain) {
  Laws laws = taught_laws();
  // due again at once
  laws.scheduling.on_collision_check = [](const ScheduledEvent& event, const CheckFinding&,
                                          double) {
    return CheckDecision{false, {}, event};
  };
  EXPECT_NE(stop_of(laws).find("still stands"), std::string::npos);
}

// A row of balls that fly along it side by side, each over the whole row in one step: all pairs are
// due for a check in it, and nothing is certain before all of these are done.
TEST(TaughtTimewarp, TakesManyChecksThatAreDueAtOnce) {
  constexpr int kBalls = 205;  // 20910 pairs
  std::vector<scene::BodySpec> bodies;
  for (int i = 0; i < kBalls; ++i)
    bodies.push_back(
        ball("ball" + std::to_string(i), 0.001, 1.0, {0.004 * i, 0, 0}, {100.0, 0, 0}));
  scene::Scene scene = scene_of(std::move(bodies), 0.01);
  scene.step_s = 0.01;
  const Trajectory run = run_taught(scene, taught_laws());
  EXPECT_EQ(run.stopped_by, "");
  EXPECT_GE(run.counters.counts.at("pair_checks"), 20910U);
}

// For any answer, the run ends with a message.
TEST(TaughtTimewarp, ToleratesAnyAnswer) {
  const std::vector<double> odd{-1.0, 0.0, 0.3, 1e9, kInfinity, -kInfinity, kUnset};
  for (const double time : odd) {
    Laws laws = taught_laws();
    laws.scheduling.on_collision_check = [right = laws.scheduling.on_collision_check, time](
                                             const ScheduledEvent& event,
                                             const CheckFinding& finding, double step) {
      CheckDecision decision = right(event, finding, step);
      decision.next.stamp.time = decision.next.safe_time = time;
      return decision;
    };
    EXPECT_NE(stop_of(laws), "") << time;
    laws = taught_laws();
    laws.scheduling.plan_rollback = [time](const std::vector<Effect>&,
                                           std::vector<Rollback> first) {
      for (Rollback& rollback : first) rollback.stamp.time = time;
      return first;
    };
    EXPECT_NE(stop_of(laws), "") << time;
    laws = taught_laws();
    laws.scheduling.global_virtual_time =
        [time](const std::vector<LocalTime>&, const std::vector<ScheduledEvent>&) { return time; };
    if (time > 0.5 || time != time)
      EXPECT_NE(stop_of(laws), "") << time;
    else
      stop_of(laws);
  }
  for (const std::int32_t body : {-1, 0, 3, 1000}) {  // a wall, an uninvolved ball, no body
    Laws laws = taught_laws();
    laws.scheduling.plan_rollback = [body](const std::vector<Effect>&,
                                           std::vector<Rollback> first) {
      for (Rollback& rollback : first) rollback.body = body;
      return first;
    };
    EXPECT_NE(stop_of(laws), "") << body;
  }
}

}  // namespace
}  // namespace tumble::testing
