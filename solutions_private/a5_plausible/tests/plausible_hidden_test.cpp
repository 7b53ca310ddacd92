// Hidden: laws that hold whatever the numbers are. Numbers are drawn from a seed.
#include <algorithm>

#include "tests/a5_plausible/a5_fixtures.h"

namespace tumble::a5_testing {
namespace {

double at_place(const VectorXd& x) { return x.size() == 1 ? x[0] : kUnset; }

/// Integral of the proposal's density over `to` in [low, high], by the midpoint rule.
double share_between(const Proposal& proposal, double from, double low, double high, int points) {
  double sum = 0.0;
  for (int i = 0; i < points; ++i) {
    const double to = low + (high - low) * (i + 0.5) / points;
    sum += std::exp(student().log_proposal(proposal, vector({from}), vector({to})));
  }
  return sum * (high - low) / points;
}

TEST(HiddenLogPrior, LooksAtEachNumberAlone) {
  Random random(21);
  std::vector<Prior> priors;
  VectorXd x(6), y(6);
  for (int i = 0; i < 6; ++i) {
    priors.push_back(i % 3 == 2 ? uniform(-2, 2) : normal(random.between(-1, 1), 0.3 + i));
    x[i] = random.between(-1, 1), y[i] = random.between(-1, 1);
  }
  const double all = student().log_prior(priors, x) - student().log_prior(priors, y);
  double one_by_one = 0.0;
  for (int i = 5; i >= 0; --i)
    one_by_one += student().log_prior({priors[static_cast<std::size_t>(i)]}, vector({x[i]})) -
                  student().log_prior({priors[static_cast<std::size_t>(i)]}, vector({y[i]}));
  expect_answer(all, one_by_one, kRoundoff * 50, "",
                {.scene = "six numbers at once, and one by one from the last",
                 .slip = "each number counts by itself, and all add",
                 .handout = equation(1)});
}

TEST(HiddenLogProposal, IntegratesToOne) {
  // The midpoint rule on a density that is smooth and vanishes at both ends: better than 1e-9.
  const auto story = [](const std::string& scene) {
    return Story{.scene = scene,
                 .slip =
                     "a density of `to` integrates to 1: what normalises, the Jacobian, the "
                     "shares",
                 .handout = equation(4)};
  };
  expect_answer(share_between({{add(0.7)}, 0.3, 4.0}, 2, -30, 34, 300), 1, 1e-6, "",
                story("size 0.7, wide steps of 4 times that with share 0.3: over all places"));
  expect_answer(share_between({{multiply(0.25)}, 0.4, 2.0}, 2, 0.0, 40, 800), 1, 1e-6, "",
                story("multiplied by exp(0.25 z), wide 2 times that with share 0.4"));
}

TEST(HiddenLogProposal, IsTheDensityOfPropose) {
  // 1000 proposals fall into 8 cells as their density says: 7 degrees of freedom, 29.9 once in
  // 10,000 seeds.
  const Proposal proposal{{multiply(0.4)}, 0.35, 3.0};
  const std::vector<double> bounds = {0.0, 0.6, 1.0, 1.4, 1.8, 2.2, 2.8, 4.5, 1e9};
  Random random(22);
  std::vector<int> counts(8, 0);
  constexpr int kDraws = 1000;
  for (int i = 0; i < kDraws; ++i) {
    const double to = at_place(student().propose(proposal, vector({2}), draws_of(random, 1)));
    for (std::size_t cell = 0; cell < 8; ++cell)
      if (to >= bounds[cell] && to < bounds[cell + 1]) ++counts[cell];
  }
  std::vector<double> expected;
  double rest = 1.0;
  for (std::size_t cell = 0; cell < 7; ++cell) {
    const double share = share_between(proposal, 2, bounds[cell], bounds[cell + 1], 60);
    expected.push_back(kDraws * share);
    rest -= share;
  }
  expected.push_back(kDraws * rest);
  const double found = chi_square(counts, expected);
  expect_true(found < 29.9, "chi-square below 29.9 (7 degrees of freedom)", show(found),
              {.scene = "1000 proposals from x = 2, counted, against what log_proposal says",
               .slip = "propose and log_proposal are not about the same proposal",
               .handout = equation(4)});
}

TEST(HiddenLogAcceptance, HoldsDetailedBalanceBetweenAnyTwoPlaces) {
  Random random(23);
  for (int i = 0; i < 40; ++i) {
    const double from = random.between(-8, 0), to = random.between(-8, 0),
                 forth = random.between(-4, 0), back = random.between(-4, 0);
    const double there = from + forth + student().log_acceptance(from, to, forth, back),
                 home = to + back + student().log_acceptance(to, from, back, forth);
    expect_answer(there, home, 1e-12, "ln of the flow",
                  {.scene = "ln pi = " + show(from) + " and " + show(to) +
                            ", ln q = " + show(forth) + " forth and " + show(back) + " back",
                   .slip = acceptance_slip("pi(x) q(x' | x) a(x, x') is the same forth and back"),
                   .handout = equation(5)});
    expect_answer(std::max(there - from - forth, home - to - back), 0, 1e-12, "ln a",
                  {.scene = "the same two places",
                   .slip = acceptance_slip("of two ways one is always accepted"),
                   .handout = equation(5)});
  }
}

TEST(HiddenMetropolisStep, KeepsACutOffDistributionOfTwoNumbers) {
  // A normal number cut off to [-1/2, 1], and a uniform one that is multiplied: exact draws stay
  // exact draws. 5 cells of each: 4 degrees of freedom, 23.5 once in 10,000 seeds.
  const std::vector<Prior> priors = {normal(0, 1, -0.5, 1), uniform(0.5, 4)};
  const LogDensity density = [&](const VectorXd& x) {
    if (x.size() != 2) return kUnset;
    double log_density = -0.5 * x[0] * x[0];
    for (int i = 0; i < 2; ++i)
      if (!(x[i] >= priors[static_cast<std::size_t>(i)].low &&
            x[i] <= priors[static_cast<std::size_t>(i)].high))
        log_density = -kInfinity;
    return log_density;
  };
  const Proposal proposal{{add(0.4), multiply(0.3)}, 0.3, 3.0};
  const auto cumulative = [](double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); };
  const double low = cumulative(-0.5), high = cumulative(1);
  constexpr int kChains = 400, kCells = 5, kSteps = 3;
  Random random(24);
  std::vector<int> first(kCells, 0), second(kCells, 0);
  for (int i = 0; i < kChains; ++i) {
    ChainState state{vector({normal_quantile(random.between(low, high)), random.between(0.5, 4)}),
                     kUnset, false};
    state.log_target = density(state.x);
    for (int k = 0; k < kSteps; ++k) {
      state = student().metropolis_step(density, proposal, state, draws_of(random, 2));
      if (state.x.size() != 2) break;
    }
    if (state.x.size() != 2) break;
    const double u = (cumulative(state.x[0]) - low) / (high - low), v = (state.x[1] - 0.5) / 3.5;
    if (!(u >= 0 && u <= 1 && v >= 0 && v <= 1)) continue;
    ++first[static_cast<std::size_t>(std::min(kCells - 1.0, std::floor(u * kCells)))];
    ++second[static_cast<std::size_t>(std::min(kCells - 1.0, std::floor(v * kCells)))];
  }
  const std::vector<double> expected(kCells, kChains / double{kCells});
  const std::pair<const char*, double> found[] = {{"added to", chi_square(first, expected)},
                                                  {"multiplied", chi_square(second, expected)}};
  for (const auto& [how, chi] : found)
    expect_true(
        chi < 23.5, "chi-square below 23.5 (4 degrees of freedom)", show(chi),
        {.scene = std::string("400 chains of two numbers with bounds; the one that is ") + how,
         .steps = "3 steps each from exact draws",
         .slip = acceptance_slip("a proposal outside the bounds leaves the chain where it "
                                 "is, once more"),
         .handout = equation(6)});
}

TEST(HiddenMetropolisStep, LeavesAnImpossibleStart) {
  const LogDensity density = [](const VectorXd& x) {
    return x.size() == 1 && x[0] > 3 ? -x[0] : -kInfinity;
  };
  const Proposal proposal{{add(1)}, 0.0, 1.0};
  ChainState state{vector({0}), -kInfinity, false};
  state = student().metropolis_step(density, proposal, state, draws_with(vector({2}), 0.9, 0.5));
  expect_answer(at_place(state.x), 0, 0, "",
                {.scene = "from 0, where pi is 0, to 2, where it is 0 too",
                 .slip = "an impossible place is never entered",
                 .handout = equation(6)});
  state = student().metropolis_step(density, proposal, state, draws_with(vector({4}), 0.9, 0.999));
  expect_answer(at_place(state.x), 4, 0, "",
                {.scene = "from 0, where pi is 0, to 4, where it is not; u = 0.999",
                 .slip = "what is possible is accepted from an impossible place",
                 .handout = equation(6)});
  expect_answer(
      state.log_target, -4, 0, "",
      {.scene = "the same step", .slip = "ln pi of the new place", .handout = equation(6)});
}

TEST(HiddenAutocorrelation, SumsToMinusOneHalf) {
  // (sum of centred numbers)^2 = 0 = c_0 + 2 sum of c_t, over all lags.
  Random random(25);
  for (const Eigen::Index n : {5, 40}) {
    const VectorXd found = student().autocorrelation(ar1(random, 0.6, n), static_cast<int>(n) - 1);
    expect_answer(found.tail(n - 1).sum(), -0.5, kRoundoff * 200, "",
                  {.scene = "a chain of " + std::to_string(n) + " steps, all lags but 0 together",
                   .slip = "the mean of the whole chain, and the divisor n at every lag",
                   .handout = equation(7)});
  }
}

TEST(HiddenEffectiveSampleSize, KnowsNoUnitNoOrderAndNoDirection) {
  const std::vector<VectorXd> chains = ar1_chains(26, 0.7, 3, 100);
  const double plain = student().effective_sample_size(chains);
  if (!gives_numbers(plain, "3 chains of 100 steps", 8)) return;
  std::vector<VectorXd> reversed = {chains[2], chains[0], chains[1]};
  for (VectorXd& chain : reversed) chain = chain.reverse().eval();
  expect_answer(student().effective_sample_size(reversed), plain, 1e-9 * plain, "samples",
                {.scene = "3 chains of 100 steps; and in another order, backwards",
                 .slip = "a correlation is the same forth and back, and no chain is the first",
                 .handout = equation(8)});
  expect_answer(
      student().effective_sample_size(mapped(chains, [](double x) { return 0x1p20 - 8 * x; })),
      plain, 1e-6 * plain, "samples",
      {.scene = "the same chains as 2^20 - 8 x",
       .slip = "means are taken off before squares are summed",
       .handout = equation(8)});
}

TEST(HiddenEffectiveSampleSize, CountsARepeatedSampleOnce) {
  // Each step of independent ones three times: S / 3, known to a tenth or so.
  const std::vector<VectorXd> chains = ar1_chains(27, 0.0, 4, 400);
  std::vector<VectorXd> slow;
  for (const VectorXd& chain : chains) {
    VectorXd thrice(3 * chain.size());
    for (Eigen::Index i = 0; i < thrice.size(); ++i) thrice[i] = chain[i / 3];
    slow.push_back(thrice);
  }
  expect_answer(student().effective_sample_size(slow), 1600, 320, "samples",
                {.scene = "4 chains of 400 independent samples, each of them three times",
                 .slip = "who stays where it is tells nothing new",
                 .handout = equation(8)});
}

TEST(HiddenSplitRHat, AgreesWithASecondComputation) {
  // Values of an independent program, with the quantile of another library.
  const std::vector<VectorXd> longer = {vector({4, 2, 1, 4, 1, 3, 3, 4, 5, 4, 2, 3, 6, 4, 1, 0}),
                                        vector({0, 2, 4, 7, 4, 6, 7, 9, 6, 3, 4, 6, 5, 5, 3, 5})};
  const std::vector<VectorXd> odd = {vector({0, 1, 3, 2, 7, 4, 3, 5, 2}),
                                     vector({1, 2, 2, 4, 0, 6, 5, 3, 4})};
  const std::vector<VectorXd> ties = {vector({0, 0, 1, 1, 0, 1, 0, 1}),
                                      vector({0, 1, 1, 1, 1, 0, 1, 1})};
  const std::vector<VectorXd> widths = {vector({-1, 1, -2, 2, -1.5, 1.5, -0.5, 0.5}),
                                        vector({-8, 8, -6, 6, -7, 7, -9, 9})};
  const struct {
    const char* scene;
    const std::vector<VectorXd>& chains;
    double expected;
    const char* slip;
  } cases[] = {{"two chains of 16", longer, 1.0732485061474162, "(A5.9) step by step"},
               {"two chains of 9: their middle numbers are left out", odd, 1.3493250991984624,
                "the middle of an odd number is left out"},
               {"two chains of zeros and ones", ties, 0.9063269671749657,
                "equal numbers share the mean of their ranks"},
               {"two chains of one centre, the second wider", widths, 1.9973713337470917,
                "the larger of the two parts: folded numbers see widths"}};
  for (const auto& c : cases)
    expect_answer(student().split_r_hat(c.chains), c.expected, 1e-12, "",
                  {.scene = c.scene, .slip = c.slip, .handout = equation(9)});
}

TEST(HiddenSplitRHat, KnowsNoOrderAndNoDirection) {
  const std::vector<VectorXd> chains = ar1_chains(28, 0.9, 3, 60);
  const double plain = student().split_r_hat(chains);
  if (!gives_numbers(plain, "3 chains of 60 steps", 9)) return;
  std::vector<VectorXd> reversed = {chains[1], chains[2], chains[0]};
  for (VectorXd& chain : reversed) chain = chain.reverse().eval();
  expect_answer(student().split_r_hat(reversed), plain, 1e-9, "",
                {.scene = "3 chains of 60 steps; and in another order, backwards",
                 .slip = "halves are halves from either end, and no chain is the first",
                 .handout = equation(9)});
}

TEST(HiddenMonteCarloAnswer, IsAsWrongAsItSaysAtTwoErrors) {
  // 95.45 in 100: of 100 experiments with a deviation of 2, and S_eff is known to 15 %.
  constexpr int kExperiments = 100;
  int within = 0;
  for (int i = 0; i < kExperiments; ++i) {
    const Answer answer =
        student().monte_carlo_answer(ar1_chains(700 + static_cast<std::uint64_t>(i), 0.5, 3, 200));
    within += std::abs(answer.mean) <= 2 * answer.standard_error ? 1 : 0;
  }
  expect_answer(
      within, 0.9545 * kExperiments, 8, "of 100 experiments",
      {.scene = "3 chains of 200 steps with correlation 0.5^t, whose mean is 0: how often "
                "the answer is within two standard errors",
       .slip = "deviation / sqrt(S_eff)",
       .handout = equation(10)});
}

}  // namespace
}  // namespace tumble::a5_testing
