#include "assignments/a3_constraints/a3_binding.h"

namespace tumble::a3 {

// anchor_position and anchor_velocity have no law: engines compute anchors themselves.
void bind(const Module& module, Laws& laws) {
  laws.spring_force = module.spring_force;
  laws.rod_row = module.rod_row;
  laws.baumgarte_acceleration = module.baumgarte_acceleration;
  laws.constraint_multipliers = module.constraint_multipliers;
  laws.constraint_correction = module.constraint_correction;
  laws.contact_forces = module.contact_forces;
  laws.ends_in_contact = module.ends_in_contact;
}

}  // namespace tumble::a3
