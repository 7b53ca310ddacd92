#include "assignments/a5_plausible/a5_binding.h"

#include "framework/cost/showcase.h"
#include "framework/live/showcase.h"
#include "framework/sampling/sampler.h"

namespace tumble::a5 {
namespace {

Sampling functions_of(const Module& module) {
  return {module.log_prior,       module.log_target,
          module.propose,         module.log_proposal,
          module.log_acceptance,  module.metropolis_step,
          module.autocorrelation, module.effective_sample_size,
          module.split_r_hat,     module.monte_carlo_answer};
}

}  // namespace

// The module provides no law of a world: it chooses among worlds.
void bind(const Module&, Laws&) {}

void register_module(modules::Registry& registry) {
  registry.add<Module>(bind);
  registry.set_note(Module::kId, live::Showcase{"ball_into_bin"});
  registry.set_note(Module::kId, cost::CostShowcase{"ball_into_bin"});
  registry.set_note(Module::kId, sampling::Sampler{[](const modules::AnyModule& module) {
                      return functions_of(*static_cast<const Module*>(module.get()));
                    }});
}

}  // namespace tumble::a5
