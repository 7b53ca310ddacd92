#include "assignments/a2_integration/a2_binding.h"

namespace tumble::a2 {

void bind(const Module& module, Laws& laws) {
  laws.integrate_step = module.rk4_step;
  laws.state_derivative = module.rigid_body_derivative;
  laws.renormalize = module.renormalize;
  laws.find_impact_time = module.impact_time_newton;
}

}  // namespace tumble::a2
