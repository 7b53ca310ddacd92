// The measured work of schedulers: right decisions, right but costly decisions, wrong decisions,
// and one that never ends.
#include <gtest/gtest.h>

#include "framework/cost/scheduler_work.h"
#include "tests/engines/event_scenes.h"
#include "tests/engines/taught_laws.h"

namespace tumble::testing {
namespace {

using cost::SchedulerCurve;
using cost::SchedulerReading;
using cost::SchedulerRun;
using cost::SchedulerRunOptions;

constexpr int kBalls = 8;

/// Every event rolls back all bodies, as retroactive detection does.
void send_everybody_back(const scene::Scene& scene, Laws& laws) {
  std::vector<std::int32_t> movers;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i)
    if (!scene.bodies[i].immovable) movers.push_back(static_cast<std::int32_t>(i));
  laws.scheduling.plan_rollback =
      [right = laws.scheduling.plan_rollback, before = laws.scheduling.comes_before, movers](
          const std::vector<Effect>& effects, const std::vector<Rollback>& first) {
        std::vector<Rollback> all = first;
        for (const std::int32_t body : movers) {
          Rollback back{body, first.front().stamp};
          for (const Rollback& rollback : first)
            if (before(rollback.stamp, back.stamp)) back.stamp = rollback.stamp;
          if (std::none_of(first.begin(), first.end(),
                           [body](const Rollback& rollback) { return rollback.body == body; }))
            all.push_back(back);
        }
        return right(effects, all);
      };
}

SchedulerRun run_of(const Laws& laws, double most_s = 60.0) {
  const scene::Scene scene = sized("gas", kBalls, 1.0);
  SchedulerRunOptions trial;
  trial.n = kBalls;
  trial.most_s = most_s;
  return cost::run_scheduler(scene, laws, trial, cost::events_due(scene, laws, trial));
}

TEST(SchedulerWork, RightDecisionsCommitAllAndAreCounted) {
  const SchedulerRun run = run_of(taught_laws());
  EXPECT_TRUE(run.is_right()) << run.stopped_by;
  EXPECT_EQ(run.error(), 0.0);
  EXPECT_EQ(run.processes, static_cast<std::size_t>(kBalls));
  EXPECT_GE(run.impacts, run.committed);
  EXPECT_GT(run.rollbacks, 0u);
  EXPECT_GT(run.integrations, run.undone);
}

TEST(SchedulerWork, RollingBackAllBodiesIsRightAndCostlyAndTheCauseIsNamed) {
  Laws laws = taught_laws();
  send_everybody_back(sized("gas", kBalls, 1.0), laws);
  const SchedulerCurve dear{"your scheduler", false, {}, {run_of(laws)}},
      right{"reference", true, {}, {run_of(taught_laws())}};
  ASSERT_TRUE(dear.by_size[0].is_right()) << dear.by_size[0].stopped_by;
  const std::vector<SchedulerReading> readings = cost::read_scheduler(dear, &right);
  ASSERT_GE(readings.size(), 2u);
  EXPECT_EQ(readings[0].kind, SchedulerReading::Kind::kRight) << readings[0].text;
  EXPECT_EQ(readings[1].kind, SchedulerReading::Kind::kWasteful) << readings[1].text;
  EXPECT_NE(readings[1].text.find("bodies that the collision did not touch"), std::string::npos)
      << readings[1].text;
}

TEST(SchedulerWork, AnImpactThatIsLostIsAnError) {
  Laws laws = taught_laws();
  lose_impacts_after(0.5, laws);
  const SchedulerRun run = run_of(laws);
  EXPECT_FALSE(run.is_right());
  // from the second half of the time about half of the events are lost
  EXPECT_GT(run.error(), 0.2);
  EXPECT_LT(run.error(), 0.8);
  EXPECT_FALSE(run.stopped_by.empty());
}

TEST(SchedulerWork, ARunThatTakesTooLongIsStoppedAndSaysSo) {
  const SchedulerRun run = run_of(taught_laws(), 0.0);
  EXPECT_NE(run.stopped_by.find("takes more than"), std::string::npos) << run.stopped_by;
  EXPECT_EQ(run.error(), 1.0);
}

}  // namespace
}  // namespace tumble::testing
