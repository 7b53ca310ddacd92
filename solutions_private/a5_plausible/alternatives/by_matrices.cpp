// Right, and written otherwise than the reference: arrays of Eigen for whole vectors of numbers,
// and chains as the columns of a matrix.
#include "assignments/a5_plausible/a5_plausible.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace tumble::a5 {
namespace {

using Eigen::ArrayXd;
using Eigen::ArrayXXd;
using Eigen::Index;
constexpr double kMinusInfinity = -std::numeric_limits<double>::infinity();

ArrayXd sizes_of(const Proposal& proposal) {
  ArrayXd sizes(static_cast<Index>(proposal.moves.size()));
  for (Index i = 0; i < sizes.size(); ++i)
    sizes[i] = proposal.moves[static_cast<std::size_t>(i)].size;
  return sizes;
}

ArrayXXd halves_of(const std::vector<VectorXd>& chains) {
  const Index length = chains[0].size() / 2;
  ArrayXXd halves(length, 2 * static_cast<Index>(chains.size()));
  for (Index c = 0; c < static_cast<Index>(chains.size()); ++c) {
    halves.col(c) = chains[static_cast<std::size_t>(c)].head(length).array();
    halves.col(halves.cols() - 1 - c) = chains[static_cast<std::size_t>(c)].tail(length).array();
  }
  return halves;
}

/// Columns about their means; exactly 0 where a column is of equal numbers.
ArrayXXd centred(const ArrayXXd& columns) {
  ArrayXXd moved = columns.rowwise() - columns.row(0);
  const Eigen::Array<double, 1, Eigen::Dynamic> means = moved.colwise().mean();
  moved.rowwise() -= means;
  return moved;
}

double variance_of(const ArrayXd& numbers) {
  return centred(numbers).square().sum() / static_cast<double>(numbers.size() - 1);
}

double within(const ArrayXXd& halves) {
  return centred(halves).square().sum() / static_cast<double>(halves.rows() - 1) /
         static_cast<double>(halves.cols());
}

double of_all(const ArrayXXd& halves) {
  const ArrayXXd from_first = halves - halves(0, 0);
  const ArrayXd means = (from_first.colwise().mean()).transpose();
  const double N = static_cast<double>(halves.rows());
  // Equal numbers in every half: their means are equal to rounding only.
  const double between = halves.minCoeff() == halves.maxCoeff() ? 0.0 : variance_of(means);
  return (N - 1) / N * within(halves) + between;
}

ArrayXXd scores_of(const ArrayXXd& numbers) {
  const Index S = numbers.size();
  std::vector<Index> order(static_cast<std::size_t>(S));
  std::iota(order.begin(), order.end(), Index{0});
  std::sort(order.begin(), order.end(),
            [&](Index a, Index b) { return numbers.data()[a] < numbers.data()[b]; });
  ArrayXXd scores(numbers.rows(), numbers.cols());
  for (std::size_t first = 0; first < order.size();) {
    std::size_t last = first;
    while (last + 1 < order.size() &&
           numbers.data()[order[last + 1]] == numbers.data()[order[first]])
      ++last;
    const double rank = 1.0 + static_cast<double>(first + last) / 2.0;
    for (std::size_t i = first; i <= last; ++i)
      scores.data()[order[i]] = normal_quantile((8 * rank - 3) / (8 * static_cast<double>(S) + 2));
    first = last + 1;
  }
  return scores;
}

double root_ratio(const ArrayXXd& halves) {
  const ArrayXXd scores = scores_of(halves);
  return std::sqrt(of_all(scores)) / std::sqrt(within(scores));
}

}  // namespace

double log_prior(const std::vector<Prior>& priors, const VectorXd& x) {
  VectorXd z = VectorXd::Zero(x.size());
  for (Index i = 0; i < x.size(); ++i) {
    const Prior& prior = priors[static_cast<std::size_t>(i)];
    const bool inside = prior.low <= x[i] && x[i] <= prior.high;
    if (!inside) return kMinusInfinity;
    if (prior.kind == PriorKind::kNormal) z[i] = (x[i] - prior.mean) / prior.deviation;
  }
  return -z.squaredNorm() / 2;
}

double log_target(double log_prior, double violation, double softness) {
  if (violation == 0) return log_prior;
  const double z = violation / softness;  // infinite where the constraint is hard
  return std::isnan(z) || std::isinf(log_prior) ? kMinusInfinity : log_prior - z * z / 2;
}

VectorXd propose(const Proposal& proposal, const VectorXd& x, const Draws& draws) {
  const ArrayXd step = (draws.choice < proposal.wide_share ? proposal.wide_factor : 1.0) *
                       sizes_of(proposal) * draws.normals.array();
  VectorXd to = x + step.matrix();
  for (Index i = 0; i < x.size(); ++i)
    if (proposal.moves[static_cast<std::size_t>(i)].kind == MoveKind::kMultiply)
      to[i] = x[i] + x[i] * std::expm1(step[i]);
  return to;
}

double log_proposal(const Proposal& proposal, const VectorXd& from, const VectorXd& to) {
  // Squares of steps and the product of what normalises, for sizes as they are.
  double squares = 0.0, constants = 0.0;
  int moving = 0;
  const ArrayXd sizes = sizes_of(proposal);
  for (Index i = 0; i < from.size(); ++i) {
    if (!(sizes[i] > 0)) {
      if (to[i] != from[i]) return kMinusInfinity;
      continue;
    }
    double step = to[i] - from[i];
    if (proposal.moves[static_cast<std::size_t>(i)].kind == MoveKind::kMultiply) {
      const bool keeps_its_sign = (to[i] > 0 && from[i] > 0) || (to[i] < 0 && from[i] < 0);
      if (!keeps_its_sign) return kMinusInfinity;
      step = std::log(std::abs(to[i])) - std::log(std::abs(from[i]));
      constants += std::log(std::abs(to[i]));
    }
    squares += (step / sizes[i]) * (step / sizes[i]);
    constants += std::log(sizes[i] * std::sqrt(2 * M_PI));
    ++moving;
  }
  const double w = proposal.wide_share, f = proposal.wide_factor;
  const double usual = -squares / 2 - constants,
               wide = -squares / (2 * f * f) - constants - moving * std::log(f);
  if (w <= 0) return usual;
  if (w >= 1) return wide;
  const double a = usual + std::log(1 - w), b = wide + std::log(w);
  return std::max(a, b) + std::log1p(std::exp(-std::abs(a - b)));
}

double log_acceptance(double log_target_from, double log_target_to, double log_forth,
                      double log_back) {
  if (!(std::min(log_target_to, log_back) > kMinusInfinity) || std::isnan(log_target_to))
    return kMinusInfinity;
  const double change = (log_back - log_forth) - (log_target_from - log_target_to);
  return change < 0 ? change : 0.0;
}

ChainState metropolis_step(const LogDensity& log_target, const Proposal& proposal,
                           const ChainState& state, const Draws& draws) {
  const VectorXd to = propose(proposal, state.x, draws);
  const double log_to = log_target(to),
               log_a = log_acceptance(state.log_target, log_to, log_proposal(proposal, state.x, to),
                                      log_proposal(proposal, to, state.x));
  const bool moves = log_a > kMinusInfinity && draws.uniform < std::exp(log_a);
  return moves ? ChainState{to, log_to, true} : ChainState{state.x, state.log_target, false};
}

VectorXd autocorrelation(const VectorXd& chain, int most_lag) {
  const VectorXd x = centred(chain.array()).matrix();
  VectorXd rho(most_lag + 1);
  for (int t = 0; t <= most_lag; ++t)
    rho[t] = x.head(x.size() - t).dot(x.tail(x.size() - t)) / x.squaredNorm();
  return rho;
}

double effective_sample_size(const std::vector<VectorXd>& chains) {
  const ArrayXXd halves = halves_of(chains), x = centred(halves);
  const double all = of_all(halves), S = static_cast<double>(halves.size());
  if (all == 0) return kUnset;
  VectorXd rho(halves.rows());
  for (Index t = 0; t < rho.size(); ++t)
    rho[t] =
        1 - (within(halves) - (x.topRows(rho.size() - t) * x.bottomRows(rho.size() - t)).sum() /
                                  static_cast<double>((rho.size() - 1) * halves.cols())) /
                all;
  std::vector<double> pairs;
  for (Index k = 0; 2 * k + 1 < rho.size() && rho[2 * k] + rho[2 * k + 1] > 0; ++k)
    pairs.push_back(rho[2 * k] + rho[2 * k + 1]);
  for (std::size_t k = 1; k < pairs.size(); ++k) pairs[k] = std::min(pairs[k], pairs[k - 1]);
  const double tau = 2 * std::accumulate(pairs.begin(), pairs.end(), 0.0) - 1;
  return std::min(S * std::log10(S), tau > 0 ? S / tau : std::numeric_limits<double>::infinity());
}

double split_r_hat(const std::vector<VectorXd>& chains) {
  const ArrayXXd halves = halves_of(chains);
  std::vector<double> numbers(halves.data(), halves.data() + halves.size());
  const auto middle = numbers.begin() + static_cast<std::ptrdiff_t>(numbers.size() / 2);
  std::nth_element(numbers.begin(), middle, numbers.end());
  const double median = (*middle + *std::max_element(numbers.begin(), middle)) / 2;
  const double bulk = root_ratio(halves), tails = root_ratio((halves - median).abs());
  return std::isnan(tails) || bulk > tails ? bulk : tails;
}

Answer monte_carlo_answer(const std::vector<VectorXd>& chains) {
  VectorXd all(static_cast<Index>(chains.size()) * chains[0].size());
  for (std::size_t c = 0; c < chains.size(); ++c)
    all.segment(static_cast<Index>(c) * chains[c].size(), chains[c].size()) = chains[c];
  const double n = effective_sample_size(chains), deviation = std::sqrt(variance_of(all.array()));
  return {all.mean(), deviation, n, std::sqrt(deviation * deviation / n)};
}

}  // namespace tumble::a5
