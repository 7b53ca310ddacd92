// Right, and written otherwise than the reference: plain loops and vectors of doubles, all
// constants of the densities included, shares added by the larger exponent, lags summed one by
// one.
#include "assignments/a5_plausible/a5_plausible.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace tumble::a5 {
namespace {

using Numbers = std::vector<double>;
const double kNever = -std::numeric_limits<double>::infinity();

double log_bell(double z) { return -z * z / 2 - 0.91893853320467274178; }  // ln sqrt(2 pi)

double mean_of(const Numbers& x) {
  double sum = 0;
  for (const double v : x) sum += v - x[0];  // about the first: equal numbers leave exactly 0
  return x[0] + sum / static_cast<double>(x.size());
}

double sum_of_squares(const Numbers& x) {
  const double m = mean_of(x);
  double sum = 0;
  for (const double v : x) sum += (v - m) * (v - m);
  return sum;
}

double product_at(const Numbers& x, std::size_t lag) {
  const double m = mean_of(x);
  double sum = 0;
  for (std::size_t i = lag; i < x.size(); ++i) sum += (x[i] - m) * (x[i - lag] - m);
  return sum / static_cast<double>(x.size());
}

std::vector<Numbers> cut(const std::vector<VectorXd>& chains) {
  std::vector<Numbers> halves;
  for (const VectorXd& chain : chains) {
    const auto n = static_cast<std::size_t>(chain.size());
    Numbers first, second;
    for (std::size_t i = 0; i < n / 2; ++i) {
      first.push_back(chain[static_cast<Eigen::Index>(i)]);
      second.push_back(chain[static_cast<Eigen::Index>(n - n / 2 + i)]);
    }
    halves.push_back(first);
    halves.push_back(second);
  }
  return halves;
}

void within_and_all(const std::vector<Numbers>& halves, double& within, double& all) {
  const double N = static_cast<double>(halves[0].size()), M = static_cast<double>(halves.size());
  Numbers means;
  within = 0;
  for (const Numbers& half : halves) {
    within += sum_of_squares(half) / (N - 1) / M;
    means.push_back(mean_of(half));
  }
  all = within * (1 - 1 / N) + sum_of_squares(means) / (M - 1);
}

double r_of(std::vector<Numbers> halves) {
  std::map<double, double> below;  // how often each number comes; then how many are smaller
  double count = 0;
  for (const Numbers& half : halves)
    for (const double x : half) below[x] += 1, count += 1;
  std::map<double, double> score;
  double smaller = 0;
  for (const auto& [x, times] : below) {
    score[x] = normal_quantile((smaller + (times + 1) / 2 - 0.375) / (count + 0.25));
    smaller += times;
  }
  for (Numbers& half : halves)
    for (double& x : half) x = score[x];
  double within, all;
  within_and_all(halves, within, all);
  return std::sqrt(all / within);
}

}  // namespace

double log_prior(const std::vector<Prior>& priors, const VectorXd& x) {
  double sum = 0;
  for (std::size_t i = 0; i < priors.size(); ++i) {
    const double v = x[static_cast<Eigen::Index>(i)];
    const Prior& p = priors[i];
    if (std::isnan(v) || v < p.low || v > p.high) return kNever;
    sum += p.kind == PriorKind::kUniform
               ? -std::log(p.high - p.low)
               : log_bell((v - p.mean) / p.deviation) - std::log(p.deviation);
  }
  return sum;
}

double log_target(double log_prior, double violation, double softness) {
  if (violation != violation || log_prior == kNever) return kNever;
  if (softness == 0) return violation > 0 ? kNever : log_prior;
  return log_prior - std::pow(violation / softness, 2) / 2;
}

VectorXd propose(const Proposal& proposal, const VectorXd& x, const Draws& draws) {
  VectorXd to(x.size());
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const Move& m = proposal.moves[static_cast<std::size_t>(i)];
    const double s = m.size * (draws.choice >= proposal.wide_share ? 1 : proposal.wide_factor);
    to[i] = m.kind == MoveKind::kAdd ? x[i] + s * draws.normals[i]
                                     : x[i] * std::exp(s * draws.normals[i]);
  }
  return to;
}

double log_proposal(const Proposal& proposal, const VectorXd& from, const VectorXd& to) {
  double usual = 0, wide = 0;
  for (Eigen::Index i = 0; i < from.size(); ++i) {
    const Move& m = proposal.moves[static_cast<std::size_t>(i)];
    if (m.size == 0) {
      if (from[i] != to[i]) return kNever;
    } else if (m.kind == MoveKind::kAdd) {
      const double step = to[i] - from[i];
      usual += log_bell(step / m.size) - std::log(m.size);
      wide += log_bell(step / m.size / proposal.wide_factor) - std::log(m.size) -
              std::log(proposal.wide_factor);
    } else {
      if (to[i] == 0 || std::signbit(to[i]) != std::signbit(from[i])) return kNever;
      const double step = std::log(std::abs(to[i])) - std::log(std::abs(from[i])),
                   jacobian = std::log(std::abs(to[i]));
      usual += log_bell(step / m.size) - std::log(m.size) - jacobian;
      wide += log_bell(step / m.size / proposal.wide_factor) - std::log(m.size) -
              std::log(proposal.wide_factor) - jacobian;
    }
  }
  const double w = proposal.wide_share;
  if (w == 0) return usual;
  if (w == 1) return wide;
  const double top = std::max(usual, wide);
  return top + std::log((1 - w) * std::exp(usual - top) + w * std::exp(wide - top));
}

double log_acceptance(double log_target_from, double log_target_to, double log_forth,
                      double log_back) {
  if (std::isnan(log_target_to) || log_target_to == kNever || log_back == kNever) return kNever;
  const double gain = log_target_to + log_back - log_forth;
  return log_target_from == kNever || gain >= log_target_from ? 0.0 : gain - log_target_from;
}

ChainState metropolis_step(const LogDensity& log_target, const Proposal& proposal,
                           const ChainState& state, const Draws& draws) {
  ChainState next;
  next.x = propose(proposal, state.x, draws);
  next.log_target = log_target(next.x);
  const double a = std::exp(log_acceptance(state.log_target, next.log_target,
                                           log_proposal(proposal, state.x, next.x),
                                           log_proposal(proposal, next.x, state.x)));
  next.accepted = draws.uniform < a;
  if (next.accepted) return next;
  ChainState same = state;
  same.accepted = false;
  return same;
}

VectorXd autocorrelation(const VectorXd& chain, int most_lag) {
  const Numbers x(chain.data(), chain.data() + chain.size());
  VectorXd rho(most_lag + 1);
  for (int t = 0; t <= most_lag; ++t)
    rho[t] = product_at(x, static_cast<std::size_t>(t)) / product_at(x, 0);
  return rho;
}

double effective_sample_size(const std::vector<VectorXd>& chains) {
  const std::vector<Numbers> halves = cut(chains);
  const std::size_t n = halves[0].size();
  const double N = static_cast<double>(n), M = static_cast<double>(halves.size());
  double within, all;
  within_and_all(halves, within, all);
  const auto rho = [&](std::size_t t) {
    double c = 0;
    for (const Numbers& half : halves) c += product_at(half, t);
    return 1 - (within - c / M * N / (N - 1)) / all;
  };
  if (all == 0) return kUnset;
  double sum = 0, before = 4;
  for (std::size_t k = 0; 2 * k + 1 < n; ++k) {
    double pair = rho(2 * k) + rho(2 * k + 1);
    if (pair <= 0) break;
    if (pair > before) pair = before;
    sum += before = pair;
  }
  const double least = 1 / std::log10(N * M), tau = 2 * sum - 1;
  return N * M / (tau < least ? least : tau);
}

double split_r_hat(const std::vector<VectorXd>& chains) {
  std::vector<Numbers> halves = cut(chains);
  std::vector<double> all;
  for (const Numbers& half : halves) all.insert(all.end(), half.begin(), half.end());
  std::sort(all.begin(), all.end());
  const double median = all[all.size() / 2] / 2 + all[all.size() / 2 - 1] / 2;
  const double bulk = r_of(halves);
  for (Numbers& half : halves)
    for (double& x : half) x = x < median ? median - x : x - median;
  const double tails = r_of(halves);
  if (std::isnan(bulk)) return tails;
  return bulk > tails || std::isnan(tails) ? bulk : tails;
}

Answer monte_carlo_answer(const std::vector<VectorXd>& chains) {
  Numbers all;
  for (const VectorXd& chain : chains)
    all.insert(all.end(), chain.data(), chain.data() + chain.size());
  Answer answer;
  answer.mean = mean_of(all);
  answer.deviation = std::sqrt(sum_of_squares(all) / (static_cast<double>(all.size()) - 1));
  answer.effective_samples = effective_sample_size(chains);
  answer.standard_error = answer.deviation * std::sqrt(1 / answer.effective_samples);
  return answer;
}

}  // namespace tumble::a5
