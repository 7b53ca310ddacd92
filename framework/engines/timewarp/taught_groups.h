/// What the teaching timewarp tells a scheduler of contact groups: what holds the members together, when that ends, what they become.
#pragma once

#include <optional>
#include <vector>

#include "framework/dynamics/scheduling.h"
#include "framework/engines/events/flight_run.h"

namespace tumble::engines {

using Groups = std::vector<std::vector<std::int32_t>>;

/// What was found for a group check.
struct GroupFinding {
  std::vector<GroupContact> contacts;
  std::optional<EventKey> end;    // the first thing that happens within the group; nothing: all stays as it is
};

/// Looks at [safe_time, to] for the group of a flight on a passage, whose first member is `body`. Links and touches are contacts alike: a
/// link never opens. What happens within the group without anybody parting (members or a wall meet, touch, or let go of a wall) opens
/// a contact with a wall, -1 where there is none: the group goes on, from there, as it was.
GroupFinding look_at_group(const FlightRun& run, int body, const Flight& flight, double safe_time, double to);

/// The contacts that hold what these flights begin together, none of which opens.
std::vector<GroupContact> contacts_of(const FlightWorld& world, const std::vector<BegunFlight>& begun);

/// The groups that these flights make of their bodies: by lowest member, each ascending.
Groups groups_of(const std::vector<BegunFlight>& begun);

/// "{1, 2} {3}", with names.
std::string told(const FlightWorld& world, const Groups& groups);

}  // namespace tumble::engines
