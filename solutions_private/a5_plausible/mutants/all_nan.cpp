// mutant: all_nan - every function returns NaN
// caught-by: gives no number
#include "assignments/a5_plausible/a5_plausible.h"

namespace tumble::a5 {

// Nothing here is computed: what the tests still give for it is what they give for nothing.
double log_prior(const std::vector<Prior>&, const VectorXd&) { return kUnset; }
double log_target(double, double, double) { return kUnset; }
VectorXd propose(const Proposal&, const VectorXd& x, const Draws&) {
  return VectorXd::Constant(x.size(), kUnset);
}
double log_proposal(const Proposal&, const VectorXd&, const VectorXd&) { return kUnset; }
double log_acceptance(double, double, double, double) { return kUnset; }
ChainState metropolis_step(const LogDensity&, const Proposal&, const ChainState& state,
                           const Draws&) {
  return {VectorXd::Constant(state.x.size(), kUnset), kUnset, false};
}
VectorXd autocorrelation(const VectorXd&, int most_lag) {
  return VectorXd::Constant(most_lag + 1, kUnset);
}
double effective_sample_size(const std::vector<VectorXd>&) { return kUnset; }
double split_r_hat(const std::vector<VectorXd>&) { return kUnset; }
Answer monte_carlo_answer(const std::vector<VectorXd>&) { return {kUnset, kUnset, kUnset, kUnset}; }

}  // namespace tumble::a5
