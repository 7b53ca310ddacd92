#include "assignments/a4_timewarp/a4_binding.h"

#include "framework/cost/showcase.h"
#include "framework/live/showcase.h"

namespace tumble::a4 {

void bind(const Module& module, Laws& laws) {
  laws.scheduling = {module.comes_before,        module.next_check_time, module.on_collision_check,
                     module.contact_groups,      module.on_group_check,  module.on_callback,
                     module.anti_messages,       module.plan_rollback,   module.after_rollback,
                     module.global_virtual_time, module.may_commit,      module.states_to_purge};
}

void register_module(modules::Registry& registry) {
  registry.add<Module>(bind);
  registry.set_note(Module::kId, cost::CostShowcase{"billiards", 6.0, true, "gas"});
  registry.set_note(Module::kId, live::Showcase{"billiards"});
  registry.mark_scheduler(Module::kId);
}

}  // namespace tumble::a4
