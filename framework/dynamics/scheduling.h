/// What a timewarp scheduler decides on, and the decisions as replaceable functions (assignment
/// a4): plain data, no engine.
///
/// Bodies that move are processes; each has its own local virtual time. Walls and other immovable
/// bodies have no process and are never rolled back. Times are virtual times [s].
/// Sources: D. Jefferson, "Virtual time", ACM TOPLAS 7, 1985; B. Mirtich, "Timewarp rigid body
/// simulation", SIGGRAPH 2000.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "framework/core/math.h"

namespace tumble {

/// What happens, in the order in which it does at one instant and in one microstep.
enum class WorkKind : std::uint8_t { kCallback = 1, kCollision = 2, kGroup = 3, kRedraw = 4 };

/// Microstep of a redraw: a frame shows what has happened at its instant, so it comes last.
constexpr std::uint32_t kLastMicrostep = std::numeric_limits<std::uint32_t>::max();

/// When and where something happens. No two things of a run have the same stamp.
struct Stamp {
  double time = kUnset;         // [s]
  std::uint32_t microstep = 0;  // at one instant an effect has a larger one than its cause
  WorkKind kind = WorkKind::kCollision;
  // body_a < body_b; of a callback or a group (its lowest member) body_b is -1, of a redraw both
  // are
  std::int32_t body_a = -1, body_b = -1;
};

/// An event in the queue.
struct ScheduledEvent {
  // of a check: when the next look is due; its microstep is 0 (of a group's: that of what was
  // found)
  Stamp stamp;
  // nothing that this event may still change lies before it [s]: of a check the time up to which
  // its bodies were verified disjoint, of a callback its own time, of a redraw infinity
  double safe_time = kUnset;
  // processes that must have come to stamp.time, ascending; walls are none. Of a redraw empty: all
  std::vector<std::int32_t> receivers;
};

/// A body shall forget whatever it did at `stamp` and later, and go on from there.
struct Rollback {
  std::int32_t body = -1;
  Stamp stamp;
};

/// Something that was worked at and is not committed: an impact, a callback, a group's change. It
/// changed one process, two, or whole groups.
struct Effect {
  Stamp stamp;
  std::vector<std::int32_t> processes;  // those it changed, ascending; walls are none
};

/// What the framework found for a collision check when it looked at [safe_time, stamp.time].
struct CheckFinding {
  // the earliest impact there that has not been resolved; nothing: disjoint throughout
  std::optional<Stamp> contact;
  double gap = kUnset;  // at stamp.time, >= 0 [m]
  // at stamp.time: at most so fast the gap closes, >= 0 [m/s]
  double closing_speed = kUnset;
  double closing_acceleration = kUnset;  // bound, >= 0 [m/s^2]
};

struct CheckDecision {
  bool collides = false;            // the framework then applies the impulse at the contact
  std::vector<Rollback> rollbacks;  // by body; empty where nothing collides
  ScheduledEvent next;              // the same check as it goes back into the queue
};

/// Two bodies of a group that touch, or one of them and a wall (no body of the group: its number,
/// or -1).
struct GroupContact {
  std::int32_t body_a = -1, body_b = -1;
  // when they part; infinite: not within what was looked at [s]
  double opens = kUnset;
};

struct GroupDecision {
  bool changes = false;
  // where it changes: what the group becomes; each ascending, by lowest member
  std::vector<std::vector<std::int32_t>> groups;
  std::vector<Rollback> rollbacks;  // by body; empty where nothing changes
  // where it changes, each new group's check begins with these times
  ScheduledEvent next;
};

struct LocalTime {
  std::int32_t body = -1;
  double time = kUnset;  // its local virtual time [s]
};

/// The decisions of a scheduler. What each must answer stands in the header of the module that
/// fills it.
struct Scheduling {
  std::function<bool(const Stamp& x, const Stamp& y)> comes_before;
  std::function<double(double now, double gap, double closing_speed, double closing_acceleration,
                       double step)>
      next_check_time;
  std::function<CheckDecision(const ScheduledEvent& event, const CheckFinding& finding,
                              double step)>
      on_collision_check;
  std::function<std::vector<std::vector<std::int32_t>>(const std::vector<std::int32_t>& bodies,
                                                       const std::vector<GroupContact>& contacts)>
      contact_groups;
  std::function<GroupDecision(const ScheduledEvent& event,
                              const std::vector<GroupContact>& contacts, double step)>
      on_group_check;
  std::function<std::vector<Rollback>(const ScheduledEvent& event,
                                      const std::vector<LocalTime>& local_times)>
      on_callback;
  std::function<std::vector<Rollback>(const std::vector<Effect>& effects, const Rollback& rollback)>
      anti_messages;
  std::function<std::vector<Rollback>(const std::vector<Effect>& effects,
                                      const std::vector<Rollback>& first)>
      plan_rollback;
  std::function<ScheduledEvent(const ScheduledEvent& event, const std::vector<Rollback>& rollbacks)>
      after_rollback;
  std::function<double(const std::vector<LocalTime>& local_times,
                       const std::vector<ScheduledEvent>& events)>
      global_virtual_time;
  std::function<bool(const Stamp& stamp, double global_virtual_time)> may_commit;
  std::function<std::uint32_t(const std::vector<double>& state_times, double global_virtual_time)>
      states_to_purge;

  explicit operator bool() const { return static_cast<bool>(comes_before); }
};

}  // namespace tumble
