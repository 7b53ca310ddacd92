#include "framework/engines/timewarp/taught_processes.h"

#include <fmt/format.h>

#include "framework/core/numbers.h"
#include "framework/engines/timewarp/taught_search.h"

namespace tumble::engines {

TaughtProcesses::TaughtProcesses(const FlightWorld& world, double duration)
    : world_(world), next_version_(static_cast<std::size_t>(world.size()), 1) {
  for (int i = 0; i < world.size(); ++i) {
    processes_.emplace_back(world, i);
    boxes_.push_back(world.can_move(i) ? Box{} : box_of_immovable(world, i, duration));
  }
}

double TaughtProcesses::local_time(int body) const {
  return world_.can_move(body) ? (*this)[body].local_time() : kInfinity;
}

std::vector<LocalTime> TaughtProcesses::local_times() const {
  std::vector<LocalTime> times;
  for (const int body : world_.movers()) times.push_back({body, local_time(body)});
  return times;
}

const KeptState& TaughtProcesses::state_at(int body, double t) const {
  if (const KeptState* state = (*this)[body].at(t)) return *state;
  throw StoppedRun(fmt::format(
      "{} is needed at t = {:.9g} s, but its earliest state is that of {:.9g} s, with global "
      "virtual time at {:.9g} s. Likely: too many were purged (states_to_purge), a check is due at "
      "a time before it, or global virtual time is too late",
      name(body), t, (*this)[body].states().front().time, gvt_));
}

const Flight& TaughtProcesses::flight(int body) const {
  return world_.can_move(body) ? (*this)[body].flight() : world_.first_flight(body);
}

const Flight& TaughtProcesses::flight_at(int body, double t) const {
  return world_.can_move(body) ? state_at(body, t).flight : world_.first_flight(body);
}

const Flight& TaughtProcesses::flight_before(int body, double t) const {
  return world_.can_move(body) ? (*this)[body].before(t) : world_.first_flight(body);
}

Box TaughtProcesses::box(int body) const {
  return world_.can_move(body) ? (*this)[body].swept() : boxes_[static_cast<std::size_t>(body)];
}

std::vector<std::int32_t> TaughtProcesses::moving_with(std::initializer_list<int> bodies) const {
  std::vector<BegunFlight> flights;
  for (const int body : bodies) flights.push_back({body, flight(body)});
  return bodies_that_move_with(world_, flights);
}

std::optional<double> TaughtProcesses::open_failure(const std::vector<std::int32_t>& bodies,
                                                    double t) const {
  std::optional<double> first;
  for (const int body : bodies) {
    const KeptState* state = (*this)[body].at(t);
    if (state == nullptr || state->flight.segment < 0) continue;
    const auto failed = world_.processes()->segments().failed_by(state->flight.segment, t);
    if (failed && *failed < t && gvt_ <= *failed && !(first && *first <= *failed)) first = failed;
  }
  return first;
}

void TaughtProcesses::begin(BegunFlight& begun, const EventStamp& began) {
  begun.flight.version = next_version_[static_cast<std::size_t>(begun.body)]++;
  (*this)[begun.body].begin(begun.flight, began);
}

void TaughtProcesses::stand(double until) const {
  for (const int body : world_.movers()) (*this)[body].stand(until);
}

std::string TaughtProcesses::name(int body) const {
  return body < 0 || body >= world_.size()
             ? fmt::format("body {}", body)
             : "'" + world_.world().bodies[static_cast<std::size_t>(body)].name + "'";
}

std::string TaughtProcesses::name(const EventStamp& key) const {
  if (key.kind == StampKind::kCallback)
    return fmt::format("the callback on {} at t = {:.9g} s", name(key.body_a), key.time);
  if (key.kind == StampKind::kProcess)
    return fmt::format("the change in the group of {} at t = {:.9g} s", name(key.body_a), key.time);
  return fmt::format("the impact of {} and {} at t = {:.9g} s", name(key.body_a), name(key.body_b),
                     key.time);
}

}  // namespace tumble::engines
