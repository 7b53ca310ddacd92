/// What a Markov chain over worlds works on, and its parts as replaceable functions (assignment
/// a5): plain data, no engine.
///
/// A world is described by the numbers x in which it may differ: how far a slab of the floor leans,
/// a coefficient of restitution, a component of a velocity. Logarithms are natural ones; densities
/// are per unit of what x counts in.
/// Sources: S. Chenney, D. A. Forsyth, "Sampling plausible solutions to multi-body constraint
/// problems", SIGGRAPH 2000; A. Vehtari, A. Gelman, D. Simpson, B. Carpenter, P.-C. Buerkner,
/// "Rank-normalization, folding, and localization: an improved R-hat for assessing convergence of
/// MCMC", Bayesian Analysis 16(2), 2021.
#pragma once

#include <functional>
#include <vector>

#include "framework/core/math.h"

namespace tumble {

enum class PriorKind { kUniform, kNormal };

/// What is believed of one number of a world before anything is asked of the world.
struct Prior {
  PriorKind kind = PriorKind::kUniform;
  // of kNormal, before it is cut off at the bounds; not used by kUniform
  double mean = kUnset;
  double deviation = kUnset;  // standard deviation, > 0
  // no number below `low` or above `high` is possible; -infinity and +infinity: no bound. Of
  // kUniform both are finite
  double low = kUnset;
  double high = kUnset;
};

enum class MoveKind { kAdd, kMultiply };

/// How a proposal changes one number.
struct Move {
  MoveKind kind = MoveKind::kAdd;
  // >= 0; standard deviation of the change, of kMultiply of the change of log |x| [-]. 0: it stays
  double size = kUnset;
};

/// A mixture of two proposals, one of which takes wide steps.
struct Proposal {
  std::vector<Move> moves;   // by number of x
  double wide_share = 0.0;   // probability of a wide step, in [0, 1]
  double wide_factor = 1.0;  // > 0; a wide step has sizes so many times as large
};

/// Random numbers for one step of a chain: drawn by the caller, so that a chain can be repeated.
struct Draws {
  double choice = kUnset;   // uniform in [0, 1): which of the two proposals
  VectorXd normals;         // standard normal, one for each number of x
  double uniform = kUnset;  // uniform in [0, 1): whether the proposal is accepted
};

/// Where a chain is.
struct ChainState {
  VectorXd x;
  double log_target = kUnset;  // of x, up to a constant; -infinity: impossible
  bool accepted = false;       // whether the last proposal was
};

/// An answer from samples, with its error.
struct Answer {
  double mean = kUnset;
  double deviation = kUnset;          // standard deviation of one sample
  double effective_samples = kUnset;  // as many independent samples would have the same error
  double standard_error = kUnset;     // of the mean
};

using LogDensity = std::function<double(const VectorXd& x)>;

struct Sampling {
  std::function<double(const std::vector<Prior>& priors, const VectorXd& x)> log_prior;
  std::function<double(double log_prior, double violation, double softness)> log_target;
  std::function<VectorXd(const Proposal& proposal, const VectorXd& x, const Draws& draws)> propose;
  std::function<double(const Proposal& proposal, const VectorXd& from, const VectorXd& to)>
      log_proposal;
  std::function<double(double log_target_from, double log_target_to, double log_forth,
                       double log_back)>
      log_acceptance;
  std::function<ChainState(const LogDensity& log_target, const Proposal& proposal,
                           const ChainState& state, const Draws& draws)>
      metropolis_step;
  std::function<VectorXd(const VectorXd& chain, int most_lag)> autocorrelation;
  std::function<double(const std::vector<VectorXd>& chains)> effective_sample_size;
  std::function<double(const std::vector<VectorXd>& chains)> split_r_hat;
  std::function<Answer(const std::vector<VectorXd>& chains)> monte_carlo_answer;

  bool complete() const {
    return log_prior && log_target && propose && log_proposal && log_acceptance &&
           metropolis_step && autocorrelation && effective_sample_size && split_r_hat &&
           monte_carlo_answer;
  }
};

}  // namespace tumble
