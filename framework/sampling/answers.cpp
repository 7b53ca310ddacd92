#include "framework/sampling/answers.h"
#include "framework/core/text.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace tumble::sampling {
namespace {

constexpr int kLeastSamples = 8;  // of a chain: halves of four

// When chains have met (Vehtari et al. 2021); above the second they may have missed worlds.
constexpr double kMet = 1.01, kApart = 1.1;
constexpr double kFewEffective = 50.0;  // of half a chain: below, R-hat and errors are rough
constexpr double kManyBroken = 0.02;    // of runs: worlds that are left out change the answer

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

bool can_be_used(const Answers& answers) {
  return answers.done > 0 && answers.worst_r_hat <= kApart &&
         answers.broken <= kManyBroken * answers.simulations;
}

std::vector<std::string> doubts(const Answers& answers, std::size_t chains) {
  std::vector<std::string> all;
  if (answers.done == 0)
    return {
        "No sample does what is asked: there is no answer. Take more samples or a longer "
        "warm-up, or let near misses count for more (softness)."};
  // By chance alone R-hat^2 - 1 falls as 1 / samples.
  const double r_hat = answers.worst_r_hat, longer = (r_hat * r_hat - 1.0) / (kMet * kMet - 1.0);
  if (!std::isfinite(r_hat))
    all.push_back(
        "R-hat is unknown: a number stands still in the chains, so nothing shows whether "
        "they have met.");
  else if (r_hat > kApart)
    all.push_back(fmt::format(
        "The chains have not met (R-hat {:.2f}): do not trust these answers, nor their errors. "
        "Take about {} times as many samples; if that does not help, other steps.",
        r_hat, few_digits(longer)));
  else if (r_hat > kMet)
    all.push_back(fmt::format(
        "The chains nearly agree (R-hat {:.3f}, wanted {}): errors are rough. About {} times "
        "as many samples would do.",
        r_hat, kMet, few_digits(longer)));
  const double wanted = 2.0 * kFewEffective * static_cast<double>(chains);
  if (!(answers.least_effective >= wanted))
    all.push_back(fmt::format(
        "The worst known number has {:.0f} effective samples, fewer than the {:.0f} that {} chains "
        "should have: its error is known to a factor only.",
        std::isfinite(answers.least_effective) ? answers.least_effective : 0.0, wanted, chains));
  if (answers.broken > kManyBroken * answers.simulations)
    all.push_back(fmt::format(
        "{} of {} runs broke; such worlds count as impossible, which may bias the answers.",
        answers.broken, answers.simulations));
  return all;
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
