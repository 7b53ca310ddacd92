/// The world of one process: bodies that cannot fly freely because of links, forces or persistent
/// contacts. They move by the same stages as in a world of all bodies (contact/world_step.h).
///
/// It has no time of its own: every query brings the state to start from, and the answer depends on
/// that state alone. So processes advance, are rolled back and start again in any order. For the
/// same reason, what a step or an impact notes for the watch over a run is part of its result.
#pragma once

#include <exception>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "framework/engines/events/world_part.h"
#include "framework/engines/contact/world_step.h"

namespace tumble::engines {

using BodyPair = std::pair<int, int>;  // first < second

/// The state from which a process continues. Indices are those of the whole world.
struct ProcessState {
  double time = 0.0;                   // [s]
  std::vector<int> members;            // movable bodies, ascending
  std::vector<RigidBodyState> states;  // by member
  // internal state of effects, by index in effects::all()
  std::map<int, effects::Memory> remembered;
  std::map<BodyPair, double> met;  // the time of each pair's last impact [s]
  std::set<BodyPair> lasting;      // pairs in persistent contact
  // pairs without restitution that meet again within a step or two: they stay in one island
  // (in_step)
  std::set<BodyPair> near;
  std::map<int, Wrench> pressing;  // by body of the whole world: ContactMemory::pressing
  // memory of contacts; bodies are those of the process world that computed this state
  std::optional<ContactMemory> contacts;

  const RigidBodyState& state_of(int body) const;
  /// A copy without contact memory, as for a first contact step; much cheaper to copy.
  ProcessState without_memory() const;
};

/// The scene's numbers for impacts and steps.
struct ProcessRules {
  double step, restitution_threshold;  // [s], [m/s]
};

/// Shapes of the whole world, by body.
using ShapeOf = std::function<const collision::CollisionShape*(int body)>;

/// One step of a process, from one of its states to the next.
struct ProcessStep {
  // with the targets of motors and the forces that act during the step
  ProcessState from;
  // [s]; from.time for a discontinuity at the very start
  double end;
  std::vector<SmoothPath> paths;     // by member; empty for a step without length
  std::vector<ContactPoint> forces;  // in persistent contacts
  // what a run that takes it must not keep silent; null: nothing
  std::unique_ptr<RunWatch> noted{};
  // likewise, of the response to an impact at its end: what happens before may prevent that
  std::unique_ptr<RunWatch> noted_at_end{};

  collision::MotionState motion_at(std::size_t member, double t, const Inertia& inertia) const;
  RigidBodyState state_at(std::size_t member, double t) const;
};

class ProcessWorld {
 public:
  /// @param still  immovable bodies that members may touch here, besides those that links end at
  ProcessWorld(const World& whole, const EntriesByBody& entries, const ShapeOf& shape_of,
               const Laws& laws, ProcessRules rules, RunCounters& counters,
               const std::vector<int>& members, const std::vector<int>& still);
  ProcessWorld(const ProcessWorld&) = delete;
  ProcessWorld& operator=(const ProcessWorld&) = delete;

  const std::vector<int>& members() const { return members_; }

  /// States at the start of the run, projected onto their constraints.
  ProcessState at_start(const std::vector<RigidBodyState>& states);

  /// A state with velocities that rods and joints allow.
  ProcessState on_constraints(const ProcessState& state);

  /// A state within a step, for a picture. At the ends of a step contacts are without overlap and
  /// links are closed. On the path between them a rotating body penetrates by a distance of second
  /// order in the step, and links open by one of fourth order. This function removes both.
  ProcessState shown(const ProcessState& state);

  /// The discontinuity of a process at one instant.
  struct Change {
    ProcessState after;
    std::vector<Event> events;
    std::unique_ptr<RunWatch> noted{};  // as of a step
  };
  /// Begins persistent contacts where members touch each other or immovable bodies slowly.
  Change begin_contacts(const ProcessState& state);

  struct Outcome {
    ProcessStep step;
    ProcessState after;
    // not empty: the process has a discontinuity of its own there
    std::vector<Event> events;
    // the response to an impact at the step's end, which failed: the step stands, and nothing is
    // known after it (`after` and `events` are empty); null: all is well
    std::exception_ptr failure{};
  };
  /// One step, or less: to `due`, to a motor's next sample, to a switching force, or to the first
  /// discontinuity among the members.
  /// @param start  its contact memory is moved out, because a process continues only once from a
  ///   state
  /// @throws where the step cannot be taken; an impact at its end that has no response is reported
  Outcome step(ProcessState& start, double due);

  /// The impact of a pair, of which one or both are members.
  Change collide(BodyPair pair, const ProcessState& state);

  /// Resolves all impacts of the members at one instant, for what is said of their order. The notes
  /// are those of the counters.
  /// @pre the members fly freely up to here
  void watch_order(BodyPair pair, const ProcessState& state);

 private:
  struct Collector final : TrajectorySink {
    void begin(const TrajectoryInfo&, const std::vector<TrajectoryBody>&) override {}
    void frame(const Frame&) override {}
    void event(const Event& event) override { events.push_back(event); }
    void end(const Counters&, const std::string&) override {}
    std::vector<Event> events;
  };

  void load(const ProcessState& from, std::optional<ContactMemory> memory = std::nullopt);
  ProcessState save();
  void save_controls(ProcessState& state) const;
  void note_near(ProcessState& state) const;
  double load_forces(const ProcessState& from);
  std::map<int, effects::Memory> renamed(const std::map<int, effects::Memory>& memory,
                                         bool to_whole) const;
  void begin_step(double target);
  bool has_contacts() const { return world_step_.has_contacts(); }
  std::vector<ContactPoint> forces() const;
  std::vector<BodyPair> near_pairs(std::optional<BodyPair> trigger) const;
  std::vector<Event> take_events();
  int whole(int body) const {
    return body < 0 ? body : part_.bodies[static_cast<std::size_t>(body)];
  }
  int local(int body) const;
  BodyPair whole(BodyPair pair) const { return {whole(pair.first), whole(pair.second)}; }
  BodyPair local(BodyPair pair) const { return {local(pair.first), local(pair.second)}; }

  struct Stages;  // what a process adds to a step

  ProcessRules rules_;
  RunCounters& counters_;
  std::vector<int> members_;
  WorldPart part_;
  Collector collector_;
  WorldStep world_step_;
  MovingWorld& moving_;  // of world_step_
};

}  // namespace tumble::engines
