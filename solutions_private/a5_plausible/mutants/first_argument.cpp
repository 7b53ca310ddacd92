// mutant: first_argument - every function returns its first argument
// caught-by: no number counts
#include "assignments/a5_plausible/a5_plausible.h"

namespace tumble::a5 {

// Nothing here is computed: what the tests still give for it is what they give for nothing.
double log_prior(const std::vector<Prior>&, const VectorXd&) { return 0.0; }
double log_target(double first, double, double) { return first; }
VectorXd propose(const Proposal&, const VectorXd& x, const Draws&) { return x; }
double log_proposal(const Proposal&, const VectorXd&, const VectorXd&) { return 0.0; }
double log_acceptance(double first, double, double, double) { return first; }
ChainState metropolis_step(const LogDensity&, const Proposal&, const ChainState& state,
                           const Draws&) {
  return state;
}
VectorXd autocorrelation(const VectorXd& chain, int most_lag) { return chain.head(most_lag + 1); }
double effective_sample_size(const std::vector<VectorXd>& chains) { return chains[0][0]; }
double split_r_hat(const std::vector<VectorXd>& chains) { return chains[0][0]; }
Answer monte_carlo_answer(const std::vector<VectorXd>&) { return {0.0, 0.0, 0.0, 0.0}; }

}  // namespace tumble::a5
