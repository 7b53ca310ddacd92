// mutant: all_zeros - every function answers nothing
// caught-by: not the order of time
#include "assignments/a4_timewarp/a4_timewarp.h"

namespace tumble::a4 {

bool comes_before(const Stamp&, const Stamp&) { return false; }

double next_check_time(double, double, double, double, double) { return 0; }

CheckDecision on_collision_check(const ScheduledEvent&, const CheckFinding&, double) { return {}; }

std::vector<std::vector<std::int32_t>> contact_groups(const std::vector<std::int32_t>&,
                                                      const std::vector<GroupContact>&) {
  return {};
}

GroupDecision on_group_check(const ScheduledEvent&, const std::vector<GroupContact>&, double) {
  return {};
}

std::vector<Rollback> on_callback(const ScheduledEvent&, const std::vector<LocalTime>&) {
  return {};
}

std::vector<Rollback> anti_messages(const std::vector<Effect>&, const Rollback&) { return {}; }

std::vector<Rollback> plan_rollback(const std::vector<Effect>&, const std::vector<Rollback>&) {
  return {};
}

ScheduledEvent after_rollback(const ScheduledEvent&, const std::vector<Rollback>&) { return {}; }

double global_virtual_time(const std::vector<LocalTime>&, const std::vector<ScheduledEvent>&) {
  return 0;
}

bool may_commit(const Stamp&, double) { return false; }

std::uint32_t states_to_purge(const std::vector<double>&, double) { return 0; }

}  // namespace tumble::a4
