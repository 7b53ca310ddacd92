/// Markov chains over the worlds of a scene, by the functions of assignment a5; and worlds drawn
/// from the prior alone, to compare with.
///
/// A chain depends on the scene, the laws, the seed and its own number alone: the same chain gives
/// the same numbers, whatever other chains do.
#pragma once

#include <cstdint>
#include <functional>

#include "framework/sampling/worlds.h"

namespace tumble::sampling {

struct ChainOptions {
  std::uint64_t seed = 1;
  int samples = 400;     // kept, of each chain
  int warm_up = 200;     // steps before the first that is kept
  bool is_hard = false;  // what is asked is all or nothing; else violations have their softness
  // called after each step; empty: not called
  std::function<void(int chain, int step, int steps)> progress;
};

/// The kept samples of a chain.
struct Chain {
  int number = 0;
  MatrixXd x;           // (samples, numbers)
  VectorXd log_target;  // (samples)
  VectorXd violation;   // (samples)
  int accepted = 0;     // of the kept steps
  int simulations = 0;  // all of its runs; a world outside the prior is not run
  int broken = 0;       // runs that did not reach their end
  // CPU time after each kept step, from the chain's start [s]; compared with nothing
  VectorXd cpu_s;
};

/// @param by  the functions of a5, all of them
/// @throws UserError where no world with a possible start is found
Chain run_chain(const SampledScene& sampled, const Sampling& by, const Laws& laws,
                const engines::RunOptions& run, const ChainOptions& options, int number);

/// The first so many worlds of the prior, as a chain whose samples are independent.
Chain draw_prior(const SampledScene& sampled, const Laws& laws, const engines::RunOptions& run,
                 std::uint64_t seed, int samples,
                 const std::function<void(int step)>& progress = {});

}  // namespace tumble::sampling
