// Methods and steps that are chosen for an error or a time; scenes that have no truth.
#include <cmath>

#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/engines/cost/choice.h"
#include "framework/engines/truths/memory_scene.h"
#include "tests/engines/cost_scenes.h"

namespace tumble::testing {
namespace {

using engines::CostChoices;
using engines::CostOptions;
using engines::CostTruth;
using engines::CostWay;

constexpr double kFrames = 60.0;   // Hz

/// A box that tumbles for a second.
scene::Scene tumbling() { return free_top(Vector3d(3.0, 2.0, 5.0)); }

CostTruth truth_at_frames(const scene::Scene& scene) {
  CostOptions options;
  options.frame_rate_hz = kFrames;
  return engines::find_truth(scene, library_laws(), options);
}

/// @param most_s  of the search: generous, since a loaded machine's CPU times are not what is tested
CostChoices chosen(const std::vector<CostWay>& ways, const engines::CostWish& wish) {
  return engines::choose_way(tumbling(), ways, truth_at_frames(tumbling()), wish, 60.0, {}, [](const engines::CostChoice&) {});
}

/// The error of a run that is made anew from a choice, against an ending computed in closed form.
double error_of_the_run(const engines::CostChoice& choice) {
  const CostTruth truth = truth_at_frames(tumbling());
  const engines::CostRun run = engines::run_of(tumbling(), choice.way, truth, choice.steps, choice.tolerance, {});
  TrajectoryRecorder recorder;
  engines::run_scene(run.scene, run.laws, run.options, recorder);
  double most = 0.0;
  for (std::size_t k = 0; k < truth.samples.size(); ++k) most = std::max(most, engines::distance_between(recorder.trajectory().frames.at(k), truth.samples[k], truth.radii));
  return most;
}

TEST(Choice, TruthHasTheFramesThatARunRecords) {
  const CostTruth truth = truth_at_frames(tumbling());
  EXPECT_EQ(truth.samples.size(), 61u);
  EXPECT_NEAR(truth.samples.back().time, 1.0, 1e-12);
}

TEST(Choice, FixedStepsAreAsFineAsAskedAndNotMuchFiner) {
  for (const double asked : {1e-4, 1e-6, 1e-8}) {
    const CostChoices found = chosen({way_of("rk4")}, {asked, {}});
    ASSERT_TRUE(found.best) << asked;
    const double error = error_of_the_run(*found.best);
    EXPECT_LE(error, asked);
    // Steps are whole parts of a frame: at n a frame the error may be ((n - 1) / n)^4 of what was asked for, times the aim of 0.7; n is 2 at least here.
    EXPECT_GT(error, asked / 30.0) << asked;
  }
}

TEST(Choice, ControlledMethodsReachWhatIsAsked) {
  for (const char* word : {"dopri5", "fehlberg78", "bulirsch-stoer"}) {
    const CostChoices found = chosen({way_of(word)}, {1e-9, {}});
    ASSERT_TRUE(found.best) << word;
    EXPECT_LE(error_of_the_run(*found.best), 1e-9) << word;
  }
}

TEST(Choice, WhatNoMethodReachesIsNotPromised) {
  const CostChoices found = chosen({way_of("euler")}, {1e-12, {}});   // would take 1e12 steps
  EXPECT_FALSE(found.best);
  ASSERT_TRUE(found.closest);
  EXPECT_GT(found.closest->rung.error_m, 1e-12);
}

TEST(Choice, ABudgetBuysTheLeastErrorThatFitsInIt) {
  const CostChoices found = chosen({way_of("euler"), way_of("fehlberg78")}, {{}, 30.0});
  ASSERT_TRUE(found.best);
  EXPECT_EQ(found.best->way.name, "Fehlberg 7(8)");
  EXPECT_LE(found.best->rung.cpu_s, 30.0);
  EXPECT_LT(error_of_the_run(*found.best), 1e-10);
  EXPECT_FALSE(chosen({way_of("euler")}, {{}, 1e-9}).best);   // a nanosecond buys nothing
}

TEST(Choice, ALawThatIsWrongReachesNoAccuracy) {
  CostWay way = way_of("rk4");
  way.laws.state_derivative = [right = way.laws.state_derivative](const RigidBodyState& state, const Inertia& inertia, const Wrench& wrench) -> VectorXd { return 0.99 * right(state, inertia, wrench); };
  EXPECT_FALSE(chosen({way}, {1e-4, {}}).best);
}

/// A top that stands by its energy alone.
scene::Scene judged_by_energy(double tolerance) {
  scene::Scene scene = tumbling();
  scene::CheckSpec check;
  check.kind = "energy";
  check.tolerance = tolerance;
  scene.checks = {check};
  return scene;
}

TEST(ByNumbers, AnErrorIsTheShareOfWhatIsAllowed) {
  const CostTruth wide = engines::by_numbers(judged_by_energy(1e-2), {}, "none"), narrow = engines::by_numbers(judged_by_energy(1e-4), {}, "none");
  const double share = engines::run_rung(judged_by_energy(1e-2), way_of("euler"), wide, 4, kUnset, {}).error_m;
  const engines::CostRung strict = engines::run_rung(judged_by_energy(1e-4), way_of("euler"), narrow, 4, kUnset, {});
  EXPECT_GT(share, 0.0);
  EXPECT_NEAR(strict.error_m / share, 100.0, 1e-9);   // a hundredth is allowed
  EXPECT_NE(strict.worst.find("energy"), std::string::npos) << strict.worst;
  EXPECT_LT(engines::run_rung(judged_by_energy(1e-4), way_of("rk4"), narrow, 4, kUnset, {}).error_m, 1.0);
}

TEST(ByNumbers, WhereNothingIsAllowedAndSomethingIsThereARunIsWrong) {
  const engines::CostRung rung = engines::run_rung(judged_by_energy(0.0), way_of("euler"), engines::by_numbers(judged_by_energy(0.0), {}, "none"), 1, kUnset, {});
  EXPECT_TRUE(std::isinf(rung.error_m)) << rung.error_m;
}

/// A case in memory, as a truth file gives it: one bob on a rod of a metre, released from the horizontal.
truths::Case pendulum_case(const std::string& mass) {
  using truths::Value;
  const auto text = [](const std::string& words) { return Value("test", words); };
  const auto input = [&](const std::string& name, const Value& value) { return std::pair<std::string, Value>(name, Value("test", Value::Members{{"value", value}})); };
  const auto list = [&](const std::vector<std::string>& numbers) {
    Value::List all;
    for (const std::string& number : numbers) all.push_back(text(number));
    return Value("test", all);
  };
  truths::Case known;
  known.family = "chain";
  known.inputs = Value("test", Value::Members{input("masses", list({mass})), input("lengths", list({"1"})), input("g", text("9.81")), input("theta0", list({"1.57079632679489661923132169164"})),
                                              input("omega0", list({"0"})), input("times", list({"0.5"}))});
  known.outputs = Value("test", Value::Members{input("positions_t0.5", Value("test", Value::List{list({"0.5", "-0.866"})}))});
  return known;
}

TEST(KnownPlaces, AreThoseOfTheSameProblemOnly) {
  const scene::Scene scene = truths::straight_chain({2.0}, 1.0, Vector3d::UnitX(), Vector3d(0.0, 0.0, -9.81));
  const auto places = truths::known_places(scene, pendulum_case("2"));
  ASSERT_EQ(places.size(), 1u);
  EXPECT_EQ(places[0].time_s, 0.5);
  EXPECT_EQ(places[0].com_world, Vector3d(0.5, 0.0, -0.866));
  EXPECT_TRUE(truths::known_places(scene, pendulum_case("2.001")).empty());
  EXPECT_TRUE(truths::known_places(truths::straight_chain({2.0}, 1.0, Vector3d::UnitX(), Vector3d(0.0, 0.0, -9.8)), pendulum_case("2")).empty());
  EXPECT_TRUE(truths::known_places(truths::straight_chain({2.0}, 1.0, -Vector3d::UnitZ(), Vector3d(0.0, 0.0, -9.81)), pendulum_case("2")).empty());
}

TEST(KnownPlaces, WidenTheErrorOfATruthThatMissesThem) {
  CostTruth truth = engines::find_truth(tumbling(), library_laws(), {});
  const double before = truth.floor_m;
  const Vector3d there = Vector3d(1.0, 0.0, 0.0) * 0.5;   // the top flies at 1 m/s
  engines::check_truth(tumbling(), library_laws(), {{0.5, 0, there}, {7.0, 0, there}}, "a file", truth);   // the second is beyond the truth's end
  EXPECT_LT(truth.floor_m, before + 1e-14);
  engines::check_truth(tumbling(), library_laws(), {{0.5, 0, there + Vector3d(0.0, 1e-5, 0.0)}}, "a wrong file", truth);
  EXPECT_NEAR(truth.floor_m, 1e-5, 1e-12);
  EXPECT_NE(truth.what.find("a wrong file"), std::string::npos) << truth.what;
}

}  // namespace
}  // namespace tumble::testing
