/// What chains say of the worlds that do what is asked, and how far it can be trusted.
#pragma once

#include <string>
#include <vector>

#include "framework/sampling/chains.h"

namespace tumble::sampling {

/// The mean of one number among the worlds that do what is asked, with its Monte Carlo error: a
/// ratio of two means of the chains, whose error is that of its linear part.
struct Estimate {
  std::string name;
  Answer answer;          // of the number; effective_samples of the linear part
  double r_hat = kUnset;  // of all samples of the number
};

struct Answers {
  int samples = 0;                  // of all chains
  int done = 0;                     // of them, worlds that do what is asked
  Answer share;                     // done / samples, of what the chains sample
  double acceptance = kUnset;       // of proposals
  double worst_r_hat = kUnset;      // of all numbers
  double least_effective = kUnset;  // of all estimates
  double cpu_s = kUnset;            // of all chains
  int simulations = 0, broken = 0;
  std::vector<Estimate> estimates;  // by number
};

/// @param by       the functions of a5 that judge the chains
/// @param samples  of each chain, the first so many; at least 8
/// @pre all chains have at least so many samples
Answers answers_of(const Sampling& by, const std::vector<std::string>& names,
                   const std::vector<Chain>& chains, int samples);

/// Why the answers of chains are not to be trusted yet, a sentence each; empty where nothing speaks
/// against them. Looked at are the worlds found, R-hat, effective samples, and runs that broke.
/// Source: Vehtari et al. 2021, section 4 (an R-hat of 1.01, 50 effective samples of half a chain).
std::vector<std::string> doubts(const Answers& answers, std::size_t chains);
/// Whether they are answers at all, however rough: worlds were found, R-hat is known and at most
/// 1.1, and few runs broke.
bool can_be_used(const Answers& answers);

/// Error against CPU time: the answers of ever longer beginnings of the chains.
std::vector<Answers> growing_answers(const Sampling& by, const std::vector<std::string>& names,
                                     const std::vector<Chain>& chains);

/// The chains cut into so many of equal length: for samples that are independent, so that R-hat has
/// something to compare.
std::vector<Chain> cut(const Chain& chain, int parts);

}  // namespace tumble::sampling
