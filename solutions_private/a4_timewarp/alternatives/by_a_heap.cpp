// A right solution by a heap and by sorting: rollbacks are taken in the order of their stamps, so
// that each body is settled when it is taken first; groups by relabelling; keys of events as
// sortable arrays.
#include "assignments/a4_timewarp/a4_timewarp.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <queue>

namespace tumble::a4 {
namespace {

std::array<double, 5> key(const Stamp& stamp) {
  return {stamp.time, static_cast<double>(stamp.microstep), static_cast<double>(stamp.kind),
          static_cast<double>(stamp.body_a), static_cast<double>(stamp.body_b)};
}

bool is_among(std::int32_t body, const std::vector<std::int32_t>& list) {
  for (const std::int32_t one : list)
    if (one == body) return true;
  return false;
}

ScheduledEvent moved(const ScheduledEvent& event, double safe, double due) {
  ScheduledEvent copy = event;
  copy.safe_time = safe;
  copy.stamp.time = due;
  return copy;
}

}  // namespace

bool comes_before(const Stamp& x, const Stamp& y) { return key(x) < key(y); }

double next_check_time(double now, double gap, double closing_speed, double closing_acceleration,
                       double step) {
  if (gap == 0) return now + step;
  // With gap = v s + a s^2 / 2, divided by s: the root that does not cancel. Nothing that moves
  // leaves infinity.
  const double denominator =
      closing_speed + std::sqrt(closing_speed * closing_speed + 2.0 * closing_acceleration * gap);
  const double s =
      denominator > 0 ? gap / (0.5 * denominator) : std::numeric_limits<double>::infinity();
  return now + std::min(kMostStepsAhead * step, std::max(step, s));
}

CheckDecision on_collision_check(const ScheduledEvent& event, const CheckFinding& finding,
                                 double step) {
  if (!finding.contact.has_value()) {
    const double t = event.stamp.time;
    return CheckDecision{false,
                         {},
                         moved(event, t,
                               next_check_time(t, finding.gap, finding.closing_speed,
                                               finding.closing_acceleration, step))};
  }
  std::vector<Rollback> back(event.receivers.size());
  std::transform(event.receivers.begin(), event.receivers.end(), back.begin(),
                 [&](std::int32_t body) {
                   return Rollback{body, finding.contact.value()};
                 });
  return CheckDecision{true, back, moved(event, finding.contact->time, finding.contact->time)};
}

std::vector<std::vector<std::int32_t>> contact_groups(const std::vector<std::int32_t>& bodies,
                                                      const std::vector<GroupContact>& contacts) {
  std::map<std::int32_t, std::int32_t> label;  // the lowest body known to hang together with it
  for (const std::int32_t body : bodies) label[body] = body;
  for (const GroupContact& contact : contacts) {
    const auto a = label.find(contact.body_a), b = label.find(contact.body_b);
    if (a == label.end() || b == label.end()) continue;
    const std::int32_t low = std::min(a->second, b->second), high = std::max(a->second, b->second);
    for (auto& [body, mark] : label)
      if (mark == high) mark = low;
  }
  std::map<std::int32_t, std::vector<std::int32_t>> by_label;
  for (const auto& [body, mark] : label) by_label[mark].push_back(body);
  std::vector<std::vector<std::int32_t>> groups;
  for (const auto& [mark, group] : by_label) groups.push_back(group);
  return groups;
}

GroupDecision on_group_check(const ScheduledEvent& event, const std::vector<GroupContact>& contacts,
                             double step) {
  std::vector<GroupContact> sorted = contacts;
  std::sort(sorted.begin(), sorted.end(),
            [](const GroupContact& x, const GroupContact& y) { return x.opens < y.opens; });
  if (sorted.empty() || sorted.front().opens > event.stamp.time)
    return GroupDecision{false, {}, {}, moved(event, event.stamp.time, event.stamp.time + step)};
  const double tc = sorted.front().opens;
  sorted.erase(sorted.begin(), std::upper_bound(sorted.begin(), sorted.end(), tc,
                                                [](double time, const GroupContact& contact) {
                                                  return time < contact.opens;
                                                }));
  const ScheduledEvent next = moved(event, tc, tc);
  std::vector<Rollback> back;
  for (const std::int32_t body : event.receivers) back.push_back({body, next.stamp});
  return GroupDecision{true, contact_groups(event.receivers, sorted), back, next};
}

std::vector<Rollback> on_callback(const ScheduledEvent& event,
                                  const std::vector<LocalTime>& local_times) {
  std::vector<Rollback> back;
  for (const LocalTime& local : local_times)
    if (is_among(local.body, event.receivers) && local.time > event.stamp.time)
      back.push_back({local.body, event.stamp});
  std::sort(back.begin(), back.end(),
            [](const Rollback& x, const Rollback& y) { return x.body < y.body; });
  return back;
}

std::vector<Rollback> anti_messages(const std::vector<Effect>& effects, const Rollback& rollback) {
  std::vector<Rollback> messages;
  for (const Effect& effect : effects) {
    const bool is_its_own = is_among(rollback.body, effect.processes),
               is_undone = !comes_before(effect.stamp, rollback.stamp);
    for (std::size_t i = 0; is_its_own && is_undone && i < effect.processes.size(); ++i)
      if (effect.processes[i] != rollback.body)
        messages.push_back({effect.processes[i], effect.stamp});
  }
  return messages;
}

std::vector<Rollback> plan_rollback(const std::vector<Effect>& effects,
                                    const std::vector<Rollback>& first) {
  // Effects of a body by stamp, the earliest first.
  std::map<std::int32_t, std::vector<Effect>> effects_of;
  for (const Effect& effect : effects)
    for (const std::int32_t body : effect.processes) effects_of[body].push_back(effect);

  // A message is never earlier than the rollback that sends it, so the earliest that waits is final
  // for its body.
  const auto later = [](const Rollback& x, const Rollback& y) {
    return comes_before(y.stamp, x.stamp);
  };
  std::priority_queue<Rollback, std::vector<Rollback>, decltype(later)> waiting(later, first);
  std::map<std::int32_t, Stamp> settled;
  while (!waiting.empty()) {
    const Rollback now = waiting.top();
    waiting.pop();
    if (!settled.insert({now.body, now.stamp}).second) continue;
    for (const Rollback& message : anti_messages(effects_of[now.body], now))
      if (settled.find(message.body) == settled.end()) waiting.push(message);
  }
  std::vector<Rollback> plan;
  for (const auto& [body, stamp] : settled) plan.push_back({body, stamp});
  return plan;
}

ScheduledEvent after_rollback(const ScheduledEvent& event, const std::vector<Rollback>& rollbacks) {
  if (event.stamp.kind == WorkKind::kCallback || event.stamp.kind == WorkKind::kRedraw)
    return event;
  std::vector<double> times;
  for (const Rollback& rollback : rollbacks)
    if (is_among(rollback.body, event.receivers)) times.push_back(rollback.stamp.time);
  if (times.empty()) return event;
  std::sort(times.begin(), times.end());
  return times.front() < event.safe_time ? moved(event, times.front(), times.front()) : event;
}

double global_virtual_time(const std::vector<LocalTime>& local_times,
                           const std::vector<ScheduledEvent>& events) {
  std::priority_queue<double, std::vector<double>, std::greater<double>> times;
  for (const LocalTime& local : local_times) times.push(local.time);
  for (const ScheduledEvent& event : events) times.push(event.safe_time);
  return times.empty() ? std::numeric_limits<double>::infinity() : times.top();
}

bool may_commit(const Stamp& stamp, double global_virtual_time) {
  return stamp.time < global_virtual_time;
}

std::uint32_t states_to_purge(const std::vector<double>& state_times, double global_virtual_time) {
  std::uint32_t keep_from = 0;
  while (keep_from + 1 < state_times.size() && state_times[keep_from + 1] < global_virtual_time)
    ++keep_from;
  return keep_from;
}

}  // namespace tumble::a4
