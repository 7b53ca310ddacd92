// Choice of method and step for an error or a time; scenes without a reference solution.
#include <cmath>

#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/cost/choice.h"
#include "framework/truths/memory_scene.h"
#include "tests/cost/cost_scenes.h"

namespace tumble::testing {
namespace {

using cost::CostChoices;
using cost::CostMethod;
using cost::CostOptions;
using cost::CostReference;

constexpr double kFrames = 60.0;  // Hz

/// A box that tumbles for a second.
scene::Scene tumbling() { return free_top(Vector3d(3.0, 2.0, 5.0)); }

CostReference truth_at_frames(const scene::Scene& scene) {
  CostOptions options;
  options.frame_rate_hz = kFrames;
  return cost::find_reference(scene, library_laws(), options);
}

/// @param most_s  of the search: generous, because the CPU times of a loaded machine are not tested
CostChoices chosen(const std::vector<CostMethod>& methods, const cost::CostGoal& goal) {
  return cost::choose_method(tumbling(), methods, truth_at_frames(tumbling()), goal, 60.0, {},
                             [](const cost::CostChoice&) {});
}

/// The error of a new run with the choice, against the final state in closed form.
double error_of_the_run(const cost::CostChoice& choice) {
  const CostReference reference = truth_at_frames(tumbling());
  const cost::CostRun run =
      cost::run_of(tumbling(), choice.method, reference, choice.steps, choice.tolerance, {});
  TrajectoryRecorder recorder;
  engines::run_scene(run.scene, run.laws, run.options, recorder);
  double most = 0.0;
  for (std::size_t k = 0; k < reference.samples.size(); ++k)
    most = std::max(most, cost::distance_between(recorder.trajectory().frames.at(k),
                                                 reference.samples[k], reference.radii));
  return most;
}

TEST(Choice, ReferenceHasTheFramesThatARunRecords) {
  const CostReference reference = truth_at_frames(tumbling());
  EXPECT_EQ(reference.samples.size(), 61u);
  EXPECT_NEAR(reference.samples.back().time, 1.0, 1e-12);
}

TEST(Choice, FixedStepsAreAsFineAsAskedAndNotMuchFiner) {
  for (const double asked : {1e-4, 1e-6, 1e-8}) {
    const CostChoices found = chosen({method_of("rk4")}, {asked, {}});
    ASSERT_TRUE(found.best) << asked;
    const double error = error_of_the_run(*found.best);
    EXPECT_LE(error, asked);
    // Steps are whole fractions of a frame: with n per frame the error may be ((n - 1) / n)^4 of
    // the request, times the aim of 0.7; n is at least 2 here.
    EXPECT_GT(error, asked / 30.0) << asked;
  }
}

TEST(Choice, ControlledMethodsReachWhatIsAsked) {
  for (const char* word : {"dopri5", "fehlberg78", "bulirsch-stoer"}) {
    const CostChoices found = chosen({method_of(word)}, {1e-9, {}});
    ASSERT_TRUE(found.best) << word;
    EXPECT_LE(error_of_the_run(*found.best), 1e-9) << word;
  }
}

TEST(Choice, AnErrorThatNoMethodReachesIsNotPromised) {
  const CostChoices found = chosen({method_of("euler")}, {1e-12, {}});  // needs 1e12 steps
  EXPECT_FALSE(found.best);
  ASSERT_TRUE(found.closest);
  EXPECT_GT(found.closest->result.error_m, 1e-12);
}

TEST(Choice, ABudgetBuysTheLeastErrorThatFitsInIt) {
  const CostChoices found = chosen({method_of("euler"), method_of("fehlberg78")}, {{}, 30.0});
  ASSERT_TRUE(found.best);
  EXPECT_EQ(found.best->method.name, "Fehlberg 7(8)");
  EXPECT_LE(found.best->result.cpu_s, 30.0);
  EXPECT_LT(error_of_the_run(*found.best), 1e-10);
  // a nanosecond is too short for any run
  EXPECT_FALSE(chosen({method_of("euler")}, {{}, 1e-9}).best);
}

TEST(Choice, ALawThatIsWrongReachesNoAccuracy) {
  CostMethod method = method_of("rk4");
  method.laws.state_derivative = [right = method.laws.state_derivative](
                                     const RigidBodyState& state, const Inertia& inertia,
                                     const Wrench& wrench) -> VectorXd {
    return 0.99 * right(state, inertia, wrench);
  };
  EXPECT_FALSE(chosen({method}, {1e-4, {}}).best);
}

/// A free top that is judged by its energy alone.
scene::Scene judged_by_energy(double tolerance) {
  scene::Scene scene = tumbling();
  scene::CheckSpec check;
  check.kind = "energy";
  check.tolerance = tolerance;
  scene.checks = {check};
  return scene;
}

TEST(ByNumbers, AnErrorIsTheShareOfWhatIsAllowed) {
  const CostReference wide = cost::by_numbers(judged_by_energy(1e-2), {}, "none"),
                      narrow = cost::by_numbers(judged_by_energy(1e-4), {}, "none");
  const double share =
      cost::run_at_resolution(judged_by_energy(1e-2), method_of("euler"), wide, 4, kUnset, {})
          .error_m;
  const cost::CostResult strict =
      cost::run_at_resolution(judged_by_energy(1e-4), method_of("euler"), narrow, 4, kUnset, {});
  EXPECT_GT(share, 0.0);
  EXPECT_NEAR(strict.error_m / share, 100.0, 1e-9);  // the tolerance is a hundredth
  EXPECT_NE(strict.worst.find("energy"), std::string::npos) << strict.worst;
  EXPECT_LT(cost::run_at_resolution(judged_by_energy(1e-4), method_of("rk4"), narrow, 4, kUnset, {})
                .error_m,
            1.0);
}

TEST(ByNumbers, WhereNothingIsAllowedAndSomethingIsThereARunIsWrong) {
  const cost::CostResult result =
      cost::run_at_resolution(judged_by_energy(0.0), method_of("euler"),
                              cost::by_numbers(judged_by_energy(0.0), {}, "none"), 1, kUnset, {});
  EXPECT_TRUE(std::isinf(result.error_m)) << result.error_m;
}

/// A case in memory, as a file gives it: one bob on a rod of a metre, released from the horizontal.
truths::Case pendulum_case(const std::string& mass) {
  using truths::Value;
  const auto text = [](const std::string& words) { return Value("test", words); };
  const auto input = [&](const std::string& name, const Value& value) {
    return std::pair<std::string, Value>(name, Value("test", Value::Members{{"value", value}}));
  };
  const auto list = [&](const std::vector<std::string>& numbers) {
    Value::List all;
    for (const std::string& number : numbers) all.push_back(text(number));
    return Value("test", all);
  };
  truths::Case known;
  known.family = "chain";
  known.inputs =
      Value("test", Value::Members{input("masses", list({mass})), input("lengths", list({"1"})),
                                   input("g", text("9.81")),
                                   input("theta0", list({"1.57079632679489661923132169164"})),
                                   input("omega0", list({"0"})), input("times", list({"0.5"}))});
  known.outputs = Value(
      "test",
      Value::Members{input("positions_t0.5", Value("test", Value::List{list({"0.5", "-0.866"})}))});
  return known;
}

TEST(KnownPositions, AreThoseOfTheSameProblemOnly) {
  const scene::Scene scene =
      truths::straight_chain({2.0}, 1.0, Vector3d::UnitX(), Vector3d(0.0, 0.0, -9.81));
  const auto places = truths::known_positions(scene, pendulum_case("2"));
  ASSERT_EQ(places.size(), 1u);
  EXPECT_EQ(places[0].time_s, 0.5);
  EXPECT_EQ(places[0].com_world, Vector3d(0.5, 0.0, -0.866));
  EXPECT_TRUE(truths::known_positions(scene, pendulum_case("2.001")).empty());
  EXPECT_TRUE(truths::known_positions(
                  truths::straight_chain({2.0}, 1.0, Vector3d::UnitX(), Vector3d(0.0, 0.0, -9.8)),
                  pendulum_case("2"))
                  .empty());
  EXPECT_TRUE(truths::known_positions(
                  truths::straight_chain({2.0}, 1.0, -Vector3d::UnitZ(), Vector3d(0.0, 0.0, -9.81)),
                  pendulum_case("2"))
                  .empty());
}

TEST(KnownPositions, RaiseTheErrorFloorOfAReferenceThatMissesThem) {
  CostReference reference = cost::find_reference(tumbling(), library_laws(), {});
  const double before = reference.floor_m;
  const Vector3d there = Vector3d(1.0, 0.0, 0.0) * 0.5;  // the top moves at 1 m/s
  // the second is after the end of the reference
  cost::check_reference(tumbling(), library_laws(), {{0.5, 0, there}, {7.0, 0, there}}, "a file",
                        reference);
  EXPECT_LT(reference.floor_m, before + 1e-14);
  cost::check_reference(tumbling(), library_laws(), {{0.5, 0, there + Vector3d(0.0, 1e-5, 0.0)}},
                        "a wrong file", reference);
  EXPECT_NEAR(reference.floor_m, 1e-5, 1e-12);
  EXPECT_NE(reference.what.find("a wrong file"), std::string::npos) << reference.what;
}

}  // namespace
}  // namespace tumble::testing
