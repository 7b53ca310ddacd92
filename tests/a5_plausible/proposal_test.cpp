// Where the chain goes next: the proposal and its density (A5.3), (A5.4).
#include "tests/a5_plausible/a5_fixtures.h"

namespace tumble::a5_testing {
namespace {

const double kLogRootTwoPi = 0.5 * std::log(2 * M_PI);

Proposal one(const Move& move) { return {{move}, 0.0, 1.0}; }
/// ln of the normal density of a step of so many sizes.
double log_normal(double z, double size) { return -0.5 * z * z - std::log(size) - kLogRootTwoPi; }

TEST(Propose, AddsAndMultiplies) {
  const Proposal proposal{{add(0.5), multiply(0.1)}, 0.0, 1.0};
  const VectorXd found = student().propose(proposal, vector({3, -2}), draws_with(vector({2, -3})));
  const double second = found.size() == 2 ? found[1] : kUnset,
               first = found.size() == 2 ? found[0] : kUnset;
  expect_answer(
      found, vector({4, -2 * std::exp(-0.3)}), kRoundoff * 4, "",
      {.scene = "x = (3, -2), 0.5 z added to the first, the second multiplied by exp(0.1 z), z = "
                "(2, -3)",
       .slip = first == 3.5   ? "the normal number is forgotten: s_i z_i is added"
               : first == 5   ? "the size is forgotten: s_i z_i is added"
               : first == 1   ? "the new number does not begin at the old one"
               : first == 2   ? "the sign of the step is wrong"
               : first == 1.5 ? "one normal number is used for all, or the wrong one"
                              : likely(second,
                                       {{-2.3, "added where it is to be multiplied: kMultiply"},
                                        {-1.7, "added where it is to be multiplied: kMultiply"},
                                        {-1.4, "x (1 + s z) is not x exp(s z): it may change sign"},
                                        {-2 * std::exp(0.3), "the sign of the exponent is wrong"},
                                        {-2 * std::exp(0.2), "one normal number is used for all"}},
                                       "x_i + s_i z_i, or x_i exp(s_i z_i)"),
       .handout = equation(3)});
}

TEST(Propose, TakesWideStepsWithTheirShare) {
  const Proposal proposal{{add(0.5), multiply(0.1)}, 0.25, 10.0};
  const auto step_of = [&](double choice, Eigen::Index number) {
    const VectorXd x =
        student().propose(proposal, vector({1, 1}), draws_with(vector({2, 2}), choice));
    return x.size() == 2 ? x[number] : kUnset;
  };
  const auto step = [&](double choice) { return step_of(choice, 0); };
  const auto story = [](const std::string& choice, const Mistake& slip) {
    return Story{.scene =
                     "x = 1, size 0.5, z = 2; wide steps of 10 times the size have the share "
                     "0.25; choice = " +
                     choice,
                 .slip = slip,
                 .handout = equation(3)};
  };
  const double wide = step(0.1), usual = step(0.9);
  expect_answer(wide, 11, kRoundoff * 11, "",
                story("0.1", likely(wide,
                                    {{2, usual > 3 ? "the two proposals are exchanged: wide where "
                                                     "choice < wide_share"
                                                   : "wide steps are never taken"},
                                     {6, "the factor replaces the size: it multiplies it"},
                                     {21, "the factor replaces the size: it multiplies it"}},
                                    "a wide step has sizes wide_factor times as large")));
  expect_answer(usual, 2, kRoundoff * 2, "",
                story("0.9", "a usual step where choice >= wide_share"));
  expect_answer(step(0.25), 2, kRoundoff * 2, "",
                story("0.25", "wide where choice < wide_share, so that a share of 0 means never"));
  const double wide_factor = step_of(0.1, 1);
  expect_answer(
      wide_factor, std::exp(2.0), kRoundoff * 20, "(the second number)",
      story("0.1; a second number, x = 1, is multiplied, size 0.1",
            likely(wide_factor,
                   {{std::exp(0.2), "wide steps are for numbers that are multiplied, too"},
                    {10 * std::exp(0.2), "the factor stands in the exponent, exp(f s z)"}},
                   "x exp(f s z)")));
}

TEST(Propose, LeavesNumbersOfSize0) {
  const Proposal proposal{{add(0), multiply(0), add(1)}, 0.5, 100.0};
  const VectorXd x = vector({0.1, -7, 2});
  const VectorXd found = student().propose(proposal, x, draws_with(vector({3, 3, 3}), 0.1));
  expect_answer(found, vector({0.1, -7, 302}), kRoundoff * 302, "",
                {.scene = "x = (0.1, -7, 2), sizes (0, 0, 1), a wide step of 100 times the size",
                 .slip = "a number of size 0 stays, to the bit",
                 .handout = equation(3)});
  const VectorXd again = student().propose(proposal, x, draws_with(vector({3, 3, 3}), 0.1, 0.77));
  expect_answer(again, found, 0, "",
                {.scene = "x = (0.1, -7, 2), sizes (0, 0, 1), once more with another `uniform`",
                 .slip = "`uniform` belongs to the acceptance: the proposal does not look at it",
                 .handout = equation(3)});
}

TEST(LogProposal, IsTheDensityOfTheStep) {
  // z = (4 - 3) / 0.5 = 2.
  const double found = student().log_proposal(one(add(0.5)), vector({3}), vector({4}));
  const double exact = log_normal(2, 0.5);
  expect_answer(
      found, exact, kRoundoff * 4, "",
      {.scene = "from 3 to 4, 0.5 z added",
       .slip = likely(
           found,
           {{-2,
             "what normalises the density is forgotten: two proposals of "
             "different size are mixed"},
            {-2 - kLogRootTwoPi, "the size is forgotten in what normalises: ln q has - ln s"},
            {-2 - std::log(0.5), "ln sqrt(2 pi) is forgotten"},
            {-4 - std::log(0.5) - kLogRootTwoPi, "the factor 1/2 is forgotten"},
            {-2 + std::log(0.5) - kLogRootTwoPi, "the sign of ln s is wrong"},
            {std::exp(exact), "the density itself is returned where its logarithm belongs"}},
           "-1/2 z^2 - ln s - ln sqrt(2 pi)"),
       .handout = equation(4)});
  expect_answer(student().log_proposal(one(add(0.5)), vector({4}), vector({3})), exact,
                kRoundoff * 4, "",
                {.scene = "from 4 to 3, 0.5 z added",
                 .slip = "an added step is as probable back as forth",
                 .handout = equation(4)});
}

TEST(LogProposal, OfAMultipliedNumberHasAJacobian) {
  const double z = std::log(1.5) / 0.3;
  const double found = student().log_proposal(one(multiply(0.3)), vector({-2}), vector({-3}));
  const double logarithmic = log_normal(z, 0.3);
  expect_answer(
      found, logarithmic - std::log(3.0), kRoundoff * 4, "",
      {.scene = "from -2 to -3, multiplied by exp(0.3 z)",
       .slip = likely(found,
                      {{logarithmic,
                        "the Jacobian is forgotten: this is the density of ln |to|, that of `to` "
                        "has 1/|to|"},
                       {logarithmic - std::log(2.0), "1/|from| where 1/|to| belongs"},
                       {logarithmic + std::log(3.0), "|to| where 1/|to| belongs"},
                       {log_normal(-1 / 0.3, 0.3) - std::log(3.0),
                        "the difference where the logarithm of the "
                        "ratio belongs"}},
                      "-1/2 z^2 - ln s - ln sqrt(2 pi) - ln |to| with z = ln(to / from) / s; signs "
                      "cancel in the ratio"),
       .handout = equation(4)});
}

TEST(LogProposal, MultipliesOverTheNumbers) {
  const Proposal proposal{{add(1), add(2), multiply(0.5)}, 0.0, 1.0};
  const double found =
      student().log_proposal(proposal, vector({0, 0, 1}), vector({1, -4, std::exp(1.0)}));
  const double exact = log_normal(1, 1) + log_normal(2, 2) + log_normal(2, 0.5) - 1;
  expect_answer(
      found, exact, kRoundoff * 20, "",
      {.scene = "three numbers: two added to, one multiplied",
       .slip = "the density of a step of all numbers is the product: its logarithm the sum "
               "over all",
       .handout = equation(4)});
}

TEST(LogProposal, MixesTheTwoProposals) {
  const Proposal proposal{{add(1)}, 0.25, 10.0};
  const double usual = log_normal(4, 1), wide = log_normal(0.4, 10);
  const double exact = std::log(0.75 * std::exp(usual) + 0.25 * std::exp(wide));
  const double found = student().log_proposal(proposal, vector({1}), vector({5}));
  expect_answer(
      found, exact, kRoundoff * 10, "",
      {.scene = "from 1 to 5, size 1, and 10 with the share 0.25",
       .slip = likely(found,
                      {{usual, "only the usual proposal counts: both can have led there"},
                       {wide, "only the wide proposal counts: both can have led there"},
                       {std::log(0.75) + usual, "only the usual proposal counts"},
                       {std::log(0.25) + wide, "only the wide proposal counts"},
                       {0.75 * usual + 0.25 * wide,
                        "the logarithms are mixed, not the densities: ln((1 - w) q_1 + w q_f)"},
                       {std::log(0.25 * std::exp(usual) + 0.75 * std::exp(wide)),
                        "the two shares are exchanged"},
                       {std::log(std::exp(usual) + std::exp(wide)), "the shares are forgotten"},
                       {std::log(0.75 * std::exp(usual) +
                                 0.25 * std::exp(log_normal(0.4, 10) + std::log(10.0))),
                        "the wide proposal is normalised with the usual size"}},
                      "ln((1 - w) q_1 + w q_f)"),
       .handout = equation(4)});
  // Of a number that is multiplied.
  const double z = std::log(5.0);
  const double of_both =
      std::log(0.75 * std::exp(log_normal(z, 1)) + 0.25 * std::exp(log_normal(z / 10, 10))) - z;
  const double multiplied =
      student().log_proposal({{multiply(1)}, 0.25, 10.0}, vector({1}), vector({5}));
  expect_answer(
      multiplied, of_both, kRoundoff * 10, "",
      {.scene = "from 1 to 5 by multiplication, size 1, and 10 with the share 0.25",
       .slip =
           likely(multiplied,
                  {{log_normal(z, 1) - z, "wide steps are for numbers that are multiplied, too"}},
                  "the same mixture, with z = ln(to / from) / (f s) and the Jacobian"),
       .handout = equation(4)});
  // Only one of the two.
  expect_answer(student().log_proposal({{add(1)}, 0.0, 10.0}, vector({1}), vector({5})), usual,
                kRoundoff * 10, "",
                {.scene = "from 1 to 5 by addition, size 1, and 10 with share 0",
                 .slip = "ln 0 = -infinity must not become NaN",
                 .handout = equation(4)});
  expect_answer(student().log_proposal({{add(1)}, 1.0, 10.0}, vector({1}), vector({5})), wide,
                kRoundoff * 10, "",
                {.scene = "from 1 to 5 by addition, size 1, and 10 with share 1",
                 .slip = "ln 0 = -infinity must not become NaN",
                 .handout = equation(4)});
}

TEST(LogProposal, DoesNotUnderflow) {
  const Proposal proposal{std::vector<Move>(100, add(1)), 0.25, 10.0};
  const VectorXd from = VectorXd::Zero(100), to = VectorXd::Constant(100, 100);
  const double found = student().log_proposal(proposal, from, to);
  // The usual proposal's share is exp(-495000) of it.
  const double exact = std::log(0.25) + 100 * log_normal(10, 10);
  expect_answer(found, exact, kRoundoff * 100 * 60, "",
                {.scene = "100 numbers, each 100 sizes away, 10 wide ones",
                 .slip = std::isfinite(found)
                             ? "ln((1 - w) q_1 + w q_f)"
                             : "a density below 1e-308 is 0: take out the larger exponent first, "
                               "ln(e^a + e^b) = a + ln(1 + e^(b - a)) with a >= b",
                 .handout = equation(4)});
}

TEST(LogProposal, KnowsWhereItCannotLead) {
  const Proposal proposal{{add(0), multiply(0.5), add(1)}, 0.25, 10.0};
  const double possible = student().log_proposal(proposal, vector({1, 2, 3}), vector({1, 2, 4}));
  if (!gives_numbers(possible, "a number of size 0 that has not changed", 4)) return;
  const Proposal two{{multiply(0.5), add(1)}, 0.25, 10.0};
  expect_answer(possible, student().log_proposal(two, vector({2, 3}), vector({2, 4})),
                kRoundoff * 10, "",
                {.scene = "a number of size 0 that has not changed, beside two others",
                 .slip = "a number that stays contributes the factor 1",
                 .handout = equation(4)});
  expect_impossible(student().log_proposal(proposal, vector({1, 2, 3}), vector({1.5, 2, 4})),
                    {.scene = "a number of size 0 has changed",
                     .slip = "no step of size 0 leads elsewhere",
                     .handout = equation(4)});
  expect_impossible(student().log_proposal(proposal, vector({1, 2, 3}), vector({1, -2, 4})),
                    {.scene = "a number that is multiplied has changed its sign",
                     .slip = "exp(s z) is positive: the ratio to / from must be",
                     .handout = equation(4)});
  expect_impossible(student().log_proposal(proposal, vector({1, 2, 3}), vector({1, 0, 4})),
                    {.scene = "a number that is multiplied has become 0",
                     .slip = "exp(s z) is positive: the ratio to / from must be",
                     .handout = equation(4)});
}

}  // namespace
}  // namespace tumble::a5_testing
