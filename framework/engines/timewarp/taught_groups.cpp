#include "framework/engines/timewarp/taught_groups.h"

#include <algorithm>
#include <limits>
#include <map>

#include <fmt/format.h>

namespace tumble::engines {
namespace {

constexpr std::int32_t kSomeWall = -1;

}  // namespace

GroupFinding look_at_group(const FlightRun& run, int body, const Flight& flight, double safe_time,
                           double to) {
  LogicalProcesses& processes = *run.world().processes();
  GroupFinding finding;
  const std::vector<BodyPair> ties = processes.ties_of(processes.segments().start(flight.segment));
  finding.end = run.own_end(body, flight, to);
  // no change of the group: it may never come to it, and else the frame after it stops the run
  if (finding.end && finding.end->kind == StampKind::kFault) finding.end.reset();
  // the scheduler skipped this interval
  if (finding.end && finding.end->time < safe_time) finding.end.reset();
  if (!finding.end) {
    for (const auto& [a, b] : ties) finding.contacts.push_back({a, b, kInfinity});
    return finding;
  }
  // The contacts from then on, and the contacts until then.
  const SegmentEnd& end = *processes.segments().end_by(flight.segment, to);
  const std::vector<BodyPair> stays = processes.ties_of(end.after);
  for (const auto& [a, b] : stays) finding.contacts.push_back({a, b, kInfinity});
  for (const BodyPair& tie : ties)
    if (!std::binary_search(stays.begin(), stays.end(), tie))
      finding.contacts.push_back({tie.first, tie.second, end.time});
  finding.contacts.push_back({body, kSomeWall, end.time});
  return finding;
}

std::vector<GroupContact> contacts_of(const FlightWorld& world,
                                      const std::vector<BegunFlight>& begun) {
  std::vector<GroupContact> contacts;
  std::vector<int> seen;
  for (const BegunFlight& flight : begun) {
    const int segment = flight.flight.segment;
    if (segment < 0 || std::find(seen.begin(), seen.end(), segment) != seen.end()) continue;
    seen.push_back(segment);
    for (const auto& [a, b] :
         world.processes()->ties_of(world.processes()->segments().start(segment)))
      contacts.push_back({a, b, kInfinity});
  }
  return contacts;
}

Groups groups_of(const std::vector<BegunFlight>& begun) {
  std::map<int, std::vector<std::int32_t>> members;  // by segment
  Groups groups;
  for (const BegunFlight& flight : begun)
    if (flight.flight.segment >= 0)
      members[flight.flight.segment].push_back(flight.body);
    else
      groups.push_back({flight.body});
  for (auto& [segment, bodies] : members) {
    std::sort(bodies.begin(), bodies.end());
    groups.push_back(std::move(bodies));
  }
  std::sort(groups.begin(), groups.end());
  return groups;
}

void require_groups(const Scheduling& decide, const FlightWorld& world,
                    const std::vector<BegunFlight>& begun) {
  if (std::none_of(begun.begin(), begun.end(),
                   [](const BegunFlight& flight) { return flight.flight.segment >= 0; }))
    return;
  std::vector<std::int32_t> bodies;
  for (const BegunFlight& flight : begun) bodies.push_back(flight.body);
  const Groups expected = groups_of(begun),
               found = decide.contact_groups(bodies, contacts_of(world, begun));
  if (found != expected)
    throw StoppedRun(fmt::format("at t = {:.9g} s contact_groups makes {} of the islands {}",
                                 begun.front().flight.begin, in_words(world, found),
                                 in_words(world, expected)));
}

std::string in_words(const FlightWorld& world, const Groups& groups) {
  std::string text;
  for (const std::vector<std::int32_t>& group : groups) {
    text += text.empty() ? "{" : " {";
    for (std::size_t k = 0; k < group.size(); ++k) {
      const bool is_body = group[k] >= 0 && group[k] < world.size();
      text += (k > 0 ? ", " : "") +
              (is_body ? "'" + world.world().bodies[static_cast<std::size_t>(group[k])].name + "'"
                       : std::to_string(group[k]));
    }
    text += "}";
  }
  return text.empty() ? "none" : text;
}

}  // namespace tumble::engines
