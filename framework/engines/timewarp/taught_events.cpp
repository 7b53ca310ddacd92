// Execution of events: impacts, ends of segments, callbacks. Part of TaughtTimewarp.
#include "framework/engines/timewarp/taught_run.h"

#include <algorithm>

namespace tumble::engines {

// ---- An impact ---------------------------------------------------------------------------------

void TaughtTimewarp::collide(int id, const FoundImpact& found, const CheckDecision& decision) {
  const EventStamp& key = found.key;
  const std::string why =
      fmt::format("{} and {} meet at t = {:.9g} s", name(key.body_a), name(key.body_b), key.time);
  // the scheduler's decision puts it back; the rollback must not insert it a second time
  queue_.park(id);
  roll_back(decision.rollbacks, why);
  for (const int body : found.processes) {
    const bool is_one_of_them = body == key.body_a || body == key.body_b;
    go_to(body, key.time,
          is_one_of_them ? std::optional(body == key.body_a ? found.version_a : found.version_b)
                         : std::nullopt,
          why);
  }
  Discontinuity discontinuity =
      run_.resolve_impact(key, flight_of(key.body_a), flight_of(key.body_b));
  if (discontinuity.begun.empty())
    for (const auto& [body, flight] :
         {std::pair{key.body_a, &discontinuity.a}, std::pair{key.body_b, &discontinuity.b}})
      if (world().can_move(body)) discontinuity.begun.push_back({body, *flight});
  begin_flights(std::move(discontinuity), kUnset, kUnset);
}

// Checks that a body has been rolled back to the time of an event: it must stand there, on the
// flight that was checked where that is known.
void TaughtTimewarp::go_to(int body, double t, std::optional<std::uint32_t> version,
                           const std::string& why) {
  const bool is_another = version && process(body).flight().version != *version;
  if (is_another || process(body).local_time() > t)
    throw StoppedRun(
        fmt::format("{}, and {} was not rolled back to it: its local virtual time is {:.9g} s{}",
                    why, name(body), process(body).local_time(),
                    process(body).local_time() > t ? "" : ", on a flight that begins later"));
  if (process(body).local_time() < t) step_to(body, t);
}

/// @param safe_time, time  of the checks of groups that begin; unset: their start time
void TaughtTimewarp::begin_flights(Discontinuity discontinuity, double safe_time, double time) {
  Executed executed{{stamp_of(discontinuity.key), {}},
                    discontinuity.key,
                    discontinuity.first,
                    discontinuity.more,
                    discontinuity.is_silent};
  std::vector<BegunFlight> begun = discontinuity.begun;
  for (BegunFlight& begin : begun) {
    begin.flight.version = next_version_[static_cast<std::size_t>(begin.body)]++;
    process(begin.body).begin(begin.flight, discontinuity.key);
    executed.effect.processes.push_back(begin.body);
  }
  executed.noted = std::move(discontinuity.noted);
  executed_.push_back(std::move(executed));
  ask_for_groups(begun);
  keep_group_checks(safe_time, time);
}

// ---- Groups ------------------------------------------------------------------------------------

// The groups after an event follow from the contacts and links of its bodies; the scheduler must
// find the same.
void TaughtTimewarp::ask_for_groups(const std::vector<BegunFlight>& begun) {
  if (std::none_of(begun.begin(), begun.end(),
                   [](const BegunFlight& flight) { return flight.flight.segment >= 0; }))
    return;
  std::vector<std::int32_t> bodies;
  for (const BegunFlight& flight : begun) bodies.push_back(flight.body);
  const Groups expected = groups_of(begun),
               found = decide_.contact_groups(bodies, contacts_of(world(), begun));
  if (found != expected)
    throw StoppedRun(fmt::format("at t = {:.9g} s contact_groups makes {} of the islands {}",
                                 begun.front().flight.begin, in_words(world(), found),
                                 in_words(world(), expected)));
}

// Every current segment that may end by itself has a group check; a segment that no body is on has
// none. A segment that a rollback restores is verified up to its members' local virtual times.
void TaughtTimewarp::keep_group_checks(double safe_time, double time) {
  if (!world().processes() || !world().processes()->holds_contacts()) return;
  std::map<int, int> first_of;  // its first member, by segment
  for (const int body : world().movers())
    if (const Flight& flight = process(body).flight();
        flight.segment >= 0 && world().first_member(body, flight) == body)
      first_of.emplace(flight.segment, body);
  std::erase_if(groups_, [&](const auto& known) {
    if (first_of.contains(known.first)) return false;
    queue_.remove(known.second);
    return true;
  });
  for (const auto& [segment, body] : first_of) {
    if (groups_.contains(segment)) continue;
    const double now = process(body).local_time();
    ScheduledEvent check{{std::isnan(time) ? now : time, 0, WorkKind::kGroup, body, -1},
                         std::isnan(safe_time) ? now : safe_time,
                         bodies_that_move_with(world(), {{body, process(body).flight()}})};
    check.stamp.time = due(check);
    groups_[segment] = queue_.add(check);
  }
}

void TaughtTimewarp::check_group(int id) {
  ScheduledEvent event = queue_.event(id);
  const int body = event.stamp.body_a;
  const Flight flight = process(body).flight();
  ++run_.counters.pair_checks;
  // The search gives the contacts and the end of the group; the scheduler decides.
  const GroupFinding finding = look_at_group(run_, body, flight, event.safe_time, event.stamp.time);
  if (finding.end) event.stamp.microstep = finding.end->microstep;
  const GroupDecision decision = decide_.on_group_check(event, finding.contacts, run_.step());
  const std::string why = fmt::format("the group of {} changes at t = {:.9g} s", name(body),
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
    return put_check(id, event);
  }
  // Changed: the rollbacks, then the new groups, which must be those of the contacts.
  queue_.park(id);
  roll_back(decision.rollbacks, why);
  for (const int member : event.receivers)
    go_to(member, finding.end->time, member == body ? std::optional(flight.version) : std::nullopt,
          why);
  Discontinuity discontinuity = run_.end_of_segment(*finding.end, flight);
  if (const Groups expected = groups_of(discontinuity.begun); decision.groups != expected)
    throw StoppedRun(
        fmt::format("{}: on_group_check makes {} of it; the contacts that are still closed give {}",
                    why, in_words(world(), decision.groups), in_words(world(), expected)));
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
  for (const int body : event.receivers) flights.push_back({body, state_at(body, key.time).flight});
  // bodies of one island change together
  event.receivers = bodies_that_move_with(world(), flights);
  for (const int body : event.receivers) integrate(body, key.time);
  const std::string why =
      fmt::format("a callback acts on {} at t = {:.9g} s", name(key.body_a), key.time);
  roll_back(decide_.on_callback(event, local_times()), why);
  for (const int body : event.receivers) go_to(body, key.time, std::nullopt, why);
  begin_flights(run_.call(key, [this](int body) -> const Flight& { return flight_of(body); }),
                kUnset, kUnset);
}

std::string TaughtTimewarp::name(const EventStamp& key) const {
  if (key.kind == StampKind::kCallback)
    return fmt::format("the callback on {} at t = {:.9g} s", name(key.body_a), key.time);
  if (key.kind == StampKind::kProcess)
    return fmt::format("the change in the group of {} at t = {:.9g} s", name(key.body_a), key.time);
  return fmt::format("the impact of {} and {} at t = {:.9g} s", name(key.body_a), name(key.body_b),
                     key.time);
}

std::vector<LocalTime> TaughtTimewarp::local_times() const {
  std::vector<LocalTime> times;
  for (const int body : world().movers())
    times.push_back({body, processes_[static_cast<std::size_t>(body)].local_time()});
  return times;
}

}  // namespace tumble::engines
