// What is believed of a world and what is asked of it (A5.1), (A5.2).
#include "tests/a5_plausible/a5_fixtures.h"

namespace tumble::a5_testing {
namespace {

// The constant that normalises a prior is free, so only differences are looked at.
double difference(const std::vector<Prior>& priors, const VectorXd& x, const VectorXd& y) {
  return student().log_prior(priors, x) - student().log_prior(priors, y);
}

TEST(LogPrior, FallsWithTheSquareOfTheDistance) {
  // z = (3.5 - 2) / 0.5 = 3: -4.5, exactly.
  const double found = difference({normal(2, 0.5)}, vector({3.5}), vector({2}));
  expect_answer(
      found, -4.5, kRoundoff * 10, "",
      {.scene = "a normal prior, mean 2, deviation 0.5: ln p(3.5) - ln p(2)",
       .slip = likely(
           found,
           {{-9, "the factor 1/2 is forgotten"},
            {-1.5, "the distance is not squared"},
            {-2.25, "divided by the deviation once: the square holds both, ((x - mean) / s)^2"},
            {-1.125, "the deviation is forgotten"},
            {-0.28125, "multiplied by the deviation: the distance is divided by it"},
            {4.5, "the sign is wrong: what is far from the mean is less probable"},
            {std::exp(-4.5) - 1, "the density itself is returned where its logarithm belongs"},
            {(std::exp(-4.5) - 1) / (0.5 * std::sqrt(2 * M_PI)),
             "the density itself is returned where its logarithm belongs"},
            {-16.5, "the mean is forgotten"}},
           "-1/2 ((x - mean) / deviation)^2"),
       .handout = equation(1)});
}

TEST(LogPrior, AddsUpOverTheNumbers) {
  const std::vector<Prior> priors = {normal(0, 1), uniform(0, 4), normal(10, 2)};
  const double found = difference(priors, vector({1, 3, 14}), vector({0, 1, 10}));
  expect_answer(found, -2.5, kRoundoff * 20, "",
                {.scene = "three numbers, one and two deviations from their means, and one that is "
                          "uniform: ln p minus that of the means",
                 .slip = likely(found,
                                {{-0.5, "only the first number counts"},
                                 {-2, "only the last number counts"},
                                 {0, "no number counts, or ln p of two worlds is the same"},
                                 {1,
                                  "logarithms are multiplied: the densities are, so their "
                                  "logarithms add"},
                                 {-2.5 / 3, "a mean over the numbers: they add"}},
                                "the sum over all numbers"),
                 .handout = equation(1)});
}

TEST(LogPrior, KnowsWhatIsImpossible) {
  const std::vector<Prior> priors = {uniform(0.2, 0.8), normal(0, 1, -1, 2)};
  const double inside = student().log_prior(priors, vector({0.5, 0}));
  if (!gives_numbers(inside, "both numbers inside their bounds", 1)) return;
  const auto story = [](const std::string& scene, const std::string& slip) {
    return Story{.scene = "uniform in [0.2, 0.8], normal cut off to [-1, 2]: " + scene,
                 .slip = slip,
                 .handout = equation(1)};
  };
  // The same density everywhere inside, and at both ends.
  const std::string flat = "a uniform prior has one density from end to end, the ends included";
  for (const double end : {0.2, 0.8}) {
    Story at_end = story("the uniform one at its bound " + show(end), flat);
    at_end.no_number = flat;
    expect_answer(student().log_prior(priors, vector({end, 0})), inside, kRoundoff * 10, "",
                  at_end);
  }
  expect_impossible(student().log_prior(priors, vector({0.1999, 0})),
                    story("below the uniform one's bound", "the lower bound is not looked at"));
  expect_impossible(student().log_prior(priors, vector({0.8001, 0})),
                    story("above the uniform one's bound", "the upper bound is not looked at"));
  expect_impossible(student().log_prior(priors, vector({0.5, -1.01})),
                    story("below the normal one's bound", "a normal prior has bounds too"));
  expect_impossible(student().log_prior(priors, vector({0.5, 2.01})),
                    story("above the normal one's bound", "a normal prior has bounds too"));
  expect_impossible(
      student().log_prior(priors, vector({kUnset, 0})),
      story("NaN for the uniform one",
            "NaN is not noticed: it is neither below nor above a bound, so ask whether x is "
            "inside, not whether it is outside"));
}

TEST(LogPrior, BearsManyNumbersFarFromTheirMeans) {
  // 200 numbers, each 3 deviations away: -900. The product of the densities is 1e-390 at most.
  const std::vector<Prior> priors(200, normal(1, 2));
  const double found = difference(priors, VectorXd::Constant(200, 7), VectorXd::Ones(200));
  expect_answer(found, -900, kRoundoff * 200 * 900, "",
                {.scene = "200 numbers, each 3 deviations from its mean",
                 .slip = std::isinf(found) || std::isnan(found)
                             ? "the product underflows to 0: add logarithms, do not take the "
                               "logarithm of a product"
                             : "the sum over all numbers",
                 .handout = equation(1)});
  const double far = student().log_prior({normal(0, 1), normal(0, 1)}, vector({1e200, 0}));
  expect_true(far < -1e300, "-infinity, or less than -1e300", show(far),
              {.scene = "a number 1e200 deviations from its mean",
               .slip = "an overflow makes NaN, or is clipped: the square exceeds the doubles, and "
                       "-infinity is right",
               .handout = equation(1)});
}

TEST(LogTarget, FallsWithTheSquareOfTheViolation) {
  const double found = student().log_target(-3.25, 0.6, 0.2);
  expect_answer(
      found, -7.75, kRoundoff * 8, "",
      {.scene = "ln p = -3.25; the ball ends 0.6 m beside the bin; softness 0.2 m",
       .slip = likely(
           found,
           {{-12.25, "the factor 1/2 is forgotten"},
            {-4.75, "the violation is not squared"},
            {-4.5, "the prior is forgotten"},
            {-3.25, "the violation is forgotten"},
            {1.25, "the sign is wrong: a violation makes a world less probable"},
            {-3.25 - 0.9, "divided by the softness once: (violation / s)^2"},
            {-3.25 * std::exp(-4.5), "multiplied where logarithms add: ln (p c) = ln p + ln c"},
            {-3.25 + std::exp(-4.5), "what is asked comes as a density: its logarithm is added"}},
           "ln p - 1/2 (violation / softness)^2"),
       .handout = equation(2)});
  expect_answer(student().log_target(-3.25, 0, 0.2), -3.25, 0, "",
                {.scene = "ln p = -3.25, and the ball ends in the bin",
                 .slip = "where nothing is violated the target is the prior",
                 .handout = equation(2)});
}

TEST(LogTarget, IsAllOrNothingWhereTheConstraintIsHard) {
  const double done = student().log_target(-3.25, 0, 0);
  expect_answer(done, -3.25, 0, "",
                {.scene = "softness 0 and violation 0, ln p = -3.25",
                 .slip = "0 / 0: a hard constraint that is met leaves the prior",
                 .handout = equation(2)});
  if (!std::isfinite(done)) return;  // reported above
  expect_impossible(student().log_target(-3.25, 1e-9, 0),
                    {.scene = "softness 0, violation 1e-9",
                     .slip = "softness 0: any violation is impossible, however small",
                     .handout = equation(2)});
}

TEST(LogTarget, KnowsWhatIsImpossible) {
  if (!gives_numbers(student().log_target(-1, 1, 1), "ln p = -1, violation 1, softness 1", 2))
    return;
  const auto story = [](const std::string& scene, const std::string& slip) {
    return Story{.scene = scene, .slip = slip, .handout = equation(2)};
  };
  expect_impossible(student().log_target(-kInfinity, 0, 0.2),
                    story("an impossible world that does what is asked",
                          "a world that the prior excludes stays impossible"));
  expect_impossible(student().log_target(-kInfinity, 0, 0),
                    story("an impossible world that meets a hard constraint",
                          "a world that the prior excludes stays impossible"));
  expect_impossible(student().log_target(-kInfinity, 3, 0),
                    story("an impossible world that does not meet a hard constraint",
                          "infinity minus infinity: ask for the cases first"));
  for (const double softness : {0.0, 0.2})
    expect_impossible(
        student().log_target(-1, kUnset, softness),
        story("the run of the world broke: its violation is NaN; softness " + show(softness),
              "a run that broke is impossible: NaN compares as neither 0 nor more, "
              "so ask for it (std::isnan)"));
  expect_impossible(student().log_target(-1, kInfinity, 0.2),
                    story("an infinite violation", "-infinity comes by itself"));
}

TEST(LogTarget, CountsInAnyUnit) {
  for (const double unit : {1e-200, 1e200}) {
    const double found = student().log_target(-1, 3 * unit, unit);
    expect_answer(found, -5.5, kRoundoff * 6, "",
                  {.scene = "violation " + show(3 * unit) + ", softness " + show(unit),
                   .slip = "squares underflow or overflow: divide first, then square",
                   .handout = equation(2)});
  }
}

}  // namespace
}  // namespace tumble::a5_testing
