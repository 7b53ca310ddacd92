#include "assignments/a3_constraints/a3_binding.h"

#include "framework/effects/rod/rod.h"
#include "framework/cost/showcase.h"
#include "framework/live/showcase.h"

namespace tumble::a3 {

// anchor_position and anchor_velocity have no law: engines compute anchors themselves.
void bind(const Module& module, Laws& laws) {
  laws.spring_force = module.spring_force;
  laws.set<effects::RodRow>(module.rod_row);
  laws.baumgarte_acceleration = module.baumgarte_acceleration;
  laws.constraint_multipliers = module.constraint_multipliers;
  laws.constraint_correction = module.constraint_correction;
  laws.contact_forces = module.contact_forces;
  laws.ends_in_contact = module.ends_in_contact;
}

void register_module(modules::Registry& registry) {
  registry.add<Module>(bind);
  registry.set_note(Module::kId, cost::CostShowcase{"double_pendulum", 1.0, true});
  registry.set_note(Module::kId, live::Showcase{"drop_a_box"});
}

}  // namespace tumble::a3
