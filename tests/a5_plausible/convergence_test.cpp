// How far the answers of chains can be trusted (A5.7) to (A5.10): on chains short enough for paper,
// and on chains of a known law.
#include "tests/a5_plausible/a5_fixtures.h"

namespace tumble::a5_testing {
namespace {

double at_lag(const VectorXd& rho, Eigen::Index t) { return t < rho.size() ? rho[t] : kUnset; }

// ---- Autocorrelation ----

TEST(Autocorrelation, OfFourNumbers) {
  // 1, 2, 3, 4 about their mean: -3/2, -1/2, 1/2, 3/2. Sums of products 5, 5/4, -3/2, -9/4.
  const VectorXd found = student().autocorrelation(vector({1, 2, 3, 4}), 3);
  expect_answer(found, vector({1, 0.25, -0.3, -0.45}), kRoundoff, "",
                {.scene = "the chain 1, 2, 3, 4; lags 0 to 3",
                 .slip = likely(at_lag(found, 1),
                                {{1.0 / 3, "the divisor is n at every lag, not n - t"},
                                 {2.0 / 3, "the mean is not taken off"},
                                 {8.0 / 9, "the mean is not taken off"},
                                 {0.3125, "c_t is not divided by c_0"},
                                 {1.25, "neither divided by n nor by c_0"},
                                 {1, "every lag is lag 0"},
                                 {-0.3, "lags are counted from 1: the first is lag 0"}},
                                "rho_t = c_t / c_0, with the mean of the whole chain"),
                 .handout = equation(7)});
}

TEST(Autocorrelation, KnowsNoOriginAndNoUnit) {
  const VectorXd chain = vector({1, 3, 2, 5, 4, 4, 6, 2}),
                 plain = student().autocorrelation(chain, 4);
  if (!gives_numbers(at_lag(plain, 1), "the chain 1, 3, 2, 5, 4, 4, 6, 2", 7)) return;
  // 2^30 is added without rounding; the mean of eight is exact too.
  const VectorXd far = student().autocorrelation((chain.array() + 0x1p30).matrix(), 4);
  expect_answer(
      far, plain, 100 * kRoundoff, "",
      {.scene = "the chain 1, 3, 2, 5, 4, 4, 6, 2, and the same with 2^30 added",
       .slip = "the mean of the squares minus the square of the mean loses all digits: take "
               "off the mean first",
       .handout = equation(7),
       .no_number = "the mean of the squares minus the square of the mean loses all digits: take "
                    "off the mean first"});
  expect_answer(student().autocorrelation(-0.001 * chain, 4), plain, 100 * kRoundoff, "",
                {.scene = "the chain 1, 3, 2, 5, 4, 4, 6, 2, times -0.001",
                 .slip = "a correlation has no unit: c_t is divided by c_0",
                 .handout = equation(7)});
}

TEST(Autocorrelation, IsThatOfAKnownLaw) {
  // Of x' = phi x + noise it is phi^t. In 4000 steps it is known to about 0.03: 4 times that.
  Random random(3);
  const VectorXd found = student().autocorrelation(ar1(random, 0.8, 4000), 10);
  VectorXd expected(11);
  for (int t = 0; t <= 10; ++t) expected[t] = std::pow(0.8, t);
  expect_answer(found, expected, 0.12, "",
                {.scene = "4000 steps of x' = 0.8 x + 0.6 z, whose correlation is 0.8^t",
                 .slip = "c_t / c_0",
                 .handout = equation(7)});
}

TEST(Autocorrelation, OfAChainThatStandsStillIsUnknown) {
  if (!gives_numbers(at_lag(student().autocorrelation(vector({1, 2, 4}), 1), 1),
                     "the chain 1, 2, 4", 7))
    return;
  // The mean of three times 0.1 is not 0.1: c_0 of the rounding is not 0.
  for (const double x : {2.0, 0.1}) {
    const VectorXd found = student().autocorrelation(VectorXd::Constant(3, x), 1);
    for (Eigen::Index t = 0; t < found.size(); ++t)
      expect_unknown(found[t],
                     {.scene = "the chain " + show(x) + ", three times; lag " + std::to_string(t),
                      .slip = "0 / 0, or the rounding of a mean taken for a variance: "
                              "where all numbers are equal nothing is known",
                      .handout = equation(7)});
  }
}

// ---- Effective sample size ----

TEST(EffectiveSampleSize, OfTwoShortChains) {
  // Halves (0, 1, 3, 2), (4, 3, 5, 2), (1, 2, 2, 4), (6, 5, 3, 4): W = 79/48, B/N = 113/64,
  // var_plus = 3, tau = 455/144.
  const double found = student().effective_sample_size(short_chains());
  expect_answer(
      found, 2304.0 / 455, kRoundoff * 50, "samples",
      {.scene =
           "chains 0, 1, 3, 2, 4, 3, 5, 2 and 1, 2, 2, 4, 6, 5, 3, 4: worked out in the handout",
       .slip = likely(
           found,
           {{9.62970200293112, "the chains are not cut into halves first"},
            {19.265919722494797, "the variance between the means is left out of var_plus"},
            {5.29350947731189, "c_t has the divisor N, W the divisor N - 1: use c_t N / (N - 1)"},
            {3.1009421265141324, "tau begins at -1: lag 0 is in the first pair, and counts once"},
            {3.846410684474124, "tau begins at -1: lag 0 is in the first pair, and counts once"},
            {14.81672025723473, "each pair counts twice in tau"},
            {7.3220338983050866, "c_t has the divisor N at every lag"},
            {455.0 / 144, "tau is returned: S_eff = S / tau"}},
           "W, B/N, var_plus, rho_t, pairs, tau, one after the other: the handout has each of "
           "them"),
       .handout = "handouts/a5_plausible.md#worked-example"});
}

TEST(EffectiveSampleSize, SumsPairsWhileTheyArePositiveAndFall) {
  const std::vector<VectorXd> chains = {vector({4, 2, 1, 4, 1, 3, 3, 4, 5, 4, 2, 3, 6, 4, 1, 0}),
                                        vector({0, 2, 4, 7, 4, 6, 7, 9, 6, 3, 4, 6, 5, 5, 3, 5})};
  const double found = student().effective_sample_size(chains);
  expect_answer(
      found, 17.405804749340373, kRoundoff * 200, "samples",
      {.scene = "two chains of 16 whose pairs rise again, and fall below 0",
       .slip = likely(found,
                      {{13.408130081300815,
                        "a pair that is larger than the one before it counts "
                        "as that one: P_k <- min(P_k, P_(k-1))"},
                       {21.12666132906325, "the sum ends at the first pair that is not positive"},
                       {8.600370330029408, "the chains are not cut into halves first"},
                       {26.484372921931115, "the variance between the means is left out"},
                       {18.935577043827703, "c_t N / (N - 1): its divisor is N, that of W N - 1"},
                       {8.336661190446101, "tau begins at -1"},
                       {11.273690506707682, "tau begins at -1"},
                       {48.16479930623699, "each pair counts twice in tau"},
                       {18.81152866890722, "c_t has the divisor N at every lag"}},
                      "pairs of lags (0, 1), (2, 3), ...: their sums, not each lag"),
       .handout = equation(8)});
}

TEST(EffectiveSampleSize, HoldsPairsDownByTheSmallestBefore) {
  // Pairs 1.646, 0.608, 0.158, 0.336, 0.720: the last two count as 0.158 each.
  const std::vector<VectorXd> chains = {
      vector({2, 1, 2, 4, 3, 4, 6, 7, 5, 4, 6, 4, 3, 1, 0, 0, 0, 2, 3, 5}),
      vector({1, 3, 2, 1, 3, 2, 3, 1, 2, 1, 1, 1, 1, 2, 1, 3, 1, 0, 0, 0})};
  const double found = student().effective_sample_size(chains);
  expect_answer(
      found, 8.978543156725223, kRoundoff * 200, "samples",
      {.scene = "two chains of 20 whose pairs fall, and then rise twice",
       .slip =
           likely(found,
                  {{8.31297415455831, "P_(k-1) is the one that has been held down, not as it was"},
                   {6.737884314747263,
                    "a pair that is larger than the one before it counts as that "
                    "one: P_k <- min(P_k, P_(k-1))"}},
                  "see SumsPairsWhileTheyArePositiveAndFall first"),
       .handout = equation(8)});
}

TEST(EffectiveSampleSize, LeavesOutTheMiddleOfAnOddNumber) {
  const std::vector<VectorXd> chains = {vector({0, 1, 3, 2, 7, 4, 3, 5, 2}),
                                        vector({1, 2, 2, 4, 0, 6, 5, 3, 4})};
  expect_answer(student().effective_sample_size(chains), 2304.0 / 455, kRoundoff * 50, "samples",
                {.scene = "the chains of the handout with one more number in the middle of each",
                 .slip = "halves have the same length: the first (n - 1)/2 and the last (n - 1)/2",
                 .handout = equation(8)});
}

TEST(EffectiveSampleSize, OfAKnownLaw) {
  // S (1 - phi) / (1 + phi), known to about 10 % here; twice that. Independent ones: S.
  for (const double phi : {0.9, 0.5, 0.0}) {
    const double found = student().effective_sample_size(ar1_chains(7, phi, 4, 1500));
    const double exact = 6000 * (1 - phi) / (1 + phi);
    expect_answer(
        found, exact, 0.2 * exact, "samples",
        {.scene =
             "4 chains of 1500 steps of x' = " + show(phi) + " x + noise: S (1 - phi) / (1 + phi)",
         .slip = found > 1.5 * exact ? "correlations are left out of tau: each pair counts "
                                       "twice, all pairs that are positive"
                                     : "tau is too large: it is 1 for independent samples",
         .handout = equation(8)});
  }
}

TEST(EffectiveSampleSize, MayExceedTheNumberOfSamples) {
  // Chains that swing from side to side: no pair is positive, tau is at its least, 1/log10(16).
  const VectorXd swing = vector({1, -1, 1, -1, 1, -1, 1, -1});
  expect_answer(student().effective_sample_size({swing, swing}), 16 * std::log10(16.0),
                kRoundoff * 40, "samples",
                {.scene = "two chains 1, -1, 1, -1, ... of 8",
                 .slip = "tau is at least 1/log10(S), so that errors which cancel do not claim an "
                         "infinite number, or a negative one",
                 .handout = equation(8)});
}

TEST(EffectiveSampleSize, SeesChainsThatDisagree) {
  std::vector<VectorXd> chains = ar1_chains(8, 0.0, 4, 500);
  const double agreed = student().effective_sample_size(chains);
  chains[3].array() += 8;
  const double found = student().effective_sample_size(chains);
  expect_true(agreed > 1000, "more than 1000 where the four chains agree", show(agreed),
              {.scene = "4 chains of 500 independent samples",
               .slip = "independent samples count almost fully",
               .handout = equation(8)});
  expect_true(found < 12, "less than 12: four chains, whose halves agree", show(found),
              {.scene = "4 chains of 500 independent samples, the last one moved by 8 deviations",
               .slip = "the variance between the means belongs in var_plus: each chain alone looks "
                       "independent",
               .handout = equation(8)});
}

TEST(EffectiveSampleSize, OfChainsThatStandStill) {
  if (!gives_numbers(student().effective_sample_size(short_chains()), "the handout's chains", 8))
    return;
  const std::vector<VectorXd> still(3, VectorXd::Constant(10, 0.1));
  expect_unknown(student().effective_sample_size(still),
                 {.scene = "three chains of ten times 0.1",
                  .slip = "0 / 0, or the rounding of a mean taken for a variance",
                  .handout = equation(8)});
  // rho_t = 1 at every lag: five whole pairs of halves of 10, and of 11, so tau = -1 + 2 * 10.
  for (const int length : {20, 22}) {
    const std::vector<VectorXd> apart = {VectorXd::Constant(length, 0.1),
                                         VectorXd::Constant(length, 0.3)};
    const double found = student().effective_sample_size(apart), samples = 2.0 * length;
    expect_answer(
        found, samples / 19, kRoundoff * 40, "samples",
        {.scene = "one chain of 0.1 alone, one of 0.3, " + std::to_string(length) + " numbers each",
         .slip = likely(found,
                        {{samples / 21,
                          "the last lag of halves of an odd length "
                          "has no partner: whole pairs count"}},
                        "c_t of a half that stands still is 0, and not unknown: what is "
                        "known is between the halves"),
         .handout = equation(8)});
  }
}

// ---- R-hat ----

TEST(SplitRHat, OfTwoShortChains) {
  const double found = student().split_r_hat(short_chains());
  expect_answer(
      found, 1.3493250991984624, 1e-13, "",
      {.scene = "chains 0, 1, 3, 2, 4, 3, 5, 2 and 1, 2, 2, 4, 6, 5, 3, 4",
       .slip = likely(
           found,
           {{1.0102422599602796, "the chains are not cut into halves first"},
            {1.3501054811112287, "the numbers are used where their scores z belong"},
            {1.8206782233269403, "the root is forgotten"},
            {0.7411112419045851, "W / var_plus, upside down"},
            {1 / 0.8915603050519727, "W / var_plus, upside down"},
            {0.8915603050519727, "only the folded part is counted: R is the larger of the two"},
            {1.43898513659, "var_plus has (N - 1)/N of W"},
            {1.3561713934794544, "equal numbers share the mean of their ranks"},
            {1.337951748212715, "equal numbers share the mean of their ranks"},
            {1.3475380546485851, "scores are those of (r - 3/8) / (S + 1/4)"},
            {1.35205007368549, "scores are those of (r - 3/8) / (S + 1/4)"}},
           "ranks from 1 among all numbers, their scores, W and var_plus of these"),
       .handout = equation(9)});
}

TEST(SplitRHat, FoldsAboutTheMedianOfAll) {
  // One centre, far from 0 and not the mean; the second chain is wider. Only the folded part sees
  // it: R of the numbers themselves is 0.877.
  const double found = student().split_r_hat(
      {vector({9, 11, 8, 12, 8.5, 11.5, 9.5, 10.5}), vector({2, 18, 4, 40, 3, 17, 1, 19})});
  expect_answer(
      found, 1.826160123181032, 1e-13, "",
      {.scene = "chains 9, 11, 8, 12, 8.5, 11.5, 9.5, 10.5 and 2, 18, 4, 40, 3, 17, 1, 19",
       .slip = likely(
           found,
           {{1.7097278871735966, "folded about the mean: |x - median|"},
            {0.8768595012101837, "the larger of two parts counts: that of |x - median|, too"},
            {1.7435874808173923, "of an even number the median is the mean of the middle two"},
            {1.7383055406435597, "of an even number the median is the mean of the middle two"},
            {1.857766972257367, "the scores are folded: the numbers are, and then ranked"},
            {1.7589704936717692, "the scores are folded: the numbers are, and then ranked"},
            {1.321675985696764, "the folded numbers are ranked, too"},
            {1.877861993175163, "one median, of all numbers of all halves"}},
           "R(|x - median of all S numbers|), of scores like R(x)"),
       .handout = equation(9)});
}

TEST(SplitRHat, IsNear1WhereChainsAgree) {
  const double found = student().split_r_hat(ar1_chains(9, 0.3, 4, 1000));
  // Below 1.01 is what is asked of chains; W cannot exceed var_plus by more than its factor.
  expect_true(found > 0.998 && found < 1.01, "between 0.998 and 1.01", show(found),
              {.scene = "4 chains of 1000 steps that sample one distribution",
               .slip = "sqrt(var_plus / W) is 1 where chains agree",
               .handout = equation(9)});
}

TEST(SplitRHat, SeesChainsThatDisagree) {
  std::vector<VectorXd> moved = ar1_chains(10, 0.0, 4, 500), wide = moved, drifting = moved;
  moved[0].array() += 1;
  wide[0] *= 4;
  for (VectorXd& chain : drifting)
    for (Eigen::Index i = 0; i < chain.size(); ++i)
      chain[i] += 2.0 * static_cast<double>(i) / static_cast<double>(chain.size());
  const auto expect_seen = [](double found, const std::string& scene, const std::string& slip) {
    expect_true(found > 1.03, "above 1.03", show(found),
                {.scene = scene, .slip = slip, .handout = equation(9)});
  };
  expect_seen(student().split_r_hat(moved), "4 chains of 500, one moved by 1 deviation",
              "the variance between the means is left out");
  expect_seen(student().split_r_hat(wide), "4 chains of 500 with one mean, one 4 times as wide",
              "folding is left out: R of |x - median| sees widths, and the larger R counts");
  expect_seen(student().split_r_hat(drifting),
              "4 chains of 500, all drifting alike by 2 deviations",
              "the chains are not cut into halves: each drifts, and they agree with each other");
}

TEST(SplitRHat, LooksAtRanksAlone) {
  const std::vector<VectorXd> chains = ar1_chains(12, 0.5, 3, 200);
  const double plain = student().split_r_hat(chains);
  if (!gives_numbers(plain, "3 chains of 200 steps", 9)) return;
  // Moving and stretching change neither ranks nor their distances from the median.
  const double moved =
      student().split_r_hat(mapped(chains, [](double x) { return 1000 - 0.25 * x; }));
  expect_answer(moved, plain, 1e-9, "",
                {.scene = "3 chains of 200 steps, and the same as 1000 - x/4",
                 .slip = "R has no unit: ranks of -x are those of x from the other end",
                 .handout = equation(9)});
  // 0.1 % of the numbers of a Cauchy law are as large as 600: a variance says nothing of them.
  std::vector<VectorXd> cauchy = ar1_chains(13, 0.0, 4, 500);
  for (VectorXd& chain : cauchy)
    for (double& x : chain) x = std::tan(M_PI * (0.5 * std::erfc(-x / std::sqrt(2.0)) - 0.5));
  cauchy[0].array() += 3;
  const double found = student().split_r_hat(cauchy);
  expect_true(found > 1.05, "above 1.05", show(found),
              {.scene = "4 chains of 500 of a Cauchy law, one moved by 3 of its widths",
               .slip = "ranks are left out: single huge numbers drown the difference",
               .handout = equation(9)});
}

TEST(SplitRHat, OfChainsThatStandStill) {
  if (!gives_numbers(student().split_r_hat(short_chains()), "the handout's chains", 9)) return;
  const std::vector<VectorXd> apart = {VectorXd::Constant(20, 0.1), VectorXd::Constant(20, 0.3),
                                       VectorXd::Constant(20, 0.35)};
  expect_true(
      student().split_r_hat(apart) == kInfinity, "infinity", show(student().split_r_hat(apart)),
      {.scene = "one chain of twenty times 0.1, one of 0.3, one of 0.35",
       .slip = "the rounding of a mean is taken for a variance: a half of equal numbers has "
               "variance 0",
       .handout = equation(9)});
  const std::vector<VectorXd> still(3, VectorXd::Constant(20, 0.1));
  expect_unknown(student().split_r_hat(still),
                 {.scene = "three chains of twenty times 0.1",
                  .slip = "chains that never move have shown nothing, and not that they agree",
                  .handout = equation(9)});
  // 1 and -1 in turn: all numbers are as far from the median, so only the first part counts.
  VectorXd swing(20);
  for (Eigen::Index i = 0; i < 20; ++i) swing[i] = i % 2 == 0 ? 1 : -1;
  const double found = student().split_r_hat({swing, -swing});
  expect_answer(
      found, std::sqrt(0.9), kRoundoff * 10, "",
      {.scene = "two chains of 1 and -1 in turn: sqrt((N - 1)/N)",
       .slip = "a part whose numbers are all equal does not count, or NaN comes of it",
       .handout = equation(9),
       .no_number = "a part whose numbers are all equal does not count, or NaN comes of it"});
}

// ---- The answer ----

TEST(MonteCarloAnswer, OfTwoShortChains) {
  const Answer found = student().monte_carlo_answer(short_chains());
  const auto story = [](const Mistake& slip) {
    return Story{.scene = "chains 0, 1, 3, 2, 4, 3, 5, 2 and 1, 2, 2, 4, 6, 5, 3, 4",
                 .slip = slip,
                 .handout = equation(10)};
  };
  const double deviation = std::sqrt(655.0 / 240);  // 16 numbers: 179 - 47^2 / 16 over 15
  expect_answer(found.mean, 2.9375, kRoundoff * 3, "(mean)", story("the mean of all numbers"));
  expect_answer(found.deviation, deviation, kRoundoff * 5, "(deviation)",
                story(likely(found.deviation,
                             {{deviation * std::sqrt(15.0 / 16), "the divisor is S - 1"},
                              {deviation * deviation, "the variance where its root belongs"}},
                             "of all numbers about the mean of all")));
  expect_answer(found.effective_samples, 2304.0 / 455, kRoundoff * 50, "samples",
                story("effective_sample_size itself: see its tests"));
  const double exact = deviation / std::sqrt(2304.0 / 455);
  expect_answer(
      found.standard_error, exact, kRoundoff * 20, "(standard error)",
      story(likely(found.standard_error,
                   {{deviation / 4,
                     "samples that depend on each other are counted as "
                     "independent: divided by the root of S_eff"},
                    {deviation / (2304.0 / 455), "divided by S_eff where its root belongs"},
                    {deviation, "the deviation of one sample is no error of the mean"},
                    {deviation * deviation / std::sqrt(2304.0 / 455),
                     "the variance where its root belongs"}},
                   "deviation / sqrt(S_eff)")));
}

TEST(MonteCarloAnswer, IsAsWrongAsItSays) {
  // The mean of a chain whose mean is 0: within one standard error in 68 of 100 experiments. The
  // count of 150 has a deviation of 6; S_eff is itself known to 15 %. Without the correlation it is
  // below 50.
  constexpr int kExperiments = 150;
  int within = 0;
  for (int i = 0; i < kExperiments; ++i) {
    const Answer answer =
        student().monte_carlo_answer(ar1_chains(100 + static_cast<std::uint64_t>(i), 0.8, 2, 300));
    within += std::abs(answer.mean) <= answer.standard_error ? 1 : 0;
  }
  expect_answer(
      within, 0.6827 * kExperiments, 22, "of 150 experiments",
      {.scene = "2 chains of 300 steps of x' = 0.8 x + 0.6 z, whose mean is 0: how often the "
                "answer is within one standard error",
       .slip = within < 75 ? "the error is too small: samples that depend on each other "
                             "are counted as independent"
                           : "the error is too large",
       .handout = equation(10)});
}

TEST(MonteCarloAnswer, DoesNotClaimWhatItDoesNotKnow) {
  const Answer found = student().monte_carlo_answer({VectorXd::Constant(20, 0.1)});
  if (!gives_numbers(student().monte_carlo_answer(short_chains()).standard_error,
                     "the handout's chains", 10))
    return;
  const Story story{.scene = "one chain of twenty times 0.1",
                    .slip =
                        "an error of 0, or of rounding, claims too much: a chain that never "
                        "moved has shown nothing",
                    .handout = equation(10)};
  expect_answer(found.mean, 0.1, kRoundoff, "(mean)", story);
  expect_answer(found.deviation, 0, kRoundoff, "(deviation)", story);
  expect_unknown(found.effective_samples, story);
  expect_unknown(found.standard_error, story);
}

}  // namespace
}  // namespace tumble::a5_testing
