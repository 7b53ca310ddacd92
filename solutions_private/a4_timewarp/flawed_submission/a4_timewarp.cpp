// A submission as they come in: some of it right, some of it wrong, some of it not begun.
#include "assignments/a4_timewarp/a4_timewarp.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <tuple>

namespace tumble::a4 {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

bool contains(const std::vector<std::int32_t>& bodies, std::int32_t body) {
  return std::find(bodies.begin(), bodies.end(), body) != bodies.end();
}

/// Every receiver back to one stamp.
std::vector<Rollback> all_back(const std::vector<std::int32_t>& bodies, const Stamp& stamp) {
  std::vector<Rollback> rollbacks;
  for (const std::int32_t body : bodies) rollbacks.push_back({body, stamp});
  return rollbacks;
}

ScheduledEvent with_times(ScheduledEvent event, double safe_time, double time) {
  event.safe_time = safe_time;
  event.stamp.time = time;
  return event;
}

}  // namespace

bool comes_before(const Stamp& x, const Stamp& y) {
  return std::tie(x.time, x.kind, x.body_a, x.body_b) <
         std::tie(y.time, y.kind, y.body_a, y.body_b);
}

double next_check_time(double now, double gap, double closing_speed, double closing_acceleration,
                       double step) {
  if (!(gap > 0)) return now + step;
  // This form of the quadratic's root neither cancels nor minds a = 0; 0 in the denominator is
  // "never".
  const double& v = closing_speed;
  const double& a = closing_acceleration;
  return now +
         std::clamp(2 * gap / (v + std::sqrt(v * v + 2 * a * gap)), step, kMostStepsAhead * step);
}

CheckDecision on_collision_check(const ScheduledEvent& event, const CheckFinding& finding,
                                 double step) {
  if (finding.contact) {
    const double tc = finding.contact->time;
    return {true, all_back(event.receivers, *finding.contact), with_times(event, tc, tc)};
  }
  const double t = event.stamp.time;
  return {false,
          {},
          with_times(event, t,
                     next_check_time(t, finding.gap, finding.closing_speed,
                                     finding.closing_acceleration, step))};
}

std::vector<std::vector<std::int32_t>> contact_groups(const std::vector<std::int32_t>& bodies,
                                                      const std::vector<GroupContact>& contacts) {
  // Union of sets; the lowest place of a set stands for it.
  std::vector<std::size_t> root(bodies.size());
  std::iota(root.begin(), root.end(), std::size_t{0});
  const auto find = [&](std::size_t i) {
    while (root[i] != i) i = root[i] = root[root[i]];
    return i;
  };
  const auto place = [&](std::int32_t body) {
    return static_cast<std::size_t>(std::find(bodies.begin(), bodies.end(), body) - bodies.begin());
  };
  for (const GroupContact& contact : contacts) {
    const std::size_t a = place(contact.body_a), b = place(contact.body_b);
    if (a == bodies.size() || b == bodies.size()) continue;  // a wall
    const std::size_t x = find(a), y = find(b);
    root[std::max(x, y)] = std::min(x, y);
  }
  std::map<std::size_t, std::vector<std::int32_t>> members;  // by the lowest
  for (std::size_t i = 0; i < bodies.size(); ++i) members[find(i)].push_back(bodies[i]);
  std::vector<std::vector<std::int32_t>> groups;
  for (auto& [lowest, group] : members) groups.push_back(std::move(group));
  return groups;
}

GroupDecision on_group_check(const ScheduledEvent&, const std::vector<GroupContact>&, double) {
  throw NotImplemented("on_group_check", "handouts/a4_timewarp.md#hint-groups");
}

std::vector<Rollback> on_callback(const ScheduledEvent&, const std::vector<LocalTime>&) {
  throw NotImplemented("on_callback", "handouts/a4_timewarp.md#hint-callback");
}

std::vector<Rollback> anti_messages(const std::vector<Effect>& effects, const Rollback& rollback) {
  std::vector<Rollback> messages;
  for (const Effect& effect : effects) {
    if (comes_before(effect.stamp, rollback.stamp) || !contains(effect.processes, rollback.body))
      continue;
    for (const std::int32_t other : effect.processes)
      if (other != rollback.body) messages.push_back({other, effect.stamp});
  }
  return messages;
}

std::vector<Rollback> plan_rollback(const std::vector<Effect>& effects,
                                    const std::vector<Rollback>& first) {
  std::vector<Rollback> plan = first;
  for (const Rollback& rollback : first)
    for (const Rollback& message : anti_messages(effects, rollback)) plan.push_back(message);
  std::sort(plan.begin(), plan.end(),
            [](const Rollback& x, const Rollback& y) { return x.body < y.body; });
  return plan;
}

ScheduledEvent after_rollback(const ScheduledEvent& event, const std::vector<Rollback>& rollbacks) {
  const bool is_check =
      event.stamp.kind == WorkKind::kCollision || event.stamp.kind == WorkKind::kGroup;
  double r = kInfinity;
  for (const Rollback& rollback : rollbacks)
    if (contains(event.receivers, rollback.body)) r = std::min(r, rollback.stamp.time);
  return is_check && r < event.safe_time ? with_times(event, r, r) : event;
}

double global_virtual_time(const std::vector<LocalTime>& local_times,
                           const std::vector<ScheduledEvent>& events) {
  double least = kInfinity;
  for (const LocalTime& local : local_times) least = std::min(least, local.time);
  // The safe times are later than the local times anyway.
  static_cast<void>(events);
  return least;
}

bool may_commit(const Stamp& stamp, double global_virtual_time) {
  return stamp.time <= global_virtual_time;
}

std::uint32_t states_to_purge(const std::vector<double>& state_times, double global_virtual_time) {
  const auto first_at_gvt =
      std::lower_bound(state_times.begin(), state_times.end(), global_virtual_time);
  const auto earlier = first_at_gvt - state_times.begin();
  return static_cast<std::uint32_t>(std::max<std::ptrdiff_t>(0, earlier - 1));
}

}  // namespace tumble::a4
