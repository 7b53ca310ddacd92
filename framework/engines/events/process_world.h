/// The small world of one process: bodies that links, forces or lasting contacts keep from flying freely, moved by the world's own stages
/// (moving_world, linked_bodies, lasting_contacts, sequential_impacts), and by nothing else.
///
/// It keeps no time of its own: every question brings the state to start from, and the answer depends on that alone. So processes go on,
/// are rolled back and begin again in any order.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "framework/engines/events/world_part.h"
#include "framework/engines/contact/lasting_contacts.h"
#include "framework/engines/contact/meetings.h"
#include "framework/engines/contact/sequential_impacts.h"

namespace tumble::engines {

using BodyPair = std::pair<int, int>;   // first < second

/// Everything that a process goes on from. Indices are those of the whole world.
struct ProcessState {
  double time = 0.0;                            // [s]
  std::vector<int> members;                     // movable bodies, ascending
  std::vector<RigidBodyState> states;           // by member
  std::map<int, effects::Memory> remembered;               // what entries remember, by place of the effect in effects::all()
  std::map<BodyPair, double> met;               // when pairs met last [s]
  std::set<BodyPair> lasting;                   // pairs in lasting contact
  std::set<BodyPair> near;                      // pairs without restitution that meet within a step or two: they stay together (in_step)
  std::optional<ContactMemory> contacts;        // what contacts remember; bodies are those of the process world that made this state

  const RigidBodyState& state_of(int body) const;
  /// A copy that goes on as if contacts had been asked for the first time; much the cheaper one.
  ProcessState without_memory() const;
};

/// What the pages of a scene say about impacts and steps.
struct ProcessRules {
  double step, rest_speed;                      // [s], [m/s]
};

/// Solids of the whole world, by body.
using ShapeOf = std::function<const collision::CollisionShape*(int body)>;

/// A process's way from one of its states to the next.
struct ProcessStep {
  ProcessState from;                            // with what motors hold and forces take hold of during the step
  double end;                                   // [s]; from.time where a discontinuity stands at the very start
  std::vector<SmoothPath> paths;                // by member; empty for a step without length
  std::vector<ContactPoint> forces;             // in lasting contacts

  collision::MotionState motion_at(std::size_t member, double t, const Inertia& inertia) const;
  RigidBodyState state_at(std::size_t member, double t) const;
};

class ProcessWorld {
 public:
  /// @param still  immovable bodies that members may touch here, besides those that links end at
  ProcessWorld(const World& whole, const EntriesByBody& entries, const ShapeOf& shape_of, const Laws& laws, ProcessRules rules, RunCounters& counters, const std::vector<int>& members, const std::vector<int>& still);
  ProcessWorld(const ProcessWorld&) = delete;
  ProcessWorld& operator=(const ProcessWorld&) = delete;

  const std::vector<int>& members() const { return members_; }

  /// States at the start of the run, on their constraints.
  ProcessState at_start(const std::vector<RigidBodyState>& states);

  /// A state with the velocities that rods and joints allow.
  ProcessState on_constraints(const ProcessState& state);

  /// A state within a step, for a picture: contacts keep members apart at a step's ends, and links hold there; on the path between them a body that turns
  /// dips in by what is of second order in the step, and links open by its fourth power. Here that is taken back.
  ProcessState shown(const ProcessState& state);

  /// What happens at one instant.
  struct Change {
    ProcessState after;
    std::vector<Event> events;
  };
  /// Begins lasting contacts where members touch each other or what is still, slowly.
  Change begin_contacts(const ProcessState& state);

  struct Outcome {
    ProcessStep step;
    ProcessState after;
    std::vector<Event> events;                  // not empty: the process has a discontinuity of its own there
  };
  /// One step, or less: to `due`, to a motor's look, a force's switching, or the first discontinuity among the members.
  /// @param start  what its contacts remember is taken out of it: nobody goes on from a state twice
  Outcome step(ProcessState& start, double due);

  /// The impact of a pair, of which one or both are members.
  Change collide(BodyPair pair, const ProcessState& state);

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
  std::map<int, effects::Memory> renamed(const std::map<int, effects::Memory>& memory, bool to_whole) const;
  void begin_step(double target);
  void require_numbers() const;
  bool has_contacts() const { return contacts_.has_value(); }
  std::vector<ContactPoint> forces() const;
  void resolve(const std::vector<BodyPair>& pairs, BodyPair trigger, bool is_in_step);
  std::vector<BodyPair> near_pairs(std::optional<BodyPair> trigger) const;
  std::vector<Event> take_events();
  int whole(int body) const { return body < 0 ? body : part_.bodies[static_cast<std::size_t>(body)]; }
  int local(int body) const;
  BodyPair whole(BodyPair pair) const { return {whole(pair.first), whole(pair.second)}; }
  BodyPair local(BodyPair pair) const { return {local(pair.first), local(pair.second)}; }
  std::string name(int body) const { return "'" + moving_.world().bodies[static_cast<std::size_t>(body)].name + "'"; }

  const Laws& laws_;
  ProcessRules rules_;
  RunCounters& counters_;
  std::vector<int> members_;
  WorldPart part_;
  MovingWorld moving_;
  Meetings meetings_;
  SequentialImpacts impacts_;
  Collector collector_;
  std::optional<LastingContacts> contacts_;
};

}  // namespace tumble::engines
