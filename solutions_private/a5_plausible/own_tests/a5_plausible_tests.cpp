// A student's own tests, as good as they need to be. tests/grading/own_tests_of_all.sh hands them
// in.
#include "tests/a5_plausible/a5_fixtures.h"

namespace tumble::a5_testing {

double difference(const std::vector<Prior>& priors, const VectorXd& a, const VectorXd& b) {
  return student().log_prior(priors, a) - student().log_prior(priors, b);
}

TEST(MyPrior, OfOneNormalNumber) {
  EXPECT_NEAR(difference({normal(1, 3)}, vector({7}), vector({1})), -2, 1e-12);
}
TEST(MyPrior, OfTwoNumbers) {
  EXPECT_NEAR(difference({normal(0, 1), normal(0, 2)}, vector({1, 2}), vector({0, 0})), -1, 1e-12);
  EXPECT_NEAR(difference({normal(0, 1), normal(0, 2)}, vector({3, 2}), vector({0, 2})), -4.5,
              1e-12);
}
TEST(MyPrior, ANormalNumberHasBounds) {
  Prior cut = normal(0, 1);
  cut.low = -1, cut.high = 2;
  EXPECT_EQ(student().log_prior({cut}, vector({2.5})), -kInfinity);
  EXPECT_EQ(student().log_prior({cut}, vector({-1.5})), -kInfinity);
  EXPECT_TRUE(std::isfinite(student().log_prior({cut}, vector({0.5}))));
}
TEST(MyTarget, SoftAndHard) {
  EXPECT_NEAR(student().log_target(-3, 0.2, 0.1), -5, 1e-12);
  EXPECT_NEAR(student().log_target(-3, 0.3, 0.1), -7.5, 1e-12);
  EXPECT_EQ(student().log_target(-3, 0.2, 0), -kInfinity);
  EXPECT_EQ(student().log_target(-3, 0, 0), -3);
}

Proposal two(MoveKind kind) { return {{{kind, 0.5}, {kind, 0.25}}, 0.25, 4.0}; }

TEST(MyProposal, AddsAndMultiplies) {
  const VectorXd x = vector({2, -4});
  const VectorXd add = student().propose(two(MoveKind::kAdd), x, {0.9, vector({1, -2}), 0.5});
  EXPECT_NEAR(add[0], 2.5, 1e-12);
  EXPECT_NEAR(add[1], -4.5, 1e-12);
  const VectorXd wide = student().propose(two(MoveKind::kAdd), x, {0.1, vector({1, -2}), 0.5});
  EXPECT_NEAR(wide[0], 4, 1e-12);
  EXPECT_NEAR(wide[1], -6, 1e-12);
  const VectorXd times =
      student().propose(two(MoveKind::kMultiply), x, {0.9, vector({1, -2}), 0.5});
  EXPECT_NEAR(times[0], 2 * std::exp(0.5), 1e-12);
  EXPECT_NEAR(times[1], -4 * std::exp(-0.5), 1e-12);
}
double g(double z) { return std::exp(-z * z / 2) / std::sqrt(2 * M_PI); }
TEST(MyProposal, ItsDensity) {
  const Proposal one{{{MoveKind::kAdd, 0.5}}, 0.25, 4.0};
  EXPECT_NEAR(student().log_proposal(one, vector({1}), vector({2})),
              std::log(0.75 * g(2) / 0.5 + 0.25 * g(0.5) / 2), 1e-12);
  const Proposal times{{{MoveKind::kMultiply, 0.5}}, 0, 1.0};
  EXPECT_NEAR(student().log_proposal(times, vector({1}), vector({3})),
              std::log(g(std::log(3.0) / 0.5) / 0.5 / 3), 1e-12);
}
TEST(MyAcceptance, Hastings) {
  EXPECT_NEAR(student().log_acceptance(-1, -3, -2, -2), -2, 1e-12);
  EXPECT_NEAR(student().log_acceptance(-1, -3, -4, -3), -1, 1e-12);
  EXPECT_NEAR(student().log_acceptance(-1, -1, -2, -3), -1, 1e-12);
  EXPECT_EQ(student().log_acceptance(-3, -1, -2, -2), 0);
}
TEST(MyStep, AcceptsOrStays) {
  const LogDensity target = [](const VectorXd& x) { return -x[0]; };
  const Proposal one{{{MoveKind::kAdd, 1.0}}, 0, 1.0};
  const ChainState at{vector({0}), 0, false};
  const ChainState moved = student().metropolis_step(target, one, at, {0.5, vector({1}), 0.1});
  EXPECT_TRUE(moved.accepted);
  EXPECT_NEAR(moved.x[0], 1, 1e-12);
  EXPECT_NEAR(moved.log_target, -1, 1e-12);
  const ChainState stayed = student().metropolis_step(target, one, at, {0.5, vector({1}), 0.9});
  EXPECT_FALSE(stayed.accepted);
  EXPECT_NEAR(stayed.x[0], 0, 1e-12);
  EXPECT_NEAR(stayed.log_target, 0, 1e-12);
}
TEST(MyTrust, Autocorrelation) {
  const VectorXd rho = student().autocorrelation(vector({1, 2, 4, 5}), 1);
  // deviations -2, -1, 1, 2: c_0 = 10/4, c_1 = (2 - 1 + 2)/4
  EXPECT_NEAR(rho[0], 1, 1e-12);
  EXPECT_NEAR(rho[1], 0.3, 1e-12);
}
TEST(MyTrust, ErrorOfTheMean) {
  const Answer answer =
      student().monte_carlo_answer({vector({1, 3, 2, 5, 4, 1}), vector({2, 2, 4, 1, 3, 5})});
  EXPECT_NEAR(answer.standard_error, answer.deviation / std::sqrt(answer.effective_samples), 1e-12);
}
TEST(MyTrust, RHatOfChainsThatDisagree) {
  EXPECT_GT(student().split_r_hat(
                {vector({1, 2, 1.5, 2.5, 1.2, 2.2}), vector({11, 12, 11.5, 12.5, 11.2, 12.2})}),
            1.5);
}

}  // namespace tumble::a5_testing
