// Your work for assignment 4. Replace each body; the comment above its declaration in a4_timewarp.h
// says what it must do.
#include "assignments/a4_timewarp/a4_timewarp.h"

namespace tumble::a4 {

bool comes_before(const Stamp&, const Stamp&) {
  throw NotImplemented("comes_before", "handouts/a4_timewarp.md#hint-order");
}

double next_check_time(double, double, double, double, double) {
  throw NotImplemented("next_check_time", "handouts/a4_timewarp.md#hint-check");
}

CheckDecision on_collision_check(const ScheduledEvent&, const CheckFinding&, double) {
  throw NotImplemented("on_collision_check", "handouts/a4_timewarp.md#hint-check");
}

std::vector<std::vector<std::int32_t>> contact_groups(const std::vector<std::int32_t>&,
                                                      const std::vector<GroupContact>&) {
  throw NotImplemented("contact_groups", "handouts/a4_timewarp.md#hint-groups");
}

GroupDecision on_group_check(const ScheduledEvent&, const std::vector<GroupContact>&, double) {
  throw NotImplemented("on_group_check", "handouts/a4_timewarp.md#hint-groups");
}

std::vector<Rollback> on_callback(const ScheduledEvent&, const std::vector<LocalTime>&) {
  throw NotImplemented("on_callback", "handouts/a4_timewarp.md#hint-callback");
}

std::vector<Rollback> anti_messages(const std::vector<Effect>&, const Rollback&) {
  throw NotImplemented("anti_messages", "handouts/a4_timewarp.md#hint-rollback");
}

std::vector<Rollback> plan_rollback(const std::vector<Effect>&, const std::vector<Rollback>&) {
  throw NotImplemented("plan_rollback", "handouts/a4_timewarp.md#hint-rollback");
}

ScheduledEvent after_rollback(const ScheduledEvent&, const std::vector<Rollback>&) {
  throw NotImplemented("after_rollback", "handouts/a4_timewarp.md#hint-after");
}

double global_virtual_time(const std::vector<LocalTime>&, const std::vector<ScheduledEvent>&) {
  throw NotImplemented("global_virtual_time", "handouts/a4_timewarp.md#hint-gvt");
}

bool may_commit(const Stamp&, double) {
  throw NotImplemented("may_commit", "handouts/a4_timewarp.md#hint-gvt");
}

std::uint32_t states_to_purge(const std::vector<double>&, double) {
  throw NotImplemented("states_to_purge", "handouts/a4_timewarp.md#hint-purge");
}

}  // namespace tumble::a4
