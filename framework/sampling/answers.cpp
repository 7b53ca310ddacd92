#include "framework/sampling/answers.h"

#include <algorithm>
#include <cmath>

namespace tumble::sampling {
namespace {

constexpr int kLeastSamples = 8;  // of a chain: halves of four

double smaller(double a, double b) { return std::fmin(a, b); }  // of a number and NaN: the number

std::vector<VectorXd> parts_of(const std::vector<Chain>& chains, int samples,
                               const std::function<double(const Chain&, Eigen::Index)>& value) {
  std::vector<VectorXd> all;
  for (const Chain& chain : chains) {
    VectorXd numbers(samples);
    for (Eigen::Index i = 0; i < samples; ++i) numbers[i] = value(chain, i);
    all.push_back(std::move(numbers));
  }
  return all;
}

bool is_done(const Chain& chain, Eigen::Index i) { return chain.violation[i] == 0.0; }

Estimate estimate_of(const Sampling& by, const std::string& name, const std::vector<Chain>& chains,
                     int samples, Eigen::Index number) {
  Estimate estimate;
  estimate.name = name;
  const std::vector<VectorXd> all = parts_of(
      chains, samples, [&](const Chain& chain, Eigen::Index i) { return chain.x(i, number); });
  estimate.r_hat = by.split_r_hat(all);
  double done = 0.0, sum = 0.0, squares = 0.0;
  for (const Chain& chain : chains)
    for (Eigen::Index i = 0; i < samples; ++i)
      if (is_done(chain, i)) done += 1.0, sum += chain.x(i, number);
  if (done == 0.0) return estimate;
  const double mean = sum / done,
               share = done / (static_cast<double>(samples) * static_cast<double>(chains.size()));
  for (const Chain& chain : chains)
    for (Eigen::Index i = 0; i < samples; ++i)
      if (is_done(chain, i)) squares += (chain.x(i, number) - mean) * (chain.x(i, number) - mean);
  // mean = (mean of h x) / (mean of h) with h = 1 where it is done; its error to first order is
  // that of the mean of h (x - mean) / (mean of h).
  const Answer linear =
      by.monte_carlo_answer(parts_of(chains, samples, [&](const Chain& chain, Eigen::Index i) {
        return is_done(chain, i) ? (chain.x(i, number) - mean) / share : 0.0;
      }));
  estimate.answer.mean = mean;
  estimate.answer.deviation = done > 1.0 ? std::sqrt(squares / (done - 1.0)) : kUnset;
  estimate.answer.standard_error = linear.standard_error;
  // As many independent worlds that do what is asked would have the same error.
  const double ratio = estimate.answer.deviation / linear.standard_error;
  estimate.answer.effective_samples = ratio * ratio;
  return estimate;
}

}  // namespace

Answers answers_of(const Sampling& by, const std::vector<std::string>& names,
                   const std::vector<Chain>& chains, int samples) {
  Answers answers;
  answers.samples = samples * static_cast<int>(chains.size());
  double accepted = 0.0;
  answers.cpu_s = 0.0;
  for (const Chain& chain : chains) {
    for (Eigen::Index i = 0; i < samples; ++i) answers.done += is_done(chain, i) ? 1 : 0;
    accepted += static_cast<double>(chain.accepted) / static_cast<double>(chain.x.rows());
    answers.cpu_s += chain.cpu_s[samples - 1];
    answers.simulations += chain.simulations;
    answers.broken += chain.broken;
  }
  answers.acceptance = accepted / static_cast<double>(chains.size());
  answers.share =
      by.monte_carlo_answer(parts_of(chains, samples, [](const Chain& chain, Eigen::Index i) {
        return is_done(chain, i) ? 1.0 : 0.0;
      }));
  for (std::size_t number = 0; number < names.size(); ++number) {
    const Estimate estimate =
        estimate_of(by, names[number], chains, samples, static_cast<Eigen::Index>(number));
    answers.worst_r_hat = std::fmax(answers.worst_r_hat, estimate.r_hat);
    answers.least_effective = smaller(answers.least_effective, estimate.answer.effective_samples);
    answers.estimates.push_back(estimate);
  }
  return answers;
}

std::vector<Answers> growing_answers(const Sampling& by, const std::vector<std::string>& names,
                                     const std::vector<Chain>& chains) {
  std::vector<Answers> all;
  const int samples = static_cast<int>(chains.front().x.rows());
  for (int part = 32; part >= 1; part /= 2)
    if (samples / part >= kLeastSamples)
      all.push_back(answers_of(by, names, chains, samples / part));
  return all;
}

std::vector<Chain> cut(const Chain& chain, int parts) {
  std::vector<Chain> all;
  const Eigen::Index length = chain.x.rows() / parts;
  for (int part = 0; part < parts; ++part) {
    Chain piece;
    piece.number = part;
    piece.x = chain.x.middleRows(part * length, length);
    piece.log_target = chain.log_target.segment(part * length, length);
    piece.violation = chain.violation.segment(part * length, length);
    piece.cpu_s = chain.cpu_s.segment(part * length, length).array() -
                  (part == 0 ? 0.0 : chain.cpu_s[part * length - 1]);
    piece.accepted = static_cast<int>(length);
    piece.simulations = static_cast<int>(length);
    piece.broken = part == 0 ? chain.broken : 0;
    all.push_back(std::move(piece));
  }
  return all;
}

}  // namespace tumble::sampling
