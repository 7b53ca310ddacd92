#include "framework/modules/bind_laws.h"

namespace tumble::modules {

void bind_laws(const ModuleKind& kind, const AnyModule& module, const std::string& source,
               Laws& laws) {
  kind.bind(module, laws);
  Laws alone;  // has only the laws that this module implements
  kind.bind(module, alone);
  laws.take_listed(alone, source);
  if (alone.collision_impulse) laws.impulse_source = source;
  if (alone.integrate_step) laws.integrator_source = source;
  if (alone.constraint_multipliers) {
    laws.constraint_source = source;
    laws.link_solver.clear();
  }
  if (alone.contact_forces) laws.contact_solver.clear();
  if (alone.scheduling) laws.scheduling_source = source;
}

void set_library_motion(Laws& laws) {
  const Laws library = library_laws();
  laws.integrate_step = library.integrate_step;
  laws.state_derivative = library.state_derivative;
  laws.renormalize = library.renormalize;
  laws.find_impact_time = library.find_impact_time;
  laws.integrator_source = library.integrator_source;
  laws.step_function = library.step_function;
  laws.derivative_function = library.derivative_function;
  laws.impact_time_function = library.impact_time_function;
  laws.scheduling = {};
  laws.scheduling_source = Laws().scheduling_source;
}

}  // namespace tumble::modules
