// Error against cost: the error floor of the reference, the order of a refinement, and its
// sentence.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/cost/cost.h"
#include "framework/cost/reading.h"
#include "framework/truths/memory_scene.h"
#include "tests/cost/cost_scenes.h"

namespace tumble::testing {
namespace {

using cost::CostMethod;
using cost::CostReference;
using cost::CostResult;

/// A box that rotates for a second, not about a principal axis, a third of a turn away from Euler's
/// result.
scene::Scene turning() { return free_top(Vector3d(1.0, 0.5, 2.0)); }

/// A short refinement of steps or tolerances.
std::vector<CostResult> refinement_of(const scene::Scene& scene, const CostMethod& method,
                                      const CostReference& reference) {
  return cost::run_refinement(scene, method, reference, 10.0, {},
                              {1.0 / 16, 1.0 / 32, 1.0 / 64, 1.0 / 128}, {1e-4, 1e-6, 1e-8, 1e-10},
                              [](const CostResult&) {});
}

TEST(Cost, ReferenceOfAFreeTopIsTheClosedFormToRoundOff) {
  const CostReference reference = cost::find_reference(turning(), library_laws(), {});
  EXPECT_NE(reference.what.find("closed form"), std::string::npos) << reference.what;
  EXPECT_EQ(reference.duration_s, 1.0);
  // Two engines, each with a few roundings of elliptic functions per sample; the scale is a metre.
  EXPECT_LT(reference.floor_m, 1e-13);
}

TEST(Cost, RefinementsShowTheOrderOfTheirMethod) {
  const scene::Scene scene = turning();
  const CostReference reference = cost::find_reference(scene, library_laws(), {});
  for (const char* word : {"euler", "midpoint", "rk4"}) {
    const CostMethod method = method_of(word);
    const std::vector<CostResult> results = refinement_of(scene, method, reference);
    const auto fit = cost::order_of(method, results, reference);
    ASSERT_TRUE(fit) << word;
    // w h is 1/30 in the middle of the refinement: the next term of the error is at most a tenth of
    // the first.
    EXPECT_NEAR(fit->order, method.order, 0.15) << word;
    EXPECT_NE(cost::read_refinement(method, results, reference, true).find("as it should"),
              std::string::npos)
        << cost::read_refinement(method, results, reference, true);
    // a sentence begins with a capital letter: "Midpoint converges"
    EXPECT_TRUE(std::isupper(cost::read_refinement(method, results, reference, true).front()));
  }
}

TEST(Cost, AWrongStageIsReported) {
  const scene::Scene scene = turning();
  const CostReference reference = cost::find_reference(scene, library_laws(), {});
  CostMethod method = method_of("rk4");
  method.name = "your rk4_step";
  method.step_function = [](double) -> StepFunction {
    return [](const OdeFunction& f, double t, const VectorXd& y, double h) -> VectorXd {
      // k3 starts from k1
      const VectorXd k1 = f(t, y), k2 = f(t + h / 2, y + h / 2 * k1),
                     k3 = f(t + h / 2, y + h / 2 * k1), k4 = f(t + h, y + h * k3);
      return y + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    };
  };
  const auto results = refinement_of(scene, method, reference);
  const std::string reading = cost::read_refinement(method, results, reference, true);
  EXPECT_NE(reading.find("a stage is wrong"), std::string::npos) << reading;
  // Where the library steps, the module under test has no stages.
  method.has_library_step = true;
  const std::string of_laws = cost::read_refinement(method, results, reference, true);
  EXPECT_NE(of_laws.find("a law is wrong"), std::string::npos) << of_laws;
}

TEST(Cost, AWrongLawDoesNotConverge) {
  const scene::Scene scene = turning();
  const CostReference reference = cost::find_reference(scene, library_laws(), {});
  CostMethod method = method_of("rk4");
  method.laws.state_derivative = [right = method.laws.state_derivative](
                                     const RigidBodyState& state, const Inertia& inertia,
                                     const Wrench& wrench) -> VectorXd {
    return 0.99 * right(state, inertia, wrench);  // one per cent slower
  };
  const std::string reading =
      cost::read_refinement(method, refinement_of(scene, method, reference), reference, true);
  EXPECT_NE(reading.find("does not converge"), std::string::npos) << reading;
}

TEST(Cost, AnErrorThatStaysIsNotBlamedOnALawAlone) {
  // A light bob that turns back within 1e-5 s is missed by all of these steps alike.
  CostReference reference;
  reference.scale_m = 3.0;
  reference.floor_m = 1e-11;
  const auto read = [&](double error_m) {
    std::vector<CostResult> results(3);
    for (std::size_t i = 0; i < 3; ++i) {
      results[i].step_s = 1e-4 / static_cast<double>(1 << i);
      results[i].error_m = error_m;
    }
    return cost::read_refinement(method_of("symplectic"), results, reference, false);
  };
  const std::string large = read(0.18), small = read(1e-4);
  EXPECT_NE(large.find("stays at 0.18 m from steps of 1/10000 to 1/40000 s"), std::string::npos)
      << large;
  EXPECT_NE(large.find("too long for the fastest part"), std::string::npos) << large;
  EXPECT_NE(small.find("a law is wrong"), std::string::npos) << small;
  EXPECT_EQ(small.find("too long"), std::string::npos) << small;
}

TEST(Cost, SmallerTolerancesCostMoreEvaluationsAndLessError) {
  const scene::Scene scene = turning();
  const CostReference reference = cost::find_reference(scene, library_laws(), {});
  const std::vector<CostResult> results = refinement_of(scene, method_of("dopri5"), reference);
  ASSERT_EQ(results.size(), 4u);
  EXPECT_GT(results.back().evaluations, results.front().evaluations);
  // the tolerances span a factor of 1e6
  EXPECT_LT(results.back().error_m, 1e-2 * results.front().error_m);
}

// What a body in water asks of its steps makes coarse ones alike: their errors decrease no further
// and say nothing of the method.
TEST(Cost, RunsWhoseStepsWereShortenedDoNotEndARefinement) {
  const scene::Scene scene = turning();
  CostReference reference;
  reference.floor_m = 1e-9;
  reference.scale_m = 1.0;
  const auto is_done = [&](bool shortened, std::uint64_t second, std::uint64_t third) {
    std::vector<CostResult> results(3);
    results[0].error_m = 1e-5;
    results[1].error_m = results[2].error_m = 2e-5;
    results[0].evaluations = 1000;
    results[1].evaluations = second;
    results[2].evaluations = third;
    for (CostResult& result : results) result.has_shortened_steps = shortened;
    return cost::refinement_is_done(scene, method_of("rk4"), reference, results, {});
  };
  EXPECT_FALSE(is_done(true, 1100, 1300));
  // nor do two with twice the work each, which may meet what acts at a worse instant; where nothing
  // was shortened, two that are no better end it
  EXPECT_FALSE(is_done(true, 2000, 4000));
  EXPECT_TRUE(is_done(false, 1100, 1300));
}

TEST(Cost, ARefinementContinuesWhereItEnded) {
  const scene::Scene scene = turning();
  const CostReference reference = cost::find_reference(scene, library_laws(), {});
  const CostMethod method = method_of("rk4");
  const cost::RefinementWords halvings;
  std::vector<CostResult> results;
  int progress = 0;
  const auto count = [&progress](const CostResult&) { ++progress; };
  // no time: one run each
  for (int k = 0; k < 3; ++k)
    cost::extend_refinement(scene, method, reference, 0.0, {}, halvings, results, count);
  ASSERT_EQ(results.size(), 3u);
  EXPECT_EQ(progress, 3);
  for (std::size_t k = 1; k < results.size(); ++k)
    EXPECT_DOUBLE_EQ(results[k].step_s, 0.5 * results[k - 1].step_s);
  EXPECT_GT(cost::next_price(results), 0.0);
  EXPECT_FALSE(cost::refinement_is_done(scene, method, reference, results, halvings));
  cost::extend_refinement(scene, method, reference, 30.0, {}, halvings, results, count);
  EXPECT_TRUE(cost::refinement_is_done(scene, method, reference, results, halvings));
  const std::size_t all = results.size();
  // nothing more comes of it
  cost::extend_refinement(scene, method, reference, 30.0, {}, halvings, results, count);
  EXPECT_EQ(results.size(), all);
}

TEST(Cost, ARunThatTakesTooLongIsStoppedAndSaysSo) {
  const scene::Scene scene = turning();
  const CostReference reference = cost::find_reference(scene, library_laws(), {});
  cost::CostOptions hurried;
  hurried.most_of_run_s = 0.0;
  const CostResult result =
      cost::run_at_resolution(scene, method_of("rk4"), reference, 64, kUnset, hurried);
  EXPECT_NE(result.stopped_by.find("it would take more than"), std::string::npos)
      << result.stopped_by;
}

TEST(Cost, WithinOneLongStepAControlledMethodIsStoppedToo) {
  const scene::Scene scene = turning();
  const CostReference reference = cost::find_reference(scene, library_laws(), {});
  long evaluations = 0;
  CostMethod method = method_of("dopri5");
  method.step_function = [&](double) -> StepFunction {
    // a method whose steps nearly never end
    return [&](const OdeFunction& f, double t, const VectorXd& y, double) -> VectorXd {
      for (int k = 0; k < 100000; ++k, ++evaluations) f(t, y);
      return y;
    };
  };
  cost::CostOptions hurried;
  hurried.most_of_run_s = 0.0;
  EXPECT_TRUE(cost::run_at_resolution(scene, method, reference, 1, 1e-6, hurried).took_too_long);
  EXPECT_LT(evaluations, 200);  // the clock is read every 64 evaluations
}

TEST(Cost, ARefinementEndsWhereARunTakesTooLongAndContinuesThereWithMoreTime) {
  const scene::Scene scene = turning();
  const CostReference reference = cost::find_reference(scene, library_laws(), {});
  const CostMethod method = method_of("rk4");
  cost::CostOptions hurried;
  hurried.most_of_run_s = 0.0;
  std::vector<CostResult> results;
  const auto nobody = [](const CostResult&) {};
  cost::extend_refinement(scene, method, reference, 30.0, hurried, {}, results, nobody);
  ASSERT_TRUE(results.back().took_too_long) << results.back().stopped_by;
  // finer ones are not tried
  EXPECT_EQ(std::count_if(results.begin(), results.end(),
                          [](const CostResult& result) { return result.took_too_long; }),
            1);
  const std::size_t all = results.size();
  const double step = results.back().step_s;
  // no more time: no run
  cost::extend_refinement(scene, method, reference, 30.0, hurried, {}, results, nobody);
  EXPECT_EQ(results.size(), all);
  // one run: the same again
  cost::extend_refinement(scene, method, reference, 0.0, {}, {}, results, nobody);
  ASSERT_EQ(results.size(), all);
  EXPECT_TRUE(results.back().stopped_by.empty()) << results.back().stopped_by;
  EXPECT_EQ(results.back().step_s, step);
}

/// The result of a run. @param spent_s  CPU time
CostResult result_of(double step_s, double error_m, double spent_s) {
  CostResult result;
  result.step_s = step_s;
  result.error_m = error_m;
  result.cpu_s = result.spent_s = spent_s;
  return result;
}

TEST(Cost, TheExpectedCostOfTheNextRunExcludesCostsThatDoNotComeFromSteps) {
  // twice the steps, and 10 % more
  EXPECT_DOUBLE_EQ(cost::next_price({result_of(0.1, 0.1, 1.0)}), 2.2);
  EXPECT_DOUBLE_EQ(cost::next_price({result_of(0.1, 0.1, 1.0), result_of(0.05, 0.1, 2.0)}),
                   2.0 + 2.2 * 1.0);
  EXPECT_DOUBLE_EQ(cost::next_price({result_of(0.1, 0.1, 2.0), result_of(0.05, 0.1, 2.0)}),
                   1.2 * 2.0);
}

TEST(Cost, WhereStepsAreNotTheCostTheNextRunIsMuchFiner) {
  const scene::Scene scene = turning();
  const CostReference reference = cost::find_reference(scene, library_laws(), {});
  const double interval = reference.duration_s / static_cast<double>(reference.intervals);
  std::vector<CostResult> same = {result_of(interval, 0.1, 1.0),
                                  result_of(interval / 2, 0.05, 1.0)},
                          twice = {result_of(interval, 0.1, 1.0),
                                   result_of(interval / 2, 0.05, 2.0)};
  for (auto* results : {&same, &twice})
    cost::extend_refinement(scene, method_of("rk4"), reference, 0.0, {}, {}, *results,
                            [](const CostResult&) {});
  EXPECT_DOUBLE_EQ(same.back().step_s, interval / 16);
  EXPECT_DOUBLE_EQ(twice.back().step_s, interval / 4);
}

TEST(Cost, EnergyThatTheMethodLosesIsSeen) {
  const scene::Scene scene = turning();
  const CostReference reference = cost::find_reference(scene, library_laws(), {});
  const CostResult coarse =
                       cost::run_at_resolution(scene, method_of("euler"), reference, 2, kUnset, {}),
                   fine =
                       cost::run_at_resolution(scene, method_of("rk4"), reference, 8, kUnset, {});
  ASSERT_EQ(coarse.energy_errors.size(), reference.samples.size());
  EXPECT_GT(coarse.energy_errors.back(), 1e-4);
  EXPECT_LT(fine.energy_errors.back(), 1e-6);
}

}  // namespace
}  // namespace tumble::testing
