// What accuracy costs: the truth's floor, the order that a ladder shows, and the sentence that reads it.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/engines/cost/cost.h"
#include "framework/engines/cost/reading.h"
#include "framework/engines/truths/memory_scene.h"
#include "tests/engines/cost_scenes.h"

namespace tumble::testing {
namespace {

using engines::CostRung;
using engines::CostTruth;
using engines::CostWay;

/// A box that spins about no axis of its own, for a second, a third of a turn away from where Euler's method puts it.
scene::Scene turning() { return free_top(Vector3d(1.0, 0.5, 2.0)); }

/// A short ladder of steps or tolerances.
std::vector<CostRung> ladder_of(const scene::Scene& scene, const CostWay& way, const CostTruth& truth) {
  return engines::run_ladder(scene, way, truth, 10.0, {}, {1.0 / 16, 1.0 / 32, 1.0 / 64, 1.0 / 128}, {1e-4, 1e-6, 1e-8, 1e-10}, [](const CostRung&) {});
}

TEST(Cost, TruthOfAFreeTopIsTheClosedFormToRoundOff) {
  const CostTruth truth = engines::find_truth(turning(), library_laws(), {});
  EXPECT_NE(truth.what.find("closed form"), std::string::npos) << truth.what;
  EXPECT_EQ(truth.duration_s, 1.0);
  // Two engines, each a few roundings of elliptic functions a sample; a metre is the scale.
  EXPECT_LT(truth.floor_m, 1e-13);
}

TEST(Cost, LaddersShowTheOrderOfTheirMethod) {
  const scene::Scene scene = turning();
  const CostTruth truth = engines::find_truth(scene, library_laws(), {});
  for (const char* word : {"euler", "midpoint", "rk4"}) {
    const CostWay way = way_of(word);
    const std::vector<CostRung> rungs = ladder_of(scene, way, truth);
    const auto fit = engines::order_of(way, rungs, truth);
    ASSERT_TRUE(fit) << word;
    // w h is 1/30 at the middle of the ladder: the next term of the error is a tenth of the first at most.
    EXPECT_NEAR(fit->order, way.order, 0.15) << word;
    EXPECT_NE(engines::read_ladder(way, rungs, truth, true).find("as it should"), std::string::npos) << engines::read_ladder(way, rungs, truth, true);
  }
}

TEST(Cost, AStageThatIsOffIsSaidToBe) {
  const scene::Scene scene = turning();
  const CostTruth truth = engines::find_truth(scene, library_laws(), {});
  CostWay way = way_of("rk4");
  way.name = "your rk4_step";
  way.method = [](double) -> StepFunction {
    return [](const OdeFunction& f, double t, const VectorXd& y, double h) -> VectorXd {
      const VectorXd k1 = f(t, y), k2 = f(t + h / 2, y + h / 2 * k1), k3 = f(t + h / 2, y + h / 2 * k1), k4 = f(t + h, y + h * k3);   // k3 starts from k1
      return y + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    };
  };
  const std::string reading = engines::read_ladder(way, ladder_of(scene, way, truth), truth, true);
  EXPECT_NE(reading.find("a stage is off"), std::string::npos) << reading;
}

TEST(Cost, AWrongLawDoesNotConverge) {
  const scene::Scene scene = turning();
  const CostTruth truth = engines::find_truth(scene, library_laws(), {});
  CostWay way = way_of("rk4");
  way.laws.state_derivative = [right = way.laws.state_derivative](const RigidBodyState& state, const Inertia& inertia, const Wrench& wrench) -> VectorXd {
    return 0.99 * right(state, inertia, wrench);   // a hundredth slower
  };
  const std::string reading = engines::read_ladder(way, ladder_of(scene, way, truth), truth, true);
  EXPECT_NE(reading.find("does not converge"), std::string::npos) << reading;
}

TEST(Cost, SmallerTolerancesCostMoreEvaluationsAndLessError) {
  const scene::Scene scene = turning();
  const CostTruth truth = engines::find_truth(scene, library_laws(), {});
  const std::vector<CostRung> rungs = ladder_of(scene, way_of("dopri5"), truth);
  ASSERT_EQ(rungs.size(), 4u);
  EXPECT_GT(rungs.back().evaluations, rungs.front().evaluations);
  EXPECT_LT(rungs.back().error_m, 1e-2 * rungs.front().error_m);   // the tolerances span a factor of 1e6
}

TEST(Cost, ALadderGoesOnWhereItEnded) {
  const scene::Scene scene = turning();
  const CostTruth truth = engines::find_truth(scene, library_laws(), {});
  const CostWay way = way_of("rk4");
  const engines::LadderWords halvings;
  std::vector<CostRung> rungs;
  int told = 0;
  const auto count = [&told](const CostRung&) { ++told; };
  for (int k = 0; k < 3; ++k) engines::extend_ladder(scene, way, truth, 0.0, {}, halvings, rungs, count);   // no time: one rung each
  ASSERT_EQ(rungs.size(), 3u);
  EXPECT_EQ(told, 3);
  for (std::size_t k = 1; k < rungs.size(); ++k) EXPECT_DOUBLE_EQ(rungs[k].step_s, 0.5 * rungs[k - 1].step_s);
  EXPECT_GT(engines::next_price(rungs), 0.0);
  EXPECT_FALSE(engines::ladder_is_done(scene, way, truth, rungs, halvings));
  engines::extend_ladder(scene, way, truth, 30.0, {}, halvings, rungs, count);
  EXPECT_TRUE(engines::ladder_is_done(scene, way, truth, rungs, halvings));
  const std::size_t all = rungs.size();
  engines::extend_ladder(scene, way, truth, 30.0, {}, halvings, rungs, count);   // nothing more comes of it
  EXPECT_EQ(rungs.size(), all);
}

TEST(Cost, ARunThatTakesTooLongIsStoppedAndSaysSo) {
  const scene::Scene scene = turning();
  const CostTruth truth = engines::find_truth(scene, library_laws(), {});
  engines::CostOptions hurried;
  hurried.most_of_rung_s = 0.0;
  const CostRung rung = engines::run_rung(scene, way_of("rk4"), truth, 64, kUnset, hurried);
  EXPECT_NE(rung.stopped_by.find("it would take more than"), std::string::npos) << rung.stopped_by;
}

TEST(Cost, WithinOneLongStepAControlledMethodIsStoppedToo) {
  const scene::Scene scene = turning();
  const CostTruth truth = engines::find_truth(scene, library_laws(), {});
  long evaluations = 0;
  CostWay way = way_of("dopri5");
  way.method = [&](double) -> StepFunction {
    return [&](const OdeFunction& f, double t, const VectorXd& y, double) -> VectorXd {   // whose steps have no end, nearly
      for (int k = 0; k < 100000; ++k, ++evaluations) f(t, y);
      return y;
    };
  };
  engines::CostOptions hurried;
  hurried.most_of_rung_s = 0.0;
  EXPECT_TRUE(engines::run_rung(scene, way, truth, 1, 1e-6, hurried).took_too_long);
  EXPECT_LT(evaluations, 200);   // the clock is looked at each 64
}

TEST(Cost, ALadderEndsWhereARunTakesTooLongAndGoesOnThereWithMoreTime) {
  const scene::Scene scene = turning();
  const CostTruth truth = engines::find_truth(scene, library_laws(), {});
  const CostWay way = way_of("rk4");
  engines::CostOptions hurried;
  hurried.most_of_rung_s = 0.0;
  std::vector<CostRung> rungs;
  const auto nobody = [](const CostRung&) {};
  engines::extend_ladder(scene, way, truth, 30.0, hurried, {}, rungs, nobody);
  ASSERT_TRUE(rungs.back().took_too_long) << rungs.back().stopped_by;
  EXPECT_EQ(std::count_if(rungs.begin(), rungs.end(), [](const CostRung& rung) { return rung.took_too_long; }), 1);   // finer ones are not tried
  const std::size_t all = rungs.size();
  const double step = rungs.back().step_s;
  engines::extend_ladder(scene, way, truth, 30.0, hurried, {}, rungs, nobody);   // no more time: nothing is run
  EXPECT_EQ(rungs.size(), all);
  engines::extend_ladder(scene, way, truth, 0.0, {}, {}, rungs, nobody);   // one rung: the same again
  ASSERT_EQ(rungs.size(), all);
  EXPECT_TRUE(rungs.back().stopped_by.empty()) << rungs.back().stopped_by;
  EXPECT_EQ(rungs.back().step_s, step);
}

/// A rung that was run. @param spent_s  CPU time
CostRung rung_of(double step_s, double error_m, double spent_s) {
  CostRung rung;
  rung.step_s = step_s;
  rung.error_m = error_m;
  rung.cpu_s = rung.spent_s = spent_s;
  return rung;
}

TEST(Cost, ThePriceOfTheNextRungLeavesOutWhatDoesNotComeFromSteps) {
  EXPECT_DOUBLE_EQ(engines::next_price({rung_of(0.1, 0.1, 1.0)}), 2.2);   // twice the steps, and a little
  EXPECT_DOUBLE_EQ(engines::next_price({rung_of(0.1, 0.1, 1.0), rung_of(0.05, 0.1, 2.0)}), 2.0 + 2.2 * 1.0);
  EXPECT_DOUBLE_EQ(engines::next_price({rung_of(0.1, 0.1, 2.0), rung_of(0.05, 0.1, 2.0)}), 1.2 * 2.0);
}

TEST(Cost, WhereStepsAreNotWhatCostsTheNextRungIsMuchFiner) {
  const scene::Scene scene = turning();
  const CostTruth truth = engines::find_truth(scene, library_laws(), {});
  const double interval = truth.duration_s / static_cast<double>(truth.intervals);
  std::vector<CostRung> same = {rung_of(interval, 0.1, 1.0), rung_of(interval / 2, 0.05, 1.0)}, twice = {rung_of(interval, 0.1, 1.0), rung_of(interval / 2, 0.05, 2.0)};
  for (auto* rungs : {&same, &twice}) engines::extend_ladder(scene, way_of("rk4"), truth, 0.0, {}, {}, *rungs, [](const CostRung&) {});
  EXPECT_DOUBLE_EQ(same.back().step_s, interval / 16);
  EXPECT_DOUBLE_EQ(twice.back().step_s, interval / 4);
}

TEST(Cost, EnergyThatTheMethodLosesIsSeen) {
  const scene::Scene scene = turning();
  const CostTruth truth = engines::find_truth(scene, library_laws(), {});
  const CostRung coarse = engines::run_rung(scene, way_of("euler"), truth, 2, kUnset, {}), fine = engines::run_rung(scene, way_of("rk4"), truth, 8, kUnset, {});
  ASSERT_EQ(coarse.energy_errors.size(), truth.samples.size());
  EXPECT_GT(coarse.energy_errors.back(), 1e-4);
  EXPECT_LT(fine.energy_errors.back(), 1e-6);
}

}  // namespace
}  // namespace tumble::testing
