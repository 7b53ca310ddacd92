// What happens: impacts, what ends by itself within a group, callbacks. Part of TaughtTimewarp.
#include "framework/engines/timewarp/taught_run.h"

#include <algorithm>

namespace tumble::engines {

// ---- An impact ---------------------------------------------------------------------------------------------------------

void TaughtTimewarp::collide(int id, const FoundImpact& found, const CheckDecision& decision) {
  const EventKey& key = found.key;
  const std::string why = fmt::format("{} and {} meet at t = {:.9g} s", name(key.body_a), name(key.body_b), key.time);
  queue_.park(id);   // it comes back as decided; the rollback must not put it in twice
  roll_back(decision.rollbacks, why);
  for (const int body : found.processes) {
    const bool is_one_of_them = body == key.body_a || body == key.body_b;
    go_to(body, key.time, is_one_of_them ? std::optional(body == key.body_a ? found.serial_a : found.serial_b) : std::nullopt, why);
  }
  Meeting meeting = run_.meet(key, flight_of(key.body_a), flight_of(key.body_b));
  if (meeting.begun.empty())
    for (const auto& [body, flight] : {std::pair{key.body_a, &meeting.a}, std::pair{key.body_b, &meeting.b}})
      if (world().can_move(body)) meeting.begun.push_back({body, *flight});
  begin_flights(meeting, kUnset, kUnset);
}

// Whoever something happens to must have come there, and must not have gone on: on the flight that was looked at, where that is known.
void TaughtTimewarp::go_to(int body, double t, std::optional<std::uint32_t> serial, const std::string& why) {
  const bool is_another = serial && process(body).flight().serial != *serial;
  if (is_another || process(body).local_time() > t)
    throw StoppedRun(fmt::format("{}, and {} was not sent back there: it stands at {:.9g} s{}", why, name(body), process(body).local_time(), process(body).local_time() > t ? "" : ", on a flight that begins later"));
  if (process(body).local_time() < t) step_to(body, t);
}

/// @param safe_time, time  of the checks of groups that begin; unset: the time at which they do
void TaughtTimewarp::begin_flights(const Meeting& meeting, double safe_time, double time) {
  Executed executed{{stamp_of(meeting.key), {}}, meeting.key, meeting.first, meeting.more, meeting.is_silent};
  std::vector<BegunFlight> begun = meeting.begun;
  for (BegunFlight& begin : begun) {
    begin.flight.serial = next_serial_[static_cast<std::size_t>(begin.body)]++;
    process(begin.body).begin(begin.flight, meeting.key);
    executed.effect.processes.push_back(begin.body);
  }
  executed_.push_back(std::move(executed));
  ask_for_groups(begun);
  keep_group_checks(safe_time, time);
}

// ---- Groups --------------------------------------------------------------------------------------------------------------

// The groups that an event leaves are known from what holds its bodies together; a scheduler has to see the same.
void TaughtTimewarp::ask_for_groups(const std::vector<BegunFlight>& begun) {
  if (std::none_of(begun.begin(), begun.end(), [](const BegunFlight& flight) { return flight.flight.passage >= 0; })) return;
  std::vector<std::int32_t> bodies;
  for (const BegunFlight& flight : begun) bodies.push_back(flight.body);
  const Groups expected = groups_of(begun), found = decide_.contact_groups(bodies, contacts_of(world(), begun));
  if (found != expected)
    throw StoppedRun(fmt::format("at t = {:.9g} s contact_groups makes {} of what touches and hangs together as {}", begun.front().flight.begin, told(world(), found), told(world(), expected)));
}

// Whatever somebody is on now and may end by itself has a check; what nobody is on has none. One that comes back by a rollback is known up to
// where its members stand.
void TaughtTimewarp::keep_group_checks(double safe_time, double time) {
  if (!world().processes() || !world().processes()->holds_contacts()) return;
  std::map<int, int> first_of;   // members by passage
  for (const int body : world().movers())
    if (const Flight& flight = process(body).flight(); flight.passage >= 0 && world().first_member(body, flight) == body) first_of.emplace(flight.passage, body);
  std::erase_if(groups_, [&](const auto& known) {
    if (first_of.contains(known.first)) return false;
    queue_.remove(known.second);
    return true;
  });
  for (const auto& [passage, body] : first_of) {
    if (groups_.contains(passage)) continue;
    const double now = process(body).local_time();
    ScheduledEvent check{{std::isnan(time) ? now : time, 0, WorkKind::kGroup, body, -1}, std::isnan(safe_time) ? now : safe_time, bodies_that_move_with(world(), {{body, process(body).flight()}})};
    check.stamp.time = due(check);
    groups_[passage] = queue_.add(check);
  }
}

void TaughtTimewarp::check_group(int id) {
  ScheduledEvent event = queue_.event(id);
  const int body = event.stamp.body_a;
  const Flight flight = process(body).flight();
  ++run_.counters.pair_checks;
  const GroupFinding finding = look_at_group(run_, body, flight, event.safe_time, event.stamp.time);
  if (finding.end) event.stamp.generation = finding.end->generation;
  const GroupDecision decision = decide_.on_group_check(event, finding.contacts, run_.step());
  const std::string why = fmt::format("the group of {} changes at t = {:.9g} s", name(body), finding.end ? finding.end->time : event.stamp.time);
  if (decision.changes && !finding.end) throw StoppedRun(fmt::format("on_group_check says that {}, and no contact opens in [{:.9g}, {:.9g}] s", why, event.safe_time, event.stamp.time));
  if (!decision.changes) {
    event.stamp.generation = 0;
    event.stamp.time = decision.next.stamp.time;
    event.safe_time = decision.next.safe_time;
    return put_check(id, event);
  }
  queue_.park(id);
  roll_back(decision.rollbacks, why);
  for (const int member : event.receivers) go_to(member, finding.end->time, member == body ? std::optional(flight.serial) : std::nullopt, why);
  const Meeting meeting = run_.end_of_passage(*finding.end, flight);
  if (const Groups expected = groups_of(meeting.begun); decision.groups != expected)
    throw StoppedRun(fmt::format("{}: on_group_check makes {} of it; by the contacts that are still closed it is {}", why, told(world(), decision.groups), told(world(), expected)));
  begin_flights(meeting, decision.next.safe_time, decision.next.stamp.time);
}

// ---- A callback ------------------------------------------------------------------------------------------------------------

void TaughtTimewarp::expect_callback(const EventKey& key) {
  const std::vector<int>& bodies = run_.receivers(key);
  queue_.add({stamp_of(key), key.time, {bodies.begin(), bodies.end()}});
}

void TaughtTimewarp::call(int id) {
  ScheduledEvent event = queue_.event(id);
  queue_.remove(id);   // until it is taken back
  const EventKey& key = run_.callbacks()[event.stamp.generation];
  std::vector<BegunFlight> flights;
  for (const int body : event.receivers) flights.push_back({body, state_at(body, key.time).flight});
  event.receivers = bodies_that_move_with(world(), flights);   // whoever hangs together with one is changed with it
  for (const int body : event.receivers) integrate(body, key.time);
  const std::string why = fmt::format("a callback acts on {} at t = {:.9g} s", name(key.body_a), key.time);
  roll_back(decide_.on_callback(event, local_times()), why);
  for (const int body : event.receivers) go_to(body, key.time, std::nullopt, why);
  begin_flights(run_.call(key, [this](int body) -> const Flight& { return flight_of(body); }), kUnset, kUnset);
}

std::string TaughtTimewarp::name(const EventKey& key) const {
  if (key.kind == EventClass::kCallback) return fmt::format("the callback on {} at t = {:.9g} s", name(key.body_a), key.time);
  if (key.kind == EventClass::kProcess) return fmt::format("the change in the group of {} at t = {:.9g} s", name(key.body_a), key.time);
  return fmt::format("the impact of {} and {} at t = {:.9g} s", name(key.body_a), name(key.body_b), key.time);
}

std::vector<LocalTime> TaughtTimewarp::local_times() const {
  std::vector<LocalTime> times;
  for (const int body : world().movers()) times.push_back({body, processes_[static_cast<std::size_t>(body)].local_time()});
  return times;
}

}  // namespace tumble::engines
