// Every assignment (names.cpp), a line each.
#include "assignments/a1_impulse/a1_binding.h"
#include "assignments/a1_impulse/a1_truths.h"
#include "assignments/a2_integration/a2_binding.h"
#include "assignments/a2_integration/a2_truths.h"
#include "assignments/a3_constraints/a3_binding.h"
#include "assignments/a4_timewarp/a4_binding.h"
#include "framework/engines/cost/showcase.h"
#include "framework/modules/registry.h"

namespace tumble {

void register_assignments(modules::Registry& registry) {
  registry.add<a1::Module>(a1::bind);
  registry.add<a2::Module>(a2::bind);
  registry.add<a3::Module>(a3::bind);
  registry.add<a4::Module>(a4::bind);
  registry.mark_scheduler("a4");
  registry.add_method("euler_step", 1, &a2::Module::euler_step);
  registry.add_method("rk4_step", 4, &a2::Module::rk4_step);
  registry.set_note("a1", engines::CostShowcase{"collide_off_centre_e05", 2.0, true});
  registry.set_note("a2", engines::CostShowcase{"t_handle", 1.0, true});
  registry.set_note("a3", engines::CostShowcase{"double_pendulum", 1.0, true});
  registry.set_note("a4", engines::CostShowcase{"billiards", 6.0, true, "gas"});
  a1::register_truths(registry);
  a2::register_truths(registry);
}

}  // namespace tumble
