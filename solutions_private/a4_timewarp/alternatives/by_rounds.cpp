// Another right solution of assignment 4: comparisons step by step, groups by spreading, rollback
// in rounds from the earliest stamp on.
#include "assignments/a4_timewarp/a4_timewarp.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <set>
#include <unordered_map>

namespace tumble::a4 {

bool comes_before(const Stamp& x, const Stamp& y) {
  if (x.time != y.time) return x.time < y.time;
  if (x.microstep != y.microstep) return x.microstep < y.microstep;
  if (x.kind != y.kind) return static_cast<int>(x.kind) < static_cast<int>(y.kind);
  if (x.body_a != y.body_a) return x.body_a < y.body_a;
  return x.body_b < y.body_b;
}

double next_check_time(double now, double gap, double v, double a, double step) {
  // The root of gap = v s + a s^2 / 2 by Vieta: the other root is never formed.
  double s = step;
  const double q = v + std::hypot(v, std::sqrt(2 * a) * std::sqrt(std::max(0.0, gap)));
  if (gap > 0) s = q > 0 ? gap / (0.5 * q) : kMostStepsAhead * step;
  return std::min(now + kMostStepsAhead * step, now + std::max(step, s));
}

CheckDecision on_collision_check(const ScheduledEvent& event, const CheckFinding& finding,
                                 double step) {
  CheckDecision decision;
  decision.next = event;
  decision.collides = finding.contact.has_value();
  if (!decision.collides) {
    decision.next.safe_time = event.stamp.time;
    decision.next.stamp.time = next_check_time(event.stamp.time, finding.gap, finding.closing_speed,
                                               finding.closing_acceleration, step);
    return decision;
  }
  for (std::size_t i = 0; i < event.receivers.size(); ++i)
    decision.rollbacks.push_back(Rollback{event.receivers[i], finding.contact.value()});
  decision.next.stamp.time = decision.next.safe_time = finding.contact->time;
  return decision;
}

std::vector<std::vector<std::int32_t>> contact_groups(const std::vector<std::int32_t>& bodies,
                                                      const std::vector<GroupContact>& contacts) {
  std::unordered_map<std::int32_t, std::vector<std::int32_t>> neighbours;
  const std::set<std::int32_t> members(bodies.begin(), bodies.end());
  for (const GroupContact& contact : contacts) {
    if (!members.contains(contact.body_a) || !members.contains(contact.body_b)) continue;
    neighbours[contact.body_a].push_back(contact.body_b);
    neighbours[contact.body_b].push_back(contact.body_a);
  }
  std::vector<std::vector<std::int32_t>> groups;
  std::set<std::int32_t> seen;
  for (const std::int32_t start : bodies) {  // ascending: a group is begun by its lowest member
    if (!seen.insert(start).second) continue;
    std::vector<std::int32_t> group{start};
    for (std::size_t i = 0; i < group.size(); ++i)
      for (const std::int32_t next : neighbours[group[i]])
        if (seen.insert(next).second) group.push_back(next);
    std::sort(group.begin(), group.end());
    groups.push_back(group);
  }
  return groups;
}

GroupDecision on_group_check(const ScheduledEvent& event, const std::vector<GroupContact>& contacts,
                             double step) {
  GroupDecision decision;
  decision.next = event;
  std::vector<GroupContact> by_opening = contacts;
  std::stable_sort(by_opening.begin(), by_opening.end(),
                   [](const GroupContact& x, const GroupContact& y) { return x.opens < y.opens; });
  if (by_opening.empty() || by_opening.front().opens > event.stamp.time) {
    decision.next.safe_time = event.stamp.time;
    decision.next.stamp.time += step;
    return decision;
  }
  const double first = by_opening.front().opens;
  std::erase_if(by_opening, [&](const GroupContact& contact) { return contact.opens == first; });
  decision.changes = true;
  decision.next.safe_time = decision.next.stamp.time = first;
  decision.groups = contact_groups(event.receivers, by_opening);
  for (const std::int32_t body : event.receivers)
    decision.rollbacks.push_back({body, decision.next.stamp});
  return decision;
}

std::vector<Rollback> on_callback(const ScheduledEvent& event,
                                  const std::vector<LocalTime>& local_times) {
  std::vector<Rollback> rollbacks;
  for (const LocalTime& local : local_times)
    if (local.time > event.stamp.time &&
        std::binary_search(event.receivers.begin(), event.receivers.end(), local.body))
      rollbacks.push_back({local.body, event.stamp});
  std::sort(rollbacks.begin(), rollbacks.end(),
            [](const Rollback& x, const Rollback& y) { return x.body < y.body; });
  return rollbacks;
}

std::vector<Rollback> anti_messages(const std::vector<Effect>& effects, const Rollback& rollback) {
  std::vector<Rollback> messages;
  for (const Effect& effect : effects) {
    const bool takes_part =
        std::count(effect.processes.begin(), effect.processes.end(), rollback.body) > 0;
    if (!takes_part || comes_before(effect.stamp, rollback.stamp)) continue;
    for (const std::int32_t body : effect.processes)
      if (body != rollback.body) messages.push_back({body, effect.stamp});
  }
  return messages;
}

// As a shortest-path search: the earliest stamp that waits is final, because messages only lead to
// later ones.
std::vector<Rollback> plan_rollback(const std::vector<Effect>& effects,
                                    const std::vector<Rollback>& first) {
  std::unordered_map<std::int32_t, std::vector<const Effect*>> of;
  for (const Effect& effect : effects)
    for (const std::int32_t body : effect.processes) of[body].push_back(&effect);
  const auto later = [](const Rollback& x, const Rollback& y) {
    return comes_before(y.stamp, x.stamp);
  };
  std::priority_queue<Rollback, std::vector<Rollback>, decltype(later)> waiting(later);
  for (const Rollback& rollback : first) waiting.push(rollback);
  std::unordered_map<std::int32_t, Stamp> final;
  while (!waiting.empty()) {
    const Rollback now = waiting.top();
    waiting.pop();
    if (!final.emplace(now.body, now.stamp).second) continue;
    for (const Effect* effect : of[now.body]) {
      if (comes_before(effect->stamp, now.stamp)) continue;
      for (const std::int32_t body : effect->processes) waiting.push({body, effect->stamp});
    }
  }
  std::vector<Rollback> plan;
  for (const auto& [body, stamp] : final) plan.push_back({body, stamp});
  std::sort(plan.begin(), plan.end(),
            [](const Rollback& x, const Rollback& y) { return x.body < y.body; });
  return plan;
}

ScheduledEvent after_rollback(const ScheduledEvent& event, const std::vector<Rollback>& rollbacks) {
  if (event.stamp.kind != WorkKind::kCollision && event.stamp.kind != WorkKind::kGroup)
    return event;
  ScheduledEvent moved = event;
  for (const Rollback& rollback : rollbacks) {
    if (std::find(event.receivers.begin(), event.receivers.end(), rollback.body) ==
        event.receivers.end())
      continue;
    if (rollback.stamp.time < moved.safe_time)
      moved.safe_time = moved.stamp.time = rollback.stamp.time;
  }
  return moved;
}

double global_virtual_time(const std::vector<LocalTime>& local_times,
                           const std::vector<ScheduledEvent>& events) {
  std::vector<double> times{std::numeric_limits<double>::infinity()};
  for (const LocalTime& local : local_times) times.push_back(local.time);
  for (const ScheduledEvent& event : events) times.push_back(event.safe_time);
  return *std::min_element(times.begin(), times.end());
}

bool may_commit(const Stamp& stamp, double global_virtual_time) {
  return global_virtual_time > stamp.time;
}

std::uint32_t states_to_purge(const std::vector<double>& state_times, double global_virtual_time) {
  std::uint32_t purged = 0;
  while (purged + 1 < state_times.size() && state_times[purged + 1] < global_virtual_time) ++purged;
  return purged;
}

}  // namespace tumble::a4
