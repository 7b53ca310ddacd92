// The teaching timewarp: on right decisions it commits what the reference commits; on wrong ones it stops, in words, and never crashes.
#include <gtest/gtest.h>

#include "assignments/a4_timewarp/a4_binding.h"
#include "framework/engines/run.h"
#include "framework/modules/load.h"
#include "framework/scene/load_scene.h"
#include "tests/engines/event_scenes.h"

namespace tumble::testing {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Impulses in other words than any solution, decisions the reference's.
Laws taught_laws() {
  modules::Registry registry;
  register_assignments(registry);
  Laws laws = test_laws();
  const auto file = std::filesystem::path(TUMBLE_BINARY_DIR) / "modules" / "a4_reference.so";
  a4::bind(*std::static_pointer_cast<const a4::Module>(modules::load_module(registry.find("a4"), file)), laws);
  return laws;
}

Trajectory run_taught(const scene::Scene& scene, const Laws& laws) {
  TrajectoryRecorder recorder;
  engines::RunOptions options;
  options.engine = "tw";
  engines::run_scene(scene, laws, options, recorder);
  return recorder.trajectory();
}

std::string stop_of(const Laws& laws) { return run_taught(sized("gas", 10, 1.5), laws).stopped_by; }

TEST(TaughtTimewarp, CommitsTheReferencesTrace) {
  for (const auto& [name, n, duration, least] : {std::tuple("gas", 30, 2.0, 100), {"pong", 10, 3.0, 20}, {"atoms", 15, 0.7, 10}}) {
    const scene::Scene scene = sized(name, n, duration);
    const Trajectory reference = run_by("ordered", scene), run = run_taught(scene, taught_laws());
    ASSERT_GT(reference.events.size(), static_cast<std::size_t>(least)) << name;
    EXPECT_EQ(difference(reference, run), "") << name;
  }
}

TEST(TaughtTimewarp, TellsVirtualTimes) {
  const Trajectory run = run_taught(sized("gas", 10, 1.5), taught_laws());
  ASSERT_EQ(run.virtual_times.processes.size(), 10U);
  std::vector<double> local(10, 0.0);
  double gvt = 0.0;
  std::size_t back = 0;
  for (const VirtualTimes::Move& move : run.virtual_times.moves) {
    EXPECT_EQ(move.from_s, local[static_cast<std::size_t>(move.process)]);
    EXPECT_GE(move.global_virtual_time_s, gvt);
    EXPECT_GE(move.to_s, gvt);   // nobody goes back to what is certain
    local[static_cast<std::size_t>(move.process)] = move.to_s;
    gvt = move.global_virtual_time_s;
    back += move.to_s <= move.from_s ? 1 : 0;
  }
  EXPECT_EQ(back, run.counters.counts.at("rollbacks"));
  EXPECT_EQ(gvt, 1.5);
}

TEST(TaughtTimewarp, StopsWhereAnImpactIsLost) {
  Laws laws = taught_laws();
  laws.scheduling.on_collision_check = [right = laws.scheduling.on_collision_check](const ScheduledEvent& event, CheckFinding finding, double step) {
    if (finding.contact && finding.contact->time > 0.5) finding.contact.reset();
    return right(event, finding, step);
  };
  const std::string stop = stop_of(laws);
  EXPECT_NE(stop.find("is missing: expected"), std::string::npos) << stop;
}

TEST(TaughtTimewarp, StopsWhereAnAntiMessageIsMissing) {
  Laws laws = taught_laws();
  laws.scheduling.plan_rollback = [](const std::vector<Effect>&, const std::vector<Rollback>& first) { return first; };
  const Trajectory run = run_taught(scene::load_scene(TUMBLE_SOURCE_DIR "/assignments/a4_timewarp/scenes/late_hit.json"), laws);
  EXPECT_NE(run.stopped_by.find("anti-message"), std::string::npos) << "stopped by: " << run.stopped_by;
}

TEST(TaughtTimewarp, StopsWhereGlobalVirtualTimeIsTooLate) {
  Laws laws = taught_laws();
  laws.scheduling.global_virtual_time = [](const std::vector<LocalTime>& local_times, const std::vector<ScheduledEvent>&) {
    double least = kInfinity;
    for (const LocalTime& local : local_times) least = std::min(least, local.time);
    return least;
  };
  const std::string stop = stop_of(laws);
  EXPECT_NE(stop.find("global_virtual_time"), std::string::npos) << stop;
}

TEST(TaughtTimewarp, StopsWhereNothingBecomesCertain) {
  Laws laws = taught_laws();
  laws.scheduling.on_collision_check = [](const ScheduledEvent& event, const CheckFinding&, double) { return CheckDecision{false, {}, event}; };   // due again at once
  EXPECT_NE(stop_of(laws).find("still stands"), std::string::npos);
}

// Whatever they answer, the run ends with words.
TEST(TaughtTimewarp, BearsAnyAnswer) {
  const std::vector<double> odd{-1.0, 0.0, 0.3, 1e9, kInfinity, -kInfinity, kUnset};
  for (const double time : odd) {
    Laws laws = taught_laws();
    laws.scheduling.on_collision_check = [right = laws.scheduling.on_collision_check, time](const ScheduledEvent& event, const CheckFinding& finding, double step) {
      CheckDecision decision = right(event, finding, step);
      decision.next.stamp.time = decision.next.safe_time = time;
      return decision;
    };
    EXPECT_NE(stop_of(laws), "") << time;
    laws = taught_laws();
    laws.scheduling.plan_rollback = [time](const std::vector<Effect>&, std::vector<Rollback> first) {
      for (Rollback& rollback : first) rollback.stamp.time = time;
      return first;
    };
    EXPECT_NE(stop_of(laws), "") << time;
    laws = taught_laws();
    laws.scheduling.global_virtual_time = [time](const std::vector<LocalTime>&, const std::vector<ScheduledEvent>&) { return time; };
    if (time > 0.5 || time != time) EXPECT_NE(stop_of(laws), "") << time;
    else stop_of(laws);
  }
  for (const std::int32_t body : {-1, 0, 3, 1000}) {   // a wall, a ball that is not concerned, nobody
    Laws laws = taught_laws();
    laws.scheduling.plan_rollback = [body](const std::vector<Effect>&, std::vector<Rollback> first) {
      for (Rollback& rollback : first) rollback.body = body;
      return first;
    };
    EXPECT_NE(stop_of(laws), "") << body;
  }
}

}  // namespace
}  // namespace tumble::testing
