#include "framework/sampling/chains.h"

#include <cmath>
#include <limits>

#include "framework/core/cpu_time.h"
#include "framework/core/error.h"
#include "framework/core/normal.h"
#include "framework/core/random.h"

namespace tumble::sampling {
namespace {

constexpr int kStarts = 100;  // worlds of the prior that a chain tries to begin with

/// A stream of its own for each chain: two draws of the generator apart from its neighbours'.
Random stream_of(std::uint64_t seed, int number) {
  Random seeds(seed);
  const std::uint64_t own = seeds.next();
  Random mixed(own ^ (0x9e3779b97f4a7c15ULL * (static_cast<std::uint64_t>(number) + 1)));
  return Random(mixed.next());
}

/// Worlds run so far by one chain: the density, and what the run of the last world said.
class Worlds {
 public:
  Worlds(const SampledScene& sampled, const Sampling& by, const Laws& laws,
         const engines::RunOptions& run, bool is_hard)
      : sampled_(sampled),
        by_(by),
        laws_(laws),
        run_(run),
        priors_(priors_of(sampled)),
        is_hard_(is_hard) {}

  double log_target(const VectorXd& x) {
    violation_ = kUnset;
    if (x.size() != static_cast<Eigen::Index>(priors_.size())) return kUnset;
    const double log_prior = by_.log_prior(priors_, x);
    constexpr double kImpossible = -std::numeric_limits<double>::infinity();
    if (!is_inside(x)) return kImpossible;
    if (!(log_prior > kImpossible)) return log_prior;
    ++simulations_;
    const WorldEnd end = end_of(sampled_, laws_, run_, x);
    if (!end.stopped_by.empty()) ++broken_;
    violation_ = end.violation;
    return by_.log_target(log_prior, violation_, is_hard_ ? 0.0 : 1.0);
  }

  const std::vector<Prior>& priors() const { return priors_; }
  double violation() const { return violation_; }  // of the last world
  int simulations() const { return simulations_; }
  int broken() const { return broken_; }

 private:
  // A log_prior that lets a world pass which the scene cannot hold is not asked to run it.
  bool is_inside(const VectorXd& x) const {
    for (std::size_t i = 0; i < priors_.size(); ++i) {
      const double value = x[static_cast<Eigen::Index>(i)];
      if (!(value >= priors_[i].low && value <= priors_[i].high)) return false;
    }
    return true;
  }

  const SampledScene& sampled_;
  const Sampling& by_;
  const Laws& laws_;
  const engines::RunOptions& run_;
  std::vector<Prior> priors_;
  bool is_hard_;
  double violation_ = kUnset;
  int simulations_ = 0, broken_ = 0;
};

Draws draws_of(Random& random, Eigen::Index n) {
  Draws draws;
  draws.choice = random.unit();
  draws.normals = VectorXd(n);
  for (double& z : draws.normals) z = normal_number(random);
  draws.uniform = random.unit();
  return draws;
}

Chain empty_chain(int number, int samples, std::size_t numbers) {
  Chain chain;
  chain.number = number;
  chain.x = MatrixXd(samples, static_cast<Eigen::Index>(numbers));
  chain.log_target = chain.violation = chain.cpu_s = VectorXd(samples);
  return chain;
}

}  // namespace

Chain run_chain(const SampledScene& sampled, const Sampling& by, const Laws& laws,
                const engines::RunOptions& run, const ChainOptions& options, int number) {
  const double begun = cpu_seconds();
  Worlds worlds(sampled, by, laws, run, options.is_hard);
  Random random = stream_of(options.seed, number);
  const Proposal proposal = proposal_of(sampled);
  const LogDensity log_target = [&](const VectorXd& x) { return worlds.log_target(x); };

  // A start that is possible, from the prior: chains begin far apart.
  ChainState state;
  double violation = kUnset;
  for (int i = 0; i < kStarts && !std::isfinite(state.log_target); ++i) {
    state.x = drawn_from_prior(worlds.priors(), random);
    state.log_target = log_target(state.x);
    violation = worlds.violation();
  }
  if (!std::isfinite(state.log_target))
    throw UserError("chain " + std::to_string(number),
                    "none of " + std::to_string(kStarts) +
                        " worlds drawn from the prior is possible by log_prior and log_target",
                    options.is_hard ? "Leave --hard out: then near misses show the way."
                                    : "See tumble check a5.");

  Chain chain = empty_chain(number, options.samples, worlds.priors().size());
  const int steps = options.warm_up + options.samples;
  for (int step = 0; step < steps; ++step) {
    const int before = worlds.simulations();
    ChainState next =
        by.metropolis_step(log_target, proposal, state, draws_of(random, state.x.size()));
    if (next.x.size() != state.x.size())
      throw UserError("metropolis_step", "returned a world of another size",
                      "See tumble check a5.");
    if (next.accepted && worlds.simulations() > before) violation = worlds.violation();
    state = std::move(next);
    const int kept = step - options.warm_up;
    if (kept >= 0) {
      chain.x.row(kept) = state.x.transpose();
      chain.log_target[kept] = state.log_target;
      chain.violation[kept] = violation;
      chain.accepted += state.accepted ? 1 : 0;
      chain.cpu_s[kept] = cpu_seconds() - begun;
    }
    if (options.progress) options.progress(number, step + 1, steps);
  }
  chain.simulations = worlds.simulations();
  chain.broken = worlds.broken();
  return chain;
}

Chain draw_prior(const SampledScene& sampled, const Laws& laws, const engines::RunOptions& run,
                 std::uint64_t seed, int samples, const std::function<void(int step)>& progress) {
  const double begun = cpu_seconds();
  Random random = stream_of(seed, -1);
  const std::vector<Prior> priors = priors_of(sampled);
  Chain chain = empty_chain(-1, samples, priors.size());
  for (int i = 0; i < samples; ++i) {
    const VectorXd x = drawn_from_prior(priors, random);
    const WorldEnd end = end_of(sampled, laws, run, x);
    chain.x.row(i) = x.transpose();
    chain.log_target[i] = 0.0;
    chain.violation[i] = end.violation;
    chain.cpu_s[i] = cpu_seconds() - begun;
    ++chain.simulations;
    if (!end.stopped_by.empty()) ++chain.broken;
    if (progress) progress(i + 1);
  }
  return chain;
}

}  // namespace tumble::sampling
