// Acceptance and one step of the chain (A5.5), (A5.6): what they must conserve.
#include "tests/a5_plausible/a5_fixtures.h"

namespace tumble::a5_testing {
namespace {

TEST(LogAcceptance, AcceptsWhatIsMoreProbable) {
  const auto a = [](double from, double to) { return student().log_acceptance(from, to, 0, 0); };
  const Mistake slip = acceptance_slip("min(0, ln pi(x') - ln pi(x))");
  expect_answer(a(-5, -3), 0, 0, "",
                {.scene = "ln pi rises from -5 to -3, as probable forth as back",
                 .slip = slip,
                 .handout = equation(5)});
  expect_answer(a(-3, -5), -2, kRoundoff * 2, "",
                {.scene = "ln pi falls from -3 to -5, as probable forth as back",
                 .slip = slip,
                 .handout = equation(5)});
}

TEST(LogAcceptance, PaysForAnAsymmetricProposal) {
  // The way forth was found with e^-1, the way back would be with e^-3.
  const Mistake slip = acceptance_slip("ln q(x | x') - ln q(x' | x) is added");
  expect_answer(student().log_acceptance(-4, -4, -1, -3), -2, kRoundoff * 3, "",
                {.scene = "ln pi is the same; ln q is -1 forth and -3 back",
                 .slip = slip,
                 .handout = equation(5)});
  expect_answer(student().log_acceptance(-4, -4.5, -3, -1), 0, 0, "",
                {.scene = "ln pi falls by 0.5; ln q is -3 forth and -1 back",
                 .slip = slip,
                 .handout = equation(5)});
  expect_answer(student().log_acceptance(-4, -7, -3, -1), -1, kRoundoff * 7, "",
                {.scene = "ln pi falls by 3; ln q is -3 forth and -1 back",
                 .slip = slip,
                 .handout = equation(5)});
}

TEST(LogAcceptance, HoldsDetailedBalanceOnFivePlaces) {
  // pi_i Q_ij a_ij == pi_j Q_ji a_ji for every pair: each flow is at most 1, and 1e-12 is far above
  // its rounding.
  const VectorXd weights = vector({1, 4, 0.25, 9, 2.5});
  Random random(5);
  Eigen::MatrixXd Q(5, 5);
  for (double& q : Q.reshaped()) q = random.between(0.05, 1);
  for (int i = 0; i < 5; ++i) Q.row(i) /= Q.row(i).sum();
  const auto flow = [&](int i, int j) {
    const double log_a = student().log_acceptance(std::log(weights[i]), std::log(weights[j]),
                                                  std::log(Q(i, j)), std::log(Q(j, i)));
    return weights[i] / weights.sum() * Q(i, j) * std::exp(log_a);
  };
  bool flows = false;
  for (int i = 0; i < 5; ++i)
    for (int j = 0; j < i; ++j) {
      const double forth = flow(i, j), back = flow(j, i);
      expect_answer(
          forth, back, 1e-12, "(probability of a step i to j, and of j to i)",
          {.scene = "five places of weights 1, 4, 0.25, 9, 2.5, and an asymmetric proposal",
           .slip = acceptance_slip("in equilibrium each pair exchanges as much forth as "
                                   "back"),
           .handout = equation(5)});
      // Either forth or back is accepted always: else the chain wastes proposals.
      const double most = std::min(weights[i] * Q(i, j), weights[j] * Q(j, i)) / weights.sum();
      expect_answer(
          forth, most, 1e-12, "(probability of the step)",
          {.scene = "five places of weights 1, 4, 0.25, 9, 2.5: the flow is the smaller of pi_i "
                    "Q_ij and pi_j Q_ji",
           .slip = acceptance_slip("balance alone is not enough: of two ways one is always "
                                   "accepted, min(0, ...)"),
           .handout = equation(5)});
      flows = flows || forth > 0;
    }
  expect_true(flows, "a step that is accepted", "none",
              {.scene = "five places of weights 1, 4, 0.25, 9, 2.5, and an asymmetric proposal",
               .slip = "nothing is ever accepted: such a chain is balanced, and stands still",
               .handout = equation(5)});
}

TEST(LogAcceptance, KnowsImpossiblePlaces) {
  if (!gives_numbers(student().log_acceptance(0, -1, 0, 0), "ln pi falls from 0 to -1", 5)) return;
  const auto a = [](double from, double to, double forth, double back) {
    return student().log_acceptance(from, to, forth, back);
  };
  const auto story = [](const std::string& scene, const std::string& slip) {
    return Story{.scene = scene, .slip = slip, .handout = equation(5)};
  };
  expect_impossible(a(-1, -kInfinity, 0, 0),
                    story("the proposal is impossible", "pi(x') = 0 is never accepted"));
  expect_impossible(a(-1, kUnset, 0, 0),
                    story("ln pi of the proposal is NaN: its run broke",
                          "NaN is not noticed: min(0, NaN) may be 0, which accepts"));
  expect_impossible(a(-1, -1, 0, -kInfinity),
                    story("no way leads back", "ln q(x | x') = -infinity is never accepted"));
  expect_answer(a(-kInfinity, -900, -2, -1), 0, 0, "",
                story("the chain began at an impossible place, and the proposal is possible",
                      "a chain that stands where pi is 0 leaves it: ln a = 0"));
  expect_impossible(
      a(-kInfinity, -kInfinity, 0, 0),
      story("from one impossible place to another",
            "-infinity minus -infinity is NaN: the impossible proposal is asked for first"));
  expect_impossible(
      a(-kInfinity, -1, 0, -kInfinity),
      story("from an impossible place, where no way leads back",
            "the order of the rules is wrong: where no way leads back nothing is accepted"));
}

TEST(LogAcceptance, DoesNotSeeAConstantInTheDensity) {
  // 1000 is added to ln pi of both, or taken off: exp of it overflows or is 0.
  for (const double constant : {-4000.0, 0.0, 4000.0}) {
    const double found = student().log_acceptance(constant - 3, constant - 5, -1, -0.5);
    expect_answer(
        found, -1.5, kRoundoff * 4000, "",
        {.scene = "ln pi falls by 2, ln q rises by 0.5; " + show(constant) +
                  " is added to ln pi of both",
         .slip = std::isnan(found) || std::isinf(found) || found == 0
                     ? "powers overflow or vanish: take the difference of logarithms, not "
                       "the logarithm of a ratio"
                     : acceptance_slip("a constant in ln pi cancels"),
         .handout = equation(5)});
  }
}

// ---- One step ----

// ln pi = -x: an exponential density on x > 0.
double exponential(const VectorXd& x) { return x.size() == 1 && x[0] > 0 ? -x[0] : -kInfinity; }
ChainState at(double x, double log_target, bool accepted = false) {
  return {vector({x}), log_target, accepted};
}
double place(const ChainState& state) { return state.x.size() == 1 ? state.x[0] : kUnset; }

TEST(MetropolisStep, AsksForOneDensity) {
  Calls calls;
  const Proposal proposal{{add(0.5)}, 0.0, 1.0};
  student().metropolis_step(noting(calls, exponential), proposal, at(2, -2),
                            draws_with(vector({2})));
  expect_answer(static_cast<double>(calls.places.size()), 1, 0, "calls of ln pi",
                {.scene = "one step from x = 2, whose ln pi is known",
                 .slip = calls.places.size() > 1
                             ? "ln pi is computed again where it is known: keep it, each call is a "
                               "whole simulation"
                             : "ln pi of the proposal is not asked for",
                 .handout = equation(6)});
  if (calls.places.empty()) return;
  const VectorXd& x = calls.places.front();
  expect_answer(x.size() == 1 ? x[0] : kUnset, 3, kRoundoff * 3, "",
                {.scene = "one step from x = 2, 0.5 z added, z = 2: where ln pi is asked for",
                 .slip = "ln pi is asked for where the chain is: it is known there",
                 .handout = equation(6)});
}

TEST(MetropolisStep, MovesOrStays) {
  // From 2 to 3: a = exp(-1) = 0.3679.
  const Proposal proposal{{add(0.5)}, 0.0, 1.0};
  const auto step = [&](double uniform, bool accepted_before) {
    return student().metropolis_step(exponential, proposal, at(2, -2, accepted_before),
                                     draws_with(vector({2}), 0.9, uniform));
  };
  const ChainState moved = step(0.36, false), stayed = step(0.37, true);
  const auto story = [](const std::string& uniform, const std::string& slip) {
    return Story{.scene = "ln pi = -x, from x = 2 to 3, so a = 0.3679; u = " + uniform,
                 .slip = slip,
                 .handout = equation(6)};
  };
  const bool turned_round = place(moved) == 2 && place(stayed) == 3;
  const std::string round = "accepted and rejected are exchanged: accepted where u < a";
  expect_answer(place(moved), 3, kRoundoff * 3, "",
                story("0.36", turned_round ? round
                                           : "accepted where u < a, that is ln u < ln a: see "
                                             "log_acceptance and log_proposal first"));
  expect_answer(moved.log_target, -3, kRoundoff * 3, "",
                story("0.36", "ln pi of the old place is kept: the next step compares with it"));
  expect_true(moved.accepted, "accepted", "not accepted",
              story("0.36", "whether the proposal was accepted"));
  expect_answer(
      place(stayed), 2, 0, "",
      story("0.37", turned_round ? round
                                 : "a rejected proposal leaves the chain where it is, once "
                                   "more"));
  expect_answer(stayed.log_target, -2, 0, "",
                story("0.37", "ln pi of the rejected proposal is kept"));
  expect_true(!stayed.accepted, "not accepted", "accepted",
              story("0.37", "whether this proposal was accepted, and not the one before it"));
}

TEST(MetropolisStep, NeverEntersAnImpossiblePlace) {
  const Proposal proposal{{add(1)}, 0.0, 1.0};
  const ChainState moved = student().metropolis_step(exponential, proposal, at(2, -2),
                                                     draws_with(vector({-0.5}), 0.9, 0.0));
  if (!gives_numbers(moved.log_target, "a step from x = 2 to 1.5", 6)) return;
  expect_answer(place(moved), 1.5, 0, "",
                {.scene = "ln pi = -x, from x = 2 to 1.5, which is more probable; u = 0",
                 .slip = "what is more probable is accepted",
                 .handout = equation(6)});
  const ChainState found = student().metropolis_step(exponential, proposal, at(2, -2),
                                                     draws_with(vector({-3}), 0.9, 0.0));
  expect_answer(place(found), 2, 0, "",
                {.scene = "ln pi = -x for x > 0, from x = 2 to -1, where pi is 0; u = 0",
                 .slip = "u <= a accepts a = 0 where u = 0: accepted where u < a",
                 .handout = equation(6)});
}

TEST(MetropolisStep, PaysForAnAsymmetricProposal) {
  // From 1 to e by multiplication: a = pi(e) / pi(1) * q(1 | e) / q(e | 1) = exp(1 - e) * e.
  const Proposal proposal{{multiply(0.5)}, 0.0, 1.0};
  const double a = std::exp(1 - M_E) * M_E;
  const auto step = [&](double uniform) {
    return place(student().metropolis_step(exponential, proposal, at(1, -1),
                                           draws_with(vector({2}), 0.9, uniform)));
  };
  const Story story{.scene = "ln pi = -x, from 1 to e by multiplication: a = " + show_scale(a) +
                             "; u a little below a, then a little above",
                    .slip =
                        "Hastings' correction is not used, or is the wrong way round: of a "
                        "multiplied number it is x' / x",
                    .handout = equation(6)};
  expect_answer(step(a - 1e-6), M_E, kRoundoff * 3, "", story);
  expect_answer(step(a + 1e-6), 1, 0, "", story);
}

TEST(MetropolisStep, KeepsItsDistribution) {
  // 400 chains begin with exact draws of ln pi = -x. After 3 steps they are still exact draws,
  // independent of each other: counts in 10 equally probable cells have a chi-square of 9 degrees
  // of freedom, which exceeds 33.7 once in 10,000 seeds. Without Hastings' correction it is far
  // above.
  constexpr int kChains = 400, kCells = 10, kSteps = 3;
  const Proposal proposal{{multiply(0.8)}, 0.2, 3.0};
  Random random(11);
  std::vector<int> counts(kCells, 0);
  int accepted = 0;
  for (int i = 0; i < kChains; ++i) {
    const double start = -std::log1p(-random.unit()) + 1e-12;
    ChainState state = at(start, -start);
    for (int k = 0; k < kSteps; ++k) {
      state = student().metropolis_step(exponential, proposal, state, draws_of(random, 1));
      accepted += state.accepted ? 1 : 0;
      if (!(place(state) > 0)) break;
    }
    const double below = 1 - std::exp(-place(state));  // uniform in [0, 1]
    if (below >= 0 && below <= 1)
      ++counts[static_cast<std::size_t>(std::min(kCells - 1.0, std::floor(below * kCells)))];
  }
  // A chain that stands still keeps every distribution.
  expect_true(accepted > kChains, "more than one of four proposals accepted",
              std::to_string(accepted) + " of " + std::to_string(kChains * kSteps),
              {.scene = "ln pi = -x, numbers multiplied",
               .slip = "proposals are not accepted",
               .handout = equation(6)});
  const double found = chi_square(counts, std::vector<double>(kCells, kChains / double{kCells}));
  expect_true(
      found < 33.7, "chi-square below 33.7 (9 degrees of freedom)", show(found),
      {.scene = "400 chains that begin with exact draws of an exponential density",
       .steps = "3 steps each, numbers multiplied by exp(0.8 z), wide steps with share 0.2",
       .slip = acceptance_slip("a step must not change the distribution that it samples: Hastings' "
                               "correction, or ln pi of a place where the chain is not"),
       .handout = equation(6)});
}

TEST(Plausible, KeepsNothingBetweenCalls) {
  const auto story = [](const std::string& function, int n) {
    return Story{.scene = "two calls of " + function + ", each with other numbers",
                 .slip = function + " itself: see its own tests",
                 .handout = equation(n)};
  };
  const auto q = [](double s, double to) {
    return vector({student().log_proposal({{add(s)}, 0.0, 1.0}, vector({0}), vector({to}))});
  };
  const auto exact = [](double s, double to) {
    return vector({-0.5 * to * to / (s * s) - std::log(s) - 0.5 * std::log(2 * M_PI)});
  };
  expect_kept_nothing(q(1, 2), exact(1, 2), q(4, 1), exact(4, 1), kRoundoff * 8, "",
                      story("log_proposal", 4));
  const auto step = [](double x, double z) {
    const ChainState state = student().metropolis_step(exponential, {{add(1)}, 0.0, 1.0}, at(x, -x),
                                                       draws_with(vector({z}), 0.9, 0.0));
    return vector({place(state), state.log_target});
  };
  expect_kept_nothing(step(2, 1), vector({3, -3}), step(5, -1), vector({4, -4}), kRoundoff * 8, "",
                      story("metropolis_step", 6));
}

}  // namespace
}  // namespace tumble::a5_testing
