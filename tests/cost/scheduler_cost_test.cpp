// Sentences about the work of a scheduler: right or wrong first, then its work relative to the
// reference's, with the cause that the counts show.
#include <gtest/gtest.h>

#include "framework/cost/scheduler_work.h"

namespace tumble::testing {
namespace {

/// Two runs with ten events each, in which every impact is executed once.
cost::SchedulerCurve scheduler(std::uint64_t undone, std::uint64_t rollbacks, std::uint64_t checks,
                               std::uint64_t states) {
  cost::SchedulerCurve curve{"your scheduler", false, {}, {}};
  for (const double step : {0.5, 0.05}) {
    cost::SchedulerRun run;
    run.step_s = step, run.processes = 5, run.due = run.committed = run.impacts = 10;
    run.integrations = 30 + undone, run.undone = undone, run.rollbacks = rollbacks,
    run.checks = checks, run.states_kept = states;
    curve.by_step.push_back(run);
  }
  return curve;
}

std::string told_of(const cost::SchedulerCurve& curve, const cost::SchedulerCurve* reference) {
  std::string all;
  for (const cost::SchedulerReading& reading : cost::read_scheduler(curve, reference))
    all += reading.text + "\n";
  return all;
}

TEST(SchedulerCost, WorkEqualToTheReferencesIsReported) {
  const cost::SchedulerCurve reference = scheduler(10, 15, 100, 20);
  const std::string told = told_of(scheduler(11, 15, 110, 21), &reference);
  EXPECT_NE(told.find("commits what the ordered reference commits"), std::string::npos) << told;
  EXPECT_NE(told.find("pays what the reference pays"), std::string::npos) << told;
}

TEST(SchedulerCost, UnnecessaryRollbacksAreNamedAsTheCause) {
  const cost::SchedulerCurve reference = scheduler(10, 15, 100, 20);
  const std::string told = told_of(scheduler(32, 48, 100, 20), &reference);
  EXPECT_NE(told.find("rolls back 3.2 times what the reference rolls back"), std::string::npos)
      << told;
  EXPECT_NE(
      told.find("rolls back 4.8 bodies where 1.5 suffice: bodies that the collision did not touch"),
      std::string::npos)
      << told;
  // each goes as far as in the reference
  EXPECT_EQ(told.find("further back than to the impact"), std::string::npos) << told;
}

TEST(SchedulerCost, GoingBackTooFarIsAnotherCause) {
  const cost::SchedulerCurve reference = scheduler(10, 15, 100, 20);
  const std::string told = told_of(scheduler(40, 15, 100, 20), &reference);
  EXPECT_NE(told.find("further back than to the impact"), std::string::npos) << told;
  EXPECT_EQ(told.find("did not touch"), std::string::npos) << told;
}

TEST(SchedulerCost, ChecksAndStatesHaveSentencesOfTheirOwn) {
  const cost::SchedulerCurve reference = scheduler(10, 15, 100, 20);
  const std::string told = told_of(scheduler(10, 15, 500, 200), &reference);
  EXPECT_NE(told.find("checks its pairs 5.0 times as often"), std::string::npos) << told;
  EXPECT_NE(told.find("keeps 10 times as many states"), std::string::npos) << told;
}

TEST(SchedulerCost, AWrongRunIsReportedFirstAndNotCounted) {
  const cost::SchedulerCurve reference = scheduler(10, 15, 100, 20);
  cost::SchedulerCurve wrong = scheduler(32, 48, 100, 20);
  wrong.by_step[1].committed = 4;
  wrong.by_step[1].stopped_by = "committed event 5 is not the ordered reference's";
  EXPECT_NEAR(wrong.by_step[1].error(), 0.6, 1e-15);  // 6 of 10
  const std::vector<cost::SchedulerReading> readings = cost::read_scheduler(wrong, &reference);
  EXPECT_EQ(readings.front().kind, cost::SchedulerReading::Kind::kWrong);
  EXPECT_NE(
      readings.front().text.find(
          "in 1 of 2 runs. With steps of 1/20 s it commits 4 of 10 events: committed event 5"),
      std::string::npos)
      << readings.front().text;
  // of the right run
  EXPECT_NE(readings.at(1).text.find("3.20 integrations per event, where 1.00"), std::string::npos)
      << readings.at(1).text;
}

TEST(SchedulerCost, WithoutAReferenceItsOwnNumbersAreGiven) {
  const std::string told = told_of(scheduler(32, 48, 100, 20), nullptr);
  EXPECT_NE(told.find("rolls back 4.8 bodies: two take part in one"), std::string::npos) << told;
  EXPECT_EQ(told.find("reference pays"), std::string::npos) << told;
}

}  // namespace
}  // namespace tumble::testing
