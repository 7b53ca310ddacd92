#include "assignments/a4_timewarp/a4_binding.h"

namespace tumble::a4 {

void bind(const Module& module, Laws& laws) {
  laws.scheduling = {module.comes_before,        module.next_check_time, module.on_collision_check,
                     module.contact_groups,      module.on_group_check,  module.on_callback,
                     module.anti_messages,       module.plan_rollback,   module.after_rollback,
                     module.global_virtual_time, module.may_commit,      module.states_to_purge};
}

}  // namespace tumble::a4
