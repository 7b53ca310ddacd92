// A right solution by recursion: groups by walking from body to body, rollback by each body calling
// those it had dealt with; the order by a three-way comparison, times by minima over lists of
// numbers.
#include "assignments/a4_timewarp/a4_timewarp.h"

#include <algorithm>
#include <cmath>
#include <compare>
#include <functional>
#include <set>
#include <unordered_map>

namespace tumble::a4 {
namespace {

using Body = std::int32_t;
constexpr double kNever = std::numeric_limits<double>::infinity();

/// -1, 0, 1 as x is before, at or after y.
int compare(const Stamp& x, const Stamp& y) {
  const auto sign = [](auto p, auto q) { return p < q ? -1 : p > q ? 1 : 0; };
  if (const int by_time = sign(x.time, y.time)) return by_time;
  if (const int by_generation = sign(x.microstep, y.microstep)) return by_generation;
  if (const int by_kind = sign(static_cast<int>(x.kind), static_cast<int>(y.kind))) return by_kind;
  if (const int by_a = sign(x.body_a, y.body_a)) return by_a;
  return sign(x.body_b, y.body_b);
}

}  // namespace

bool comes_before(const Stamp& x, const Stamp& y) { return compare(x, y) < 0; }

double next_check_time(double now, double gap, double closing_speed, double closing_acceleration,
                       double step) {
  const double latest = now + kMostStepsAhead * step;
  if (gap <= 0) return now + step;
  if (closing_speed == 0 && closing_acceleration == 0) return latest;
  const double root = std::sqrt(closing_speed * closing_speed + 2 * closing_acceleration * gap);
  const double s = 2 * gap / (root + closing_speed);
  if (s <= step) return now + step;
  return s >= kMostStepsAhead * step ? latest : now + s;
}

CheckDecision on_collision_check(const ScheduledEvent& event, const CheckFinding& finding,
                                 double step) {
  CheckDecision decision;
  decision.next = event;
  decision.collides = finding.contact.has_value();
  if (decision.collides) {
    const Stamp stamp = *finding.contact;
    for (const Body body : event.receivers) decision.rollbacks.push_back(Rollback{body, stamp});
    decision.next.safe_time = decision.next.stamp.time = stamp.time;
    return decision;
  }
  decision.next.safe_time = event.stamp.time;
  decision.next.stamp.time = next_check_time(event.stamp.time, finding.gap, finding.closing_speed,
                                             finding.closing_acceleration, step);
  return decision;
}

std::vector<std::vector<Body>> contact_groups(const std::vector<Body>& bodies,
                                              const std::vector<GroupContact>& contacts) {
  std::unordered_map<Body, std::vector<Body>> neighbours;
  for (const Body body : bodies) neighbours[body];
  for (const GroupContact& contact : contacts) {
    if (neighbours.count(contact.body_a) == 0 || neighbours.count(contact.body_b) == 0) continue;
    neighbours[contact.body_a].push_back(contact.body_b);
    neighbours[contact.body_b].push_back(contact.body_a);
  }
  std::set<Body> seen;
  const std::function<void(Body, std::vector<Body>&)> walk = [&](Body body,
                                                                 std::vector<Body>& group) {
    if (!seen.insert(body).second) return;
    group.push_back(body);
    for (const Body next : neighbours[body]) walk(next, group);
  };
  std::vector<std::vector<Body>> groups;
  for (const Body body : bodies) {
    std::vector<Body> group;
    walk(body, group);
    if (group.empty()) continue;
    std::sort(group.begin(), group.end());
    groups.push_back(group);
  }
  return groups;
}

GroupDecision on_group_check(const ScheduledEvent& event, const std::vector<GroupContact>& contacts,
                             double step) {
  GroupDecision decision;
  decision.next = event;
  std::vector<double> openings;
  for (const GroupContact& contact : contacts)
    if (contact.opens <= event.stamp.time) openings.push_back(contact.opens);
  if (openings.empty()) {
    decision.next.safe_time = event.stamp.time;
    decision.next.stamp.time += step;
    return decision;
  }
  const double first = *std::min_element(openings.begin(), openings.end());
  std::vector<GroupContact> closed = contacts;
  std::erase_if(closed, [&](const GroupContact& contact) { return contact.opens <= first; });
  decision.changes = true;
  decision.groups = contact_groups(event.receivers, closed);
  decision.next.safe_time = decision.next.stamp.time = first;
  for (const Body body : event.receivers) decision.rollbacks.push_back({body, decision.next.stamp});
  return decision;
}

std::vector<Rollback> on_callback(const ScheduledEvent& event,
                                  const std::vector<LocalTime>& local_times) {
  std::set<Body> late;
  for (const LocalTime& local : local_times)
    if (local.time > event.stamp.time &&
        std::count(event.receivers.begin(), event.receivers.end(), local.body) > 0)
      late.insert(local.body);
  std::vector<Rollback> rollbacks;
  for (const Body body : late) rollbacks.push_back({body, event.stamp});
  return rollbacks;
}

std::vector<Rollback> anti_messages(const std::vector<Effect>& effects, const Rollback& rollback) {
  std::vector<Rollback> messages;
  for (const auto& [stamp, processes] : effects)
    if (compare(stamp, rollback.stamp) >= 0 &&
        std::find(processes.begin(), processes.end(), rollback.body) != processes.end())
      for (const Body other : processes)
        if (other != rollback.body) messages.push_back({other, stamp});
  return messages;
}

std::vector<Rollback> plan_rollback(const std::vector<Effect>& effects,
                                    const std::vector<Rollback>& first) {
  std::unordered_map<Body, std::vector<const Effect*>> of;
  for (const Effect& effect : effects)
    for (const Body body : effect.processes) of[body].push_back(&effect);
  std::unordered_map<Body, Stamp> deepest;
  const std::function<void(Body, const Stamp&)> send_back = [&](Body body, const Stamp& stamp) {
    const auto known = deepest.find(body);
    if (known != deepest.end() && compare(known->second, stamp) <= 0) return;
    deepest[body] = stamp;
    for (const Effect* effect : of[body])
      if (compare(effect->stamp, stamp) >= 0)
        for (const Body other : effect->processes)
          if (other != body) send_back(other, effect->stamp);
  };
  for (const Rollback& rollback : first) send_back(rollback.body, rollback.stamp);
  std::vector<Rollback> plan;
  for (const auto& [body, stamp] : deepest) plan.push_back({body, stamp});
  std::sort(plan.begin(), plan.end(),
            [](const Rollback& x, const Rollback& y) { return x.body < y.body; });
  return plan;
}

ScheduledEvent after_rollback(const ScheduledEvent& event, const std::vector<Rollback>& rollbacks) {
  ScheduledEvent after = event;
  if (event.stamp.kind != WorkKind::kCollision && event.stamp.kind != WorkKind::kGroup)
    return after;
  for (const Rollback& rollback : rollbacks)
    if (std::binary_search(event.receivers.begin(), event.receivers.end(), rollback.body) &&
        rollback.stamp.time < after.safe_time)
      after.safe_time = after.stamp.time = rollback.stamp.time;
  return after;
}

double global_virtual_time(const std::vector<LocalTime>& local_times,
                           const std::vector<ScheduledEvent>& events) {
  std::vector<double> times{kNever};
  for (const LocalTime& local : local_times) times.push_back(local.time);
  for (const ScheduledEvent& event : events) times.push_back(event.safe_time);
  return *std::min_element(times.begin(), times.end());
}

bool may_commit(const Stamp& stamp, double global_virtual_time) {
  return !(stamp.time >= global_virtual_time);
}

std::uint32_t states_to_purge(const std::vector<double>& state_times, double global_virtual_time) {
  std::uint32_t earlier = 0;
  for (const double time : state_times) earlier += time < global_virtual_time ? 1 : 0;
  return earlier > 0 ? earlier - 1 : 0;
}

}  // namespace tumble::a4
