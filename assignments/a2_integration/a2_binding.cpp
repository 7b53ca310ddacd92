#include "assignments/a2_integration/a2_binding.h"

#include "assignments/a2_integration/a2_truths.h"
#include "framework/cost/showcase.h"
#include "framework/live/showcase.h"

namespace tumble::a2 {

void bind(const Module& module, Laws& laws) {
  laws.integrate_step = module.rk4_step;
  laws.state_derivative = module.rigid_body_derivative;
  laws.renormalize = module.renormalize;
  laws.find_impact_time = module.impact_time_newton;
  laws.step_function = "rk4_step";
  laws.derivative_function = "rigid_body_derivative";
  laws.impact_time_function = "impact_time_newton";
}

void register_module(modules::Registry& registry) {
  registry.add<Module>(bind);
  registry.set_note(Module::kId, cost::CostShowcase{"t_handle", 1.0, true});
  registry.set_note(Module::kId, live::Showcase{"t_handle"});
  registry.add_method("euler_step", 1, &Module::euler_step);
  registry.add_method("rk4_step", 4, &Module::rk4_step);
  register_truths(registry);
}

}  // namespace tumble::a2
