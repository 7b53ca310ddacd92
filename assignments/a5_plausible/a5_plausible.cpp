// Your work for assignment 5. Replace each body; the comment above its declaration in
// a5_plausible.h says what it must do.
#include "assignments/a5_plausible/a5_plausible.h"

namespace tumble::a5 {

double log_prior(const std::vector<Prior>&, const VectorXd&) {
  throw NotImplemented("log_prior", "handouts/a5_plausible.md#hint-log-prior");
}

double log_target(double, double, double) {
  throw NotImplemented("log_target", "handouts/a5_plausible.md#hint-log-target");
}

VectorXd propose(const Proposal&, const VectorXd&, const Draws&) {
  throw NotImplemented("propose", "handouts/a5_plausible.md#hint-propose");
}

double log_proposal(const Proposal&, const VectorXd&, const VectorXd&) {
  throw NotImplemented("log_proposal", "handouts/a5_plausible.md#hint-log-proposal");
}

double log_acceptance(double, double, double, double) {
  throw NotImplemented("log_acceptance", "handouts/a5_plausible.md#hint-log-acceptance");
}

ChainState metropolis_step(const LogDensity&, const Proposal&, const ChainState&, const Draws&) {
  throw NotImplemented("metropolis_step", "handouts/a5_plausible.md#hint-metropolis-step");
}

VectorXd autocorrelation(const VectorXd&, int) {
  throw NotImplemented("autocorrelation", "handouts/a5_plausible.md#hint-autocorrelation");
}

double effective_sample_size(const std::vector<VectorXd>&) {
  throw NotImplemented("effective_sample_size",
                       "handouts/a5_plausible.md#hint-effective-sample-size");
}

double split_r_hat(const std::vector<VectorXd>&) {
  throw NotImplemented("split_r_hat", "handouts/a5_plausible.md#hint-split-r-hat");
}

Answer monte_carlo_answer(const std::vector<VectorXd>&) {
  throw NotImplemented("monte_carlo_answer", "handouts/a5_plausible.md#hint-monte-carlo-answer");
}

}  // namespace tumble::a5
