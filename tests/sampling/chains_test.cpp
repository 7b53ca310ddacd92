// Chains over the worlds of a scene, by the reference's functions: they sample what brute force
// samples.
#include <cmath>
#include <iterator>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/support/places.h"
#include "framework/engines/run.h"
#include "framework/modules/load.h"
#include "framework/modules/registry.h"
#include "framework/sampling/answers.h"
#include "framework/sampling/sampler.h"
#include "framework/scene/load_sampling.h"
#include "framework/scene/load_scene.h"
#include "tests/engines/reference_laws.h"
#include "tests/support/test_laws.h"

namespace tumble::sampling {
namespace {

namespace fs = std::filesystem;

Sampling reference() {
  modules::Registry registry;
  register_assignments(registry);
  const modules::ModuleKind& kind = registry.find("a5");
  const fs::path file = fs::path(test::binary_dir()) / "modules" / "a5_reference.so";
  return kind.note<Sampler>().functions(modules::load_module(kind, file));
}

SampledScene scene_named(const std::string& name) {
  const scene::Scene scene = scene::load_scene(
      fs::path(test::source_dir()) / "assignments/a5_plausible/scenes" / (name + ".json"));
  return {scene, scene::load_sampling(scene).value()};
}
SampledScene ball_into_bin() { return scene_named("ball_into_bin"); }

engines::RunOptions in_closed_form() {
  engines::RunOptions options;
  options.propagator = "auto";
  return options;
}

TEST(Chains, AgreeWithBruteForceOnTheBallInTheBin) {
  const SampledScene scene = ball_into_bin();
  const Laws laws = testing::test_laws();
  const Sampling by = reference();
  const std::vector<std::string> names = names_of(scene);
  ChainOptions options;
  options.samples = 600;
  options.warm_up = 150;
  std::vector<Chain> chains;
  for (int number = 0; number < 4; ++number)
    chains.push_back(run_chain(scene, by, laws, in_closed_form(), options, number));
  const Answers ours = answers_of(by, names, chains, options.samples);
  const std::vector<Chain> drawn = cut(draw_prior(scene, laws, in_closed_form(), 5, 3000), 8);
  const Answers brute = answers_of(by, names, drawn, static_cast<int>(drawn.front().x.rows()));
  ASSERT_GT(brute.done, 100) << "too few worlds of the prior do it: nothing to compare with";
  EXPECT_EQ(ours.broken + brute.broken, 0);
  EXPECT_LT(ours.worst_r_hat, 1.2);  // not yet 1.01: errors are honest all the same
  for (std::size_t i = 0; i < names.size(); ++i) {
    const Answer &a = ours.estimates[i].answer, &b = brute.estimates[i].answer;
    EXPECT_LE(std::abs(a.mean - b.mean), 3.0 * std::hypot(a.standard_error, b.standard_error))
        << names[i] << ": " << a.mean << " +- " << a.standard_error << " by chains, " << b.mean
        << " +- " << b.standard_error << " by the prior";
  }
  // What is asked says something: one of the means is far from its prior's.
  double farthest = 0.0;
  const std::vector<Prior> priors = priors_of(scene);
  for (std::size_t i = 0; i < names.size(); ++i)
    farthest = std::max(farthest, std::abs(brute.estimates[i].answer.mean - priors[i].mean) /
                                      brute.estimates[i].answer.standard_error);
  EXPECT_GT(farthest, 6.0);
}

// Of 6000 worlds of the prior, which take a minute, so their answers stand here:
//   tumble sample two_sixes --prior 6000 --seed 2
// Means and standard errors by number.
constexpr double kSixes[][2] = {{-0.13, 0.18}, {1.44, 0.12}, {-0.09, 0.17}, {1.17, 0.13}};

TEST(Chains, AgreeWithBruteForceOnTwoSixes) {
  const SampledScene scene = scene_named("two_sixes");
  const Laws laws = testing::reference_laws();
  const Sampling by = reference();
  const std::vector<std::string> names = names_of(scene);
  ASSERT_EQ(names.size(), std::size(kSixes));
  ChainOptions options;
  options.samples = 170;
  options.warm_up = 30;
  std::vector<Chain> chains;
  for (int number = 0; number < 4; ++number)
    chains.push_back(run_chain(scene, by, laws, in_closed_form(), options, number));
  const Answers ours = answers_of(by, names, chains, options.samples);
  EXPECT_EQ(ours.broken, 0);
  EXPECT_GT(ours.done, 40);  // of 680; by the prior alone about twelve
  for (std::size_t i = 0; i < names.size(); ++i) {
    const Answer& a = ours.estimates[i].answer;
    EXPECT_LE(std::abs(a.mean - kSixes[i][0]), 3.0 * std::hypot(a.standard_error, kSixes[i][1]))
        << names[i] << ": " << a.mean << " +- " << a.standard_error << " by chains";
  }
  // What is asked says something: dice that show a six turned less than they are believed to.
  for (const std::size_t spin : {1, 3})
    EXPECT_LT(ours.estimates[spin].answer.mean,
              priors_of(scene)[spin].mean - 3.0 * ours.estimates[spin].answer.standard_error);
}

TEST(Chains, AreTheSameWhateverOthersDo) {
  const SampledScene scene = ball_into_bin();
  const Laws laws = testing::test_laws();
  const Sampling by = reference();
  ChainOptions options;
  options.samples = 20;
  options.warm_up = 5;
  const Chain after_others = [&] {
    run_chain(scene, by, laws, in_closed_form(), options, 0);
    return run_chain(scene, by, laws, in_closed_form(), options, 1);
  }();
  const Chain alone = run_chain(scene, by, laws, in_closed_form(), options, 1);
  EXPECT_EQ(alone.x, after_others.x);
  EXPECT_EQ(alone.violation, after_others.violation);
  EXPECT_EQ(alone.log_target, after_others.log_target);
  const Chain other = run_chain(scene, by, laws, in_closed_form(), options, 2);
  EXPECT_NE(alone.x, other.x);
}

TEST(Chains, NeverLeaveWhatTheSceneCanHold) {
  // A log_prior that knows no bounds: worlds beyond them are not run.
  const SampledScene scene = ball_into_bin();
  const Laws laws = testing::test_laws();
  Sampling by = reference();
  by.log_prior = [](const std::vector<Prior>&, const VectorXd&) { return 0.0; };
  ChainOptions options;
  options.samples = 60;
  options.warm_up = 0;
  const Chain chain = run_chain(scene, by, laws, in_closed_form(), options, 0);
  const std::vector<Prior> priors = priors_of(scene);
  for (std::size_t i = 0; i < priors.size(); ++i) {
    const auto numbers = chain.x.col(static_cast<Eigen::Index>(i));
    EXPECT_GE(numbers.minCoeff(), priors[i].low);
    EXPECT_LE(numbers.maxCoeff(), priors[i].high);
  }
  EXPECT_EQ(chain.broken, 0);
}

}  // namespace
}  // namespace tumble::sampling
