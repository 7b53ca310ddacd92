/// Contact groups as the teaching timewarp shows them to a scheduler: what holds the members
/// together, when that ends, and the resulting groups.
#pragma once

#include <optional>
#include <vector>

#include "framework/dynamics/scheduling.h"
#include "framework/engines/events/flight_run.h"

namespace tumble::engines {

using Groups = std::vector<std::vector<std::int32_t>>;

/// Result of the search for a group check.
struct GroupFinding {
  std::vector<GroupContact> contacts;
  std::optional<EventStamp> end;  // the first event within the group; nothing: no change
};

/// Searches [safe_time, to] for changes in the group of a flight on a segment, whose first member
/// is `body`. Links and contacts both count as contacts; a link never opens. An event within the
/// group that separates no body (members or a wall collide, touch, or lose contact with a wall)
/// opens a contact with a wall, -1 where there is none: the group continues from there unchanged.
GroupFinding look_at_group(const FlightRun& run, int body, const Flight& flight, double safe_time,
                           double to);

/// The contacts that hold together what these flights begin; none of them opens.
std::vector<GroupContact> contacts_of(const FlightWorld& world,
                                      const std::vector<BegunFlight>& begun);

/// The groups of bodies of these flights: by lowest member, each ascending.
Groups groups_of(const std::vector<BegunFlight>& begun);

/// Asks the scheduler for the groups after an event: they follow from the contacts and links of its
/// bodies. @throws StoppedRun where it finds others
void require_groups(const Scheduling& decide, const FlightWorld& world,
                    const std::vector<BegunFlight>& begun);

/// "{1, 2} {3}", with names.
std::string in_words(const FlightWorld& world, const Groups& groups);

}  // namespace tumble::engines
