// The reference solution of assignment 5. Equations (A5.n) stand in a5_plausible.h and in the
// handout.
#include "assignments/a5_plausible/a5_plausible.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tumble::a5 {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
const double kLogRootTwoPi = 0.5 * std::log(2.0 * M_PI);

/// ln(e^a + e^b), of which no power overflows.
double log_sum(double a, double b) {
  const double larger = std::max(a, b), smaller = std::min(a, b);
  return larger == -kInfinity ? -kInfinity : larger + std::log1p(std::exp(smaller - larger));
}

bool have_one_sign(double a, double b) { return (a > 0.0 && b > 0.0) || (a < 0.0 && b < 0.0); }

/// ln(to / from) of numbers of one sign, of which no quotient overflows.
double log_ratio(double to, double from) {
  return std::log(std::abs(to)) - std::log(std::abs(from));
}

/// (A5.4), one of the two proposals: sizes `factor` times as large.
double log_step(const Proposal& proposal, double factor, const VectorXd& from, const VectorXd& to) {
  double log_density = 0.0;
  for (Eigen::Index i = 0; i < from.size(); ++i) {
    const Move& move = proposal.moves[static_cast<std::size_t>(i)];
    const double size = factor * move.size;
    if (size == 0.0) {
      if (to[i] != from[i]) return -kInfinity;
      continue;
    }
    const bool multiplies = move.kind == MoveKind::kMultiply;
    if (multiplies && !have_one_sign(to[i], from[i])) return -kInfinity;
    const double z = (multiplies ? log_ratio(to[i], from[i]) : to[i] - from[i]) / size;
    log_density -= 0.5 * z * z + std::log(size) + kLogRootTwoPi;
    if (multiplies) log_density -= std::log(std::abs(to[i]));
  }
  return log_density;
}

/// The halves of chains (A5.8): each of `length` numbers, the middle one of an odd number left out.
std::vector<VectorXd> halves_of(const std::vector<VectorXd>& chains) {
  std::vector<VectorXd> halves;
  for (const VectorXd& chain : chains) {
    const Eigen::Index length = chain.size() / 2;
    halves.push_back(chain.head(length));
    halves.push_back(chain.tail(length));
  }
  return halves;
}

bool never_moves(const VectorXd& chain) { return chain.minCoeff() == chain.maxCoeff(); }

/// Mean, and the sum of squares about it divided by n - 1; exactly 0 where all numbers are equal.
struct Moments {
  double mean, variance;
};
Moments moments_of(const VectorXd& numbers) {
  if (never_moves(numbers)) return {numbers[0], 0.0};
  const double mean = numbers.mean();
  return {mean, (numbers.array() - mean).square().sum() / static_cast<double>(numbers.size() - 1)};
}

/// c_t of (A5.7) for t = 0 to most_lag.
VectorXd autocovariance(const VectorXd& chain, Eigen::Index most_lag) {
  VectorXd covariance = VectorXd::Zero(most_lag + 1);
  if (never_moves(chain)) return covariance;
  const VectorXd centred = chain.array() - chain.mean();
  for (Eigen::Index t = 0; t <= most_lag; ++t)
    covariance[t] = centred.head(chain.size() - t).dot(centred.tail(chain.size() - t)) /
                    static_cast<double>(chain.size());
  return covariance;
}

/// W and var_plus of (A5.8): within the halves, and of all of them.
struct Variances {
  double within, all;
};
Variances variances_of(const std::vector<VectorXd>& halves) {
  VectorXd means(static_cast<Eigen::Index>(halves.size())), variances(means.size());
  for (Eigen::Index m = 0; m < means.size(); ++m) {
    const Moments moments = moments_of(halves[static_cast<std::size_t>(m)]);
    means[m] = moments.mean;
    variances[m] = moments.variance;
  }
  const double length = static_cast<double>(halves[0].size()), within = variances.mean();
  return {within, (length - 1.0) / length * within + moments_of(means).variance};
}

VectorXd all_of(const std::vector<VectorXd>& chains) {
  VectorXd all(static_cast<Eigen::Index>(chains.size()) * chains[0].size());
  Eigen::Index at = 0;
  for (const VectorXd& chain : chains) {
    all.segment(at, chain.size()) = chain;
    at += chain.size();
  }
  return all;
}

/// Each number replaced by the normal quantile of its rank among all (A5.9).
std::vector<VectorXd> rank_normalized(const std::vector<VectorXd>& chains) {
  const VectorXd all = all_of(chains);
  std::vector<double> sorted(all.data(), all.data() + all.size());
  std::sort(sorted.begin(), sorted.end());
  std::vector<VectorXd> scores = chains;
  for (VectorXd& chain : scores)
    for (double& x : chain) {
      const auto [first, last] = std::equal_range(sorted.begin(), sorted.end(), x);
      // Equal numbers share the mean of their ranks, which count from 1.
      const double rank =
          0.5 * static_cast<double>((first - sorted.begin()) + 1 + (last - sorted.begin()));
      x = normal_quantile((rank - 0.375) / (static_cast<double>(sorted.size()) + 0.25));
    }
  return scores;
}

double median_of(const std::vector<VectorXd>& chains) {
  const VectorXd all = all_of(chains);
  std::vector<double> sorted(all.data(), all.data() + all.size());
  std::sort(sorted.begin(), sorted.end());
  const std::size_t middle = sorted.size() / 2;  // the number of draws of halves is even
  return 0.5 * (sorted[middle - 1] + sorted[middle]);
}

/// sqrt(var_plus / W) of rank-normalized halves; NaN where all their numbers are equal.
double ratio_of(const std::vector<VectorXd>& halves) {
  const Variances variances = variances_of(rank_normalized(halves));
  return std::sqrt(variances.all / variances.within);
}

}  // namespace

double log_prior(const std::vector<Prior>& priors, const VectorXd& x) {
  double log_density = 0.0;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const Prior& prior = priors[static_cast<std::size_t>(i)];
    if (!(x[i] >= prior.low && x[i] <= prior.high)) return -kInfinity;
    if (prior.kind == PriorKind::kUniform) continue;
    const double z = (x[i] - prior.mean) / prior.deviation;
    log_density -= 0.5 * z * z;
  }
  return log_density;
}

double log_target(double log_prior, double violation, double softness) {
  if (std::isnan(violation)) return -kInfinity;
  if (violation == 0.0) return log_prior;
  if (softness == 0.0) return -kInfinity;
  const double z = violation / softness;
  return log_prior - 0.5 * z * z;
}

VectorXd propose(const Proposal& proposal, const VectorXd& x, const Draws& draws) {
  const double factor = draws.choice < proposal.wide_share ? proposal.wide_factor : 1.0;
  VectorXd next = x;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const Move& move = proposal.moves[static_cast<std::size_t>(i)];
    const double change = factor * move.size * draws.normals[i];
    if (move.kind == MoveKind::kMultiply)
      next[i] *= std::exp(change);
    else
      next[i] += change;
  }
  return next;
}

double log_proposal(const Proposal& proposal, const VectorXd& from, const VectorXd& to) {
  const double w = proposal.wide_share;
  return log_sum(std::log1p(-w) + log_step(proposal, 1.0, from, to),
                 std::log(w) + log_step(proposal, proposal.wide_factor, from, to));
}

double log_acceptance(double log_target_from, double log_target_to, double log_forth,
                      double log_back) {
  const bool possible = log_target_to > -kInfinity && log_back > -kInfinity;  // false for NaN
  if (!possible) return -kInfinity;
  if (log_target_from == -kInfinity) return 0.0;
  return std::min(0.0, (log_target_to - log_target_from) + (log_back - log_forth));
}

ChainState metropolis_step(const LogDensity& log_target, const Proposal& proposal,
                           const ChainState& state, const Draws& draws) {
  const VectorXd next = propose(proposal, state.x, draws);
  const double log_next = log_target(next);
  const double log_a =
      log_acceptance(state.log_target, log_next, log_proposal(proposal, state.x, next),
                     log_proposal(proposal, next, state.x));
  if (std::log(draws.uniform) < log_a) return {next, log_next, true};
  return {state.x, state.log_target, false};
}

VectorXd autocorrelation(const VectorXd& chain, int most_lag) {
  const VectorXd covariance = autocovariance(chain, most_lag);
  return covariance / covariance[0];  // 0/0 where the chain never moves
}

double effective_sample_size(const std::vector<VectorXd>& chains) {
  const std::vector<VectorXd> halves = halves_of(chains);
  const Eigen::Index length = halves[0].size();
  const double n = static_cast<double>(length), draws = static_cast<double>(halves.size()) * n;
  const Variances variances = variances_of(halves);
  if (!(variances.all > 0.0)) return kUnset;

  // Correlation at each lag, of all halves together. The sum asks for few: all take n^2.
  const auto correlation = [&](Eigen::Index lags) -> VectorXd {
    VectorXd covariance = VectorXd::Zero(lags);
    for (const VectorXd& half : halves) covariance += autocovariance(half, lags - 1);
    covariance *= n / (n - 1.0) / static_cast<double>(halves.size());
    return 1.0 - (variances.within - covariance.array()) / variances.all;
  };
  VectorXd rho = correlation(std::min<Eigen::Index>(length, 64));

  // Geyer's initial monotone sequence of sums of pairs.
  double tau = -1.0, last = kInfinity;
  for (Eigen::Index t = 0; t + 1 < length; t += 2) {
    if (t + 1 >= rho.size()) rho = correlation(std::min(2 * rho.size(), length));
    const double pair = rho[t] + rho[t + 1];
    if (!(pair > 0.0)) break;
    last = std::min(last, pair);
    tau += 2.0 * last;
  }
  return draws / std::max(tau, 1.0 / std::log10(draws));
}

double split_r_hat(const std::vector<VectorXd>& chains) {
  const std::vector<VectorXd> halves = halves_of(chains);
  std::vector<VectorXd> folded = halves;
  const double median = median_of(halves);
  for (VectorXd& half : folded) half = (half.array() - median).abs();
  return std::fmax(ratio_of(halves), ratio_of(folded));  // of a number and NaN: the number
}

Answer monte_carlo_answer(const std::vector<VectorXd>& chains) {
  const Moments moments = moments_of(all_of(chains));
  Answer answer;
  answer.mean = moments.mean;
  answer.deviation = std::sqrt(moments.variance);
  answer.effective_samples = effective_sample_size(chains);
  answer.standard_error = answer.deviation / std::sqrt(answer.effective_samples);
  return answer;
}

}  // namespace tumble::a5
