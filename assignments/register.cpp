// Every assignment, a line each.
#include "assignments/a1_impulse/a1_binding.h"
#include "assignments/a2_integration/a2_binding.h"
#include "framework/modules/registry.h"

namespace tumble {

void register_assignments(modules::Registry& registry) {
  registry.add<a1::Module>("a1_impulse", "Impulse", a1::bind);
  registry.add<a2::Module>("a2_integration", "Integration", a2::bind);
}

}  // namespace tumble
