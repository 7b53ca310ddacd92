/// Assignment 5, Plausible motion: what you write. Theory, hints and points:
/// handouts/a5_plausible.md. Your file: a5_plausible.cpp.
///
/// A simulation answers: given this world, what happens? Here the question is turned round: what
/// may the world have been, if the ball ended in the bin? The functions make a Markov chain whose
/// states are worlds: what is believed of a world, how the next one is proposed, and when it is
/// accepted; and they say how far the answers of such a chain can be trusted. The simulation of a
/// world is given.
///
/// Terms, symbols and sources: handouts/notation.md. The types of what is passed:
/// framework/dynamics/sampling.h. Logarithms are natural. All functions are pure: the random
/// numbers are given to them. Sources, cited below by name:
///   Chenney   S. Chenney, D. A. Forsyth, "Sampling plausible solutions to multi-body constraint
///             problems", SIGGRAPH 2000
///   Hastings  W. K. Hastings, "Monte Carlo sampling methods using Markov chains and their
///             applications", Biometrika 57(1), 1970
///   Geyer     C. J. Geyer, "Practical Markov chain Monte Carlo", Statistical Science 7(4), 1992
///   Vehtari   A. Vehtari, A. Gelman, D. Simpson, B. Carpenter, P.-C. Buerkner,
///             "Rank-normalization, folding, and localization: an improved R-hat for assessing
///             convergence of MCMC", Bayesian Analysis 16(2), 2021
#pragma once

#include "framework/core/normal.h"
#include "framework/core/not_implemented.h"
#include "framework/dynamics/sampling.h"
#include "framework/modules/answer_sizes.h"
#include "framework/modules/module.h"

namespace tumble::a5 {

// ---- What is believed, and what is asked --------------------------------------------------------

/// Logarithm of the density of a world's numbers before anything is asked of it.
///   ln p(x) = sum over i of ln p_i(x_i),                                                    (A5.1)
///       normal:   ln p_i = -1/2 ((x_i - mean) / deviation)^2,      uniform:  ln p_i = 0
/// up to a constant that does not depend on x: what normalises p_i may be added or left out.
/// @param priors  one for each number; the numbers are independent
/// @param x       (n), n >= 1, in the units of the priors
/// @return -infinity where a number is below its `low` or above its `high` (both ends are possible
///         themselves), or is NaN; also where the square exceeds the doubles. Never NaN. Sum
///         logarithms: the product of 200 densities is below the smallest double
/// Source: Chenney, section 3.   Tests: LogPrior.*
/// Hints: handouts/a5_plausible.md#hint-log-prior
double log_prior(const std::vector<Prior>& priors, const VectorXd& x);

/// Logarithm of the density that the chain samples: the prior, times how well the world does what
/// is asked of it.
///   ln pi = ln p - 1/2 (violation / softness)^2                                             (A5.2)
///   softness 0 (a hard constraint):  ln pi = ln p where violation == 0, otherwise -infinity
/// @param log_prior  ln p of the world; may be -infinity
/// @param violation  >= 0: how far the end of the run is from what is asked; 0: it is done. NaN:
///                   the run broke, and such a world is impossible: -infinity
/// @param softness   >= 0, in the unit of the violation: violations of this size are still common
/// @return never NaN. Divide before you square: both may be as small as 1e-200
/// Source: Chenney, section 3.2.   Tests: LogTarget.*
/// Hints: handouts/a5_plausible.md#hint-log-target
double log_target(double log_prior, double violation, double softness);

// ---- Where the chain goes next ------------------------------------------------------------------

/// The numbers that are proposed after x. All of them change at once.
///   kAdd:       x'_i = x_i + f s_i z_i
///   kMultiply:  x'_i = x_i exp(f s_i z_i)                                                   (A5.3)
///   f = wide_factor where choice < wide_share (a wide step), otherwise 1
/// @param proposal  s_i: moves[i].size;  wide_share, wide_factor
/// @param x         (n); a number that is multiplied is not 0
/// @param draws     z_i: normals[i], (n);  choice in [0, 1). `uniform` is not used here
/// @return (n)
/// Source: Hastings, section 2.   Tests: Propose.*
/// Hints: handouts/a5_plausible.md#hint-propose
VectorXd propose(const Proposal& proposal, const VectorXd& x, const Draws& draws);

/// Logarithm of the density with which `propose` leads from one place to another.
///   q(to | from) = (1 - w) q_1(to | from) + w q_f(to | from),   w = wide_share              (A5.4)
///   q_f = product over i of   g((to_i - from_i) / (f s_i)) / (f s_i)                   kAdd
///                             g(ln(to_i / from_i) / (f s_i)) / (f s_i |to_i|)          kMultiply
///   g(z) = exp(-z^2 / 2) / sqrt(2 pi)
/// Both proposals can have led there, so both count, whichever was chosen. 1/|to_i| is the Jacobian
/// of ln: the density is one of to_i, not of its logarithm.
/// @param from, to  (n)
/// @return of the density itself, all constants included: over `to` it integrates to 1. -infinity
///         where `to` cannot be reached: a number of size 0 has changed (one that has not
///         contributes the factor 1), or a multiplied one has changed its sign. Finite where
///         q underflows: ln q = -1e6 is an answer
/// Source: Hastings, section 2.   Tests: LogProposal.*
/// Hints: handouts/a5_plausible.md#hint-log-proposal
double log_proposal(const Proposal& proposal, const VectorXd& from, const VectorXd& to);

/// Logarithm of the probability with which a proposal is accepted.
///   ln a = min(0,  ln pi(x') - ln pi(x) + ln q(x | x') - ln q(x' | x))                      (A5.5)
/// In this order:  -infinity where pi(x') is 0 or not known (-infinity, NaN), or where no way leads
/// back (log_back is -infinity);  0 where pi(x) is 0: a chain that began at an impossible place
/// leaves it;  otherwise (A5.5).
/// @param log_target_from, log_target_to  ln pi(x), ln pi(x'), with one unknown constant in both
/// @param log_forth  ln q(x' | x)
/// @param log_back   ln q(x | x')
/// @return <= 0, never NaN
/// @post  detailed balance: pi(x) q(x' | x) a(x, x') == pi(x') q(x | x') a(x', x)
/// Source: Hastings, section 2.   Tests: LogAcceptance.*
/// Hints: handouts/a5_plausible.md#hint-log-acceptance
double log_acceptance(double log_target_from, double log_target_to, double log_forth,
                      double log_back);

/// One step of the chain: a proposal, which is accepted or not.
///   x <- x' where u < a, otherwise x once more                                              (A5.6)
/// @param log_target  ln pi. Call it exactly once, at the proposal: each call is a simulation
/// @param proposal    as for propose
/// @param state       x and its log_target, which is not computed again
/// @param draws       choice and normals: of the proposal;  u: uniform, in [0, 1)
/// @return where the chain is now: x (n), its log_target, and whether this proposal was accepted
///         (state.accepted is about the one before). An impossible place is never entered, also
///         not with u == 0
/// Source: Hastings, section 2.   Tests: MetropolisStep.*
/// Hints: handouts/a5_plausible.md#hint-metropolis-step
ChainState metropolis_step(const LogDensity& log_target, const Proposal& proposal,
                           const ChainState& state, const Draws& draws);

// ---- How far the answers can be trusted ---------------------------------------------------------

/// Correlation of a chain with itself, t steps later.
///   c_t = 1/n sum from i = 1 to n - t of (x_i - m) (x_(i+t) - m),   rho_t = c_t / c_0       (A5.7)
/// m is the mean of the whole chain. The divisor is n at every lag, although the sum has n - t
/// terms: so late lags, of which little is known, weigh little.
/// @param chain     (n), n >= 2
/// @param most_lag  0 <= most_lag < n
/// @return (most_lag + 1): rho_0 == 1 first. All NaN where all numbers of the chain are equal:
///         nothing is known
/// Source: Geyer, section 3.1.   Tests: Autocorrelation.*
/// Hints: handouts/a5_plausible.md#hint-autocorrelation
VectorXd autocorrelation(const VectorXd& chain, int most_lag);

/// Number of independent samples that would give the mean with the same error. Each chain is cut
/// into halves first (of an odd number the middle one is left out): M halves of N, S = M N.
///   W = mean of the halves' variances (divisor N - 1),   B/N = variance of their means (M - 1)
///   var_plus = (N - 1)/N W + B/N                                                            (A5.8)
///   rho_t = 1 - (W - N/(N - 1) mean of the halves' c_t) / var_plus,   c_t of (A5.7)
///   P_k = rho_2k + rho_(2k+1);  k = 0, 1, ... while P_k > 0 and 2k + 1 < N;
///       then P_k <- min(P_k, P_(k-1)), with P_(k-1) as it has become
///   tau = -1 + 2 sum of P_k, at least 1/log10(S);   S_eff = S / tau
/// @param chains  at least one, all of the same length >= 4
/// @return > 0;  NaN where all numbers of all halves are equal
/// Source: Vehtari, section 3; Geyer, section 3.3.   Tests: EffectiveSampleSize.*
/// Hints: handouts/a5_plausible.md#hint-effective-sample-size
double effective_sample_size(const std::vector<VectorXd>& chains);

/// Whether chains have found the same distribution: below 1.01 is wanted; above it they have not,
/// or are too short to show it.
/// Halves, W and var_plus as in (A5.8), but of scores z instead of the numbers themselves:
///   z = normal_quantile((r - 3/8) / (S + 1/4))                                              (A5.9)
/// r is the rank of a number among all S numbers of all halves, from 1; equal numbers share the
/// mean of their ranks.
///   R(numbers) = sqrt(var_plus / W) of their z
///   R = max(R(x),  R(|x - median of all S numbers|))
/// The second sees chains of one centre and different widths.
/// @param chains  as for effective_sample_size
/// @return +infinity where every half stands still, but not all at one place. A part whose numbers
///         are all equal does not count; NaN where neither does
/// Source: Vehtari, section 4.   Tests: SplitRHat.*
/// Hints: handouts/a5_plausible.md#hint-split-r-hat
double split_r_hat(const std::vector<VectorXd>& chains);

/// The mean of what chains have sampled, with its Monte Carlo error.
///   mean, deviation (divisor their count - 1): of all numbers of all chains, whole
///   standard_error = deviation / sqrt(effective_samples)                                   (A5.10)
/// @param chains  as for effective_sample_size
/// @return effective_samples by (A5.8);  NaN, and so the error, where it is not known. An error of
///         0 would claim too much
/// Source: Vehtari, section 3.   Tests: MonteCarloAnswer.*
/// Hints: handouts/a5_plausible.md#hint-monte-carlo-answer
Answer monte_carlo_answer(const std::vector<VectorXd>& chains);

}  // namespace tumble::a5

TUMBLE_MODULE(a5, log_prior, log_target, propose, log_proposal, log_acceptance, metropolis_step,
              autocorrelation, effective_sample_size, split_r_hat, monte_carlo_answer);

#ifndef TUMBLE_BUILDING_MODULE  // for callers
namespace tumble::a5 {

/// How many numbers each answer has: checked on what your functions return, before its use.
inline void describe(modules::AnswerSizes<Module>& sizes) {
  sizes.add(&Module::propose,
            [](const Proposal&, const VectorXd& x, const Draws&) { return x.size(); });
  sizes.add(&Module::autocorrelation,
            [](const VectorXd&, int most_lag) { return Eigen::Index{most_lag} + 1; });
}

}  // namespace tumble::a5
#endif
