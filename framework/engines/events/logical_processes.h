/// Which bodies make one process, from one instant to the next: what links tie, what forces push, what lasting contacts hold together.
///
/// After every event that a process takes part in, its bodies are sorted anew: each component of links and lasting contacts goes on as a
/// passage; a single body that nothing holds or pushes flies freely again. What is still joins nobody: a box that lies on the floor is one
/// process, its neighbour on the same floor another.
#pragma once

#include <vector>

#include "framework/engines/events/flight.h"
#include "framework/engines/events/passages.h"

namespace tumble::engines {

class Processes {
 public:
  Processes(const World& whole, ShapeOf shape_of, const Laws& laws, ProcessRules rules);

  Passages& passages() { return passages_; }
  /// Whether some body of the world may not fly freely at some time.
  bool holds_any() const { return holds_any_; }
  /// Whether lasting contacts are asked for: what happens within a process is then its own affair.
  bool holds_contacts() const { return whole_.contact.has_value(); }

  /// The flights that the run begins with, of bodies that do not fly freely then.
  /// @param states   by body
  /// @param touching pairs that may touch at the start, within roundings
  /// @return besides the flights, what is said of contacts that begin
  struct Start {
    std::vector<BegunFlight> flights;
    std::vector<Event> events;
  };
  Start start(const std::vector<RigidBodyState>& states, const std::vector<BodyPair>& touching);

  /// Everything about the process of a body at a time: of its passage, or of the body alone.
  ProcessState state_of(int body, const Flight& flight, const RigidBodyState& alone, double t);
  /// Two processes as one.
  static ProcessState together(const ProcessState& a, const ProcessState& b);

  /// A state whose velocities somebody outside has changed: those that rods and joints allow, as after an impact.
  ProcessState on_constraints(ProcessState state);

  /// What holds the members of a state together: pairs of them that links tie (each to the least of its kind), that touch, or that meet again
  /// within a step or two. Each once, in order.
  std::vector<BodyPair> ties_of(const ProcessState& state) const;

  /// Sorts the bodies of a process anew. @return flights from state.time on; generation and partners are the caller's to give
  std::vector<BegunFlight> sort(const ProcessState& state);

 private:
  std::vector<std::vector<int>> components_of(const ProcessState& state) const;
  ProcessState component(const ProcessState& state, const std::vector<int>& members) const;
  bool is_pushed(int body, double t) const;

  const World& whole_;
  Passages passages_;
  bool holds_any_;
  std::vector<int> linked_;     // by body: the least body that links tie it to; -1: no link
};

}  // namespace tumble::engines
