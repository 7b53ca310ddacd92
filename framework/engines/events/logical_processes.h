/// The partition of bodies into logical processes at each instant: islands of links, forces and
/// persistent contacts.
///
/// After every event of a process its bodies are partitioned anew: each component of links and
/// persistent contacts continues as a segment; a single body without link, force or contact flies
/// freely again. Immovable bodies join no process: a box on the floor is one process, its neighbour
/// on the same floor another.
#pragma once

#include <vector>

#include "framework/engines/events/flight.h"
#include "framework/engines/events/island_segments.h"

namespace tumble::engines {

class LogicalProcesses {
 public:
  LogicalProcesses(const World& whole, ShapeOf shape_of, const Laws& laws, ProcessRules rules);

  IslandSegments& segments() { return segments_; }
  /// Whether some body of the world may at some time not fly freely.
  bool holds_any() const { return holds_any_; }
  /// Whether the scene has persistent contacts: impacts within a process are then internal events.
  bool holds_contacts() const { return whole_.contact.has_value(); }

  /// The flights at the start of the run, of bodies that do not fly freely then.
  /// @param states   by body
  /// @param touching pairs that may touch at the start, within roundings
  /// @return besides the flights, the events of contacts that begin
  struct Start {
    std::vector<BegunFlight> flights;
    std::vector<Event> events;
  };
  Start start(const std::vector<RigidBodyState>& states, const std::vector<BodyPair>& touching);

  /// The state of the process of a body at a time: of its segment, or of the body alone.
  ProcessState state_of(int body, const Flight& flight, const RigidBodyState& alone, double t);
  /// The union of two processes.
  static ProcessState together(const ProcessState& a, const ProcessState& b);

  /// A state after velocities were changed from outside: projected onto what rods and joints allow,
  /// as after an impact.
  ProcessState on_constraints(ProcessState state);

  /// The pairs that hold the members of a state together: linked (each body with the lowest of its
  /// links' component), in contact, or about to meet again within a step or two. Each pair once, in
  /// order.
  std::vector<BodyPair> ties_of(const ProcessState& state) const;

  /// Partitions the bodies of a process. @return flights from state.time on; the caller sets
  /// microstep and partners
  std::vector<BegunFlight> sort(const ProcessState& state);

 private:
  std::vector<std::vector<int>> components_of(const ProcessState& state) const;
  ProcessState component(const ProcessState& state, const std::vector<int>& members) const;
  bool is_pushed(int body, double t) const;

  const World& whole_;
  IslandSegments segments_;
  bool holds_any_;
  std::vector<int> linked_;  // by body: the lowest body of its component of links; -1: no link
};

}  // namespace tumble::engines
