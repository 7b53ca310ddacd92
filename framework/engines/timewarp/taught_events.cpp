// Execution of events: redraws, checks, impacts, ends of segments, callbacks, and the rollbacks
// that they lead to. Part of TaughtTimewarp.
#include "framework/engines/timewarp/taught_run.h"

#include <algorithm>

#include "framework/core/numbers.h"
#include "framework/engines/timewarp/taught_groups.h"

namespace tumble::engines {

void TaughtTimewarp::execute(int id) {
  const ScheduledEvent event = queue_.event(id);
  if (event.stamp.kind == WorkKind::kRedraw) {
    for (const int body : run_.world().movers()) motion_.integrate(body, event.stamp.time);
    return redraw(id);
  }
  for (const int body : event.receivers) motion_.integrate(body, event.stamp.time);
  if (event.stamp.kind == WorkKind::kCallback) return call(id);
  if (event.stamp.kind == WorkKind::kGroup) return check_group(id);
  check(id);
}

// Positions are copied when the frame is committed; here every process has reached its time.
void TaughtTimewarp::redraw(int id) {
  const double t = queue_.event(id).stamp.time;
  commits_.draw_until(t);
  queue_.remove(id);
  redraws_.take();
  if (t < run_.duration())
    queue_.add({{redraws_.next(), kLastMicrostep, WorkKind::kRedraw, -1, -1}, kInfinity, {}});
}

// ---- A collision check -------------------------------------------------------------------------

void TaughtTimewarp::check(int id) {
  ScheduledEvent event = queue_.event(id);
  const int a = event.stamp.body_a, b = event.stamp.body_b;
  // stops the run where a state is missing
  for (const int body : event.receivers)
    processes_.state_at(body, std::min(event.safe_time, event.stamp.time));
  ++run_.counters.pair_checks;
  const double t = event.stamp.time;
  const std::optional<FoundImpact> found =
      find_impact(run_, processes_[a], processes_[b], event.safe_time, t);
  CheckFinding finding =
      closeness(run_.world(), a, processes_.flight_at(a, t), b, processes_.flight_at(b, t), t);
  if (found) {
    finding.contact = stamp_of(found->key);
    event.receivers = found->processes;
  }
  const CheckDecision decision = decide_.on_collision_check(event, finding, run_.step());
  if (decision.collides && !found)
    throw StoppedRun(
        fmt::format("on_collision_check says that {} and {} collide, but no impact was found in "
                    "[{:.9g}, {:.9g}] s",
                    processes_.name(a), processes_.name(b), event.safe_time, event.stamp.time));
  if (decision.collides) collide(id, *found, decision);
  if (!pairs_.holds(id, a, b)) return;  // their boxes have separated
  event.safe_time = decision.next.safe_time;
  event.stamp.time = decision.next.stamp.time;
  event.receivers = processes_.moving_with({a, b});
  queue_.put_check(id, event);
}

// ---- An impact ---------------------------------------------------------------------------------

void TaughtTimewarp::collide(int id, const FoundImpact& found, const CheckDecision& decision) {
  const EventStamp& key = found.key;
  const std::string why = fmt::format("{} and {} meet at t = {:.9g} s", processes_.name(key.body_a),
                                      processes_.name(key.body_b), key.time);
  // the scheduler's decision puts it back; the rollback must not insert it a second time
  queue_.park(id);
  roll_back(decision.rollbacks, why);
  for (const int body : found.processes) {
    const bool is_one_of_them = body == key.body_a || body == key.body_b;
    motion_.go_to(body, key.time,
                  is_one_of_them
                      ? std::optional(body == key.body_a ? found.version_a : found.version_b)
                      : std::nullopt,
                  why);
  }
  Discontinuity discontinuity =
      run_.resolve_impact(key, processes_.flight(key.body_a), processes_.flight(key.body_b));
  if (discontinuity.begun.empty())
    for (const auto& [body, flight] :
         {std::pair{key.body_a, &discontinuity.a}, std::pair{key.body_b, &discontinuity.b}})
      if (run_.world().can_move(body)) discontinuity.begun.push_back({body, *flight});
  begin_flights(std::move(discontinuity));
}

/// @param safe_time, time  of the checks of groups that begin; unset: their start time
void TaughtTimewarp::begin_flights(Discontinuity discontinuity, double safe_time, double time) {
  std::vector<BegunFlight> begun = discontinuity.begun;
  std::vector<std::int32_t> bodies;
  for (BegunFlight& begin : begun) {
    processes_.begin(begin, discontinuity.key);
    bodies.push_back(begin.body);
  }
  commits_.add(std::move(discontinuity), std::move(bodies));
  require_groups(decide_, run_.world(), begun);
  groups_.keep(safe_time, time);
}

// ---- A group -----------------------------------------------------------------------------------

void TaughtTimewarp::check_group(int id) {
  ScheduledEvent event = queue_.event(id);
  const int body = event.stamp.body_a;
  const Flight flight = processes_.flight(body);
  ++run_.counters.pair_checks;
  // The search gives the contacts and the end of the group; the scheduler decides.
  const GroupFinding finding = look_at_group(run_, body, flight, event.safe_time, event.stamp.time);
  if (finding.end) event.stamp.microstep = finding.end->microstep;
  const GroupDecision decision = decide_.on_group_check(event, finding.contacts, run_.step());
  const std::string why =
      fmt::format("the group of {} changes at t = {:.9g} s", processes_.name(body),
                  finding.end ? finding.end->time : event.stamp.time);
  if (decision.changes && !finding.end)
    throw StoppedRun(
        fmt::format("on_group_check says that {}, but no contact opens in [{:.9g}, {:.9g}] s", why,
                    event.safe_time, event.stamp.time));
  // Unchanged: the check returns to the queue with new times.
  if (!decision.changes) {
    event.stamp.microstep = 0;
    event.stamp.time = decision.next.stamp.time;
    event.safe_time = decision.next.safe_time;
    return queue_.put_check(id, event);
  }
  // Changed: the rollbacks, then the new groups, which must be those of the contacts.
  queue_.park(id);
  roll_back(decision.rollbacks, why);
  for (const int member : event.receivers)
    motion_.go_to(member, finding.end->time,
                  member == body ? std::optional(flight.version) : std::nullopt, why);
  Discontinuity discontinuity = run_.end_of_segment(*finding.end, flight);
  if (const Groups expected = groups_of(discontinuity.begun); decision.groups != expected)
    throw StoppedRun(fmt::format(
        "{}: on_group_check makes {} of it; the contacts that are still closed give {}", why,
        in_words(run_.world(), decision.groups), in_words(run_.world(), expected)));
  begin_flights(std::move(discontinuity), decision.next.safe_time, decision.next.stamp.time);
}

// ---- A callback --------------------------------------------------------------------------------

void TaughtTimewarp::expect_callback(const EventStamp& key) {
  const std::vector<int>& bodies = run_.receivers(key);
  queue_.add({stamp_of(key), key.time, {bodies.begin(), bodies.end()}});
}

void TaughtTimewarp::call(int id) {
  ScheduledEvent event = queue_.event(id);
  queue_.remove(id);  // until a rollback restores it
  const EventStamp& key = run_.callbacks()[event.stamp.microstep];
  std::vector<BegunFlight> flights;
  for (const int body : event.receivers)
    flights.push_back({body, processes_.state_at(body, key.time).flight});
  // bodies of one island change together
  event.receivers = bodies_that_move_with(run_.world(), flights);
  for (const int body : event.receivers) motion_.integrate(body, key.time);
  const std::string why =
      fmt::format("a callback acts on {} at t = {:.9g} s", processes_.name(key.body_a), key.time);
  roll_back(decide_.on_callback(event, processes_.local_times()), why);
  for (const int body : event.receivers) motion_.go_to(body, key.time, std::nullopt, why);
  begin_flights(
      run_.call(key, [this](int body) -> const Flight& { return processes_.flight(body); }));
}

// ---- Rollback ----------------------------------------------------------------------------------

void TaughtTimewarp::roll_back(const std::vector<Rollback>& first, const std::string& why) {
  const FlightWorld& world = run_.world();
  const std::vector<Rollback> plan = decide_.plan_rollback(commits_.effects(), first);
  // A process is rolled back once: a longer plan would cost its length times the queue's.
  if (plan.size() > first.size() + static_cast<std::size_t>(world.size()))
    throw StoppedRun(fmt::format("{}, and plan_rollback rolls back {} processes of {}", why,
                                 plan.size(), world.size()));
  for (const Rollback& rollback : plan) {
    if (rollback.body < 0 || rollback.body >= world.size() || !world.can_move(rollback.body))
      throw StoppedRun(fmt::format("{}, and plan_rollback rolls back {}, which is no process", why,
                                   processes_.name(rollback.body)));
    if (rollback.stamp.time > processes_.local_time(rollback.body)) continue;  // not advanced to it
    commits_.cancel(rollback, why);
    motion_.go_back(rollback, why);
  }
  for (const EventStamp& callback : commits_.forget_cancelled()) expect_callback(callback);
  for (const int id : queue_.ids()) {
    const ScheduledEvent event = queue_.event(id);
    const bool is_asked = std::any_of(plan.begin(), plan.end(), [&](const Rollback& rollback) {
      return std::find(event.receivers.begin(), event.receivers.end(), rollback.body) !=
             event.receivers.end();
    });
    if (!is_asked) continue;
    ScheduledEvent moved = event;
    const ScheduledEvent answer = decide_.after_rollback(event, plan);
    moved.stamp.time = answer.stamp.time;
    moved.safe_time = answer.safe_time;
    if (moved.stamp.time != event.stamp.time || moved.safe_time != event.safe_time)
      queue_.put_check(id, moved);
  }
  for (const Rollback& rollback : plan) pairs_.drop(rollback.body);
  groups_.keep();
}

}  // namespace tumble::engines
