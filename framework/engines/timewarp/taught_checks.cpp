#include "framework/engines/timewarp/taught_checks.h"

#include <algorithm>
#include <cmath>

namespace tumble::engines {

bool TaughtPairChecks::holds(int id, int a, int b) const {
  const auto check = checks_.find({a, b});
  return check != checks_.end() && check->second == id;
}

void TaughtPairChecks::find(int body, double from) {
  const FlightWorld& world = processes_.world();
  const Box own = processes_.box(body);
  for (int other = 0; other < world.size(); ++other) {
    const std::pair pair(std::min(body, other), std::max(body, other));
    if (other == body || !world.may_collide(body, other) || checks_.contains(pair) ||
        !own.overlaps(processes_.box(other)))
      continue;
    const Stamp stamp{processes_.local_time(body), 0, WorkKind::kCollision, pair.first,
                      pair.second};
    checks_[pair] = queue_.add_check({stamp, std::min(from, processes_.local_time(other)),
                                      processes_.moving_with({pair.first, pair.second})});
    ++counters_.candidate_pairs;
  }
}

void TaughtPairChecks::drop(int body) {
  const Box own = processes_.box(body);
  std::erase_if(checks_, [&](const auto& entry) {
    const auto& [pair, id] = entry;
    if (pair.first != body && pair.second != body) return false;
    if (own.overlaps(processes_.box(pair.first == body ? pair.second : pair.first))) return false;
    queue_.remove(id);
    return true;
  });
}

void TaughtGroupChecks::keep(double safe_time, double time) {
  const FlightWorld& world = processes_.world();
  if (!world.processes() || !world.processes()->holds_contacts()) return;
  std::map<int, int> first_of;  // its first member, by segment
  for (const int body : world.movers())
    if (const Flight& flight = processes_.flight(body);
        flight.segment >= 0 && world.first_member(body, flight) == body)
      first_of.emplace(flight.segment, body);
  std::erase_if(checks_, [&](const auto& known) {
    if (first_of.contains(known.first)) return false;
    queue_.remove(known.second);
    return true;
  });
  for (const auto& [segment, body] : first_of) {
    if (checks_.contains(segment)) continue;
    const double now = processes_.local_time(body);
    checks_[segment] =
        queue_.add_check({{std::isnan(time) ? now : time, 0, WorkKind::kGroup, body, -1},
                          std::isnan(safe_time) ? now : safe_time,
                          processes_.moving_with({body})});
  }
}

}  // namespace tumble::engines
