/// How one body moves between two discontinuities, in closed form, and the order in which discontinuities happen.
#pragma once

#include <cstdint>
#include <tuple>

#include "framework/core/math.h"

namespace tumble::engines {

/// What happens at one instant, in the order in which it does when the generation is the same.
enum class EventClass : std::uint8_t {
  kLookAgain = 0,    // a process that was taken back goes on, before anything of its instant: it may find what comes first; never committed
  kCallback = 1,     // a callback changes bodies; body_a is the first of them, body_b -1, the generation its place in the list
  kCollision = 2,
  kProcess = 3,      // a process's own: an impact within it, a contact that begins or opens; body_a is its first body, body_b -1
  kAdvance = 255     // a process goes on; never committed
};

/// The total order of what is committed: time, generation, kind, bodies. Two events of a run never have the same key, so that no result
/// depends on the order in which events were found or worked at.
///
/// The generation tells cause from effect where no time passes between them (A hits B at t, and B, which touches C, hits C at t): an
/// event has a generation above those of the events at its own instant that began the flights it looks at. It stands before the bodies,
/// because an effect must not sort before its cause.
struct EventKey {
  double time;                  // [s]
  std::uint32_t generation;
  EventClass kind;
  std::int32_t body_a, body_b;  // body_a < body_b, where there are two

  std::tuple<double, std::uint32_t, EventClass, std::int32_t, std::int32_t> as_tuple() const { return {time, generation, kind, body_a, body_b}; }
};
inline bool operator==(const EventKey& x, const EventKey& y) { return x.as_tuple() == y.as_tuple(); }
inline bool operator<(const EventKey& x, const EventKey& y) {
  // Times nearly always differ.
  if (x.time != y.time) return x.time < y.time;
  return x.as_tuple() < y.as_tuple();
}

/// The motion of a body from one discontinuity to its next, whenever that is: the centre of mass on a parabola, the turning free.
/// This is the state that a process of timewarp keeps: a body's history is a row of flights. Bodies that move together (linked, pushed, in
/// lasting contact) share a passage (passages.h), which says where they are; their flights name it and begin and end together.
struct Flight {
  double begin = 0.0;                                   // [s]
  Vector3d com_world = Vector3d::Zero();                // at `begin` [m]
  Vector3d velocity_world = Vector3d::Zero();           // at `begin` [m/s]
  Quaterniond world_from_body = Quaterniond::Identity();   // at `begin`
  Vector3d omega_body = Vector3d::Zero();               // at `begin` [rad/s]
  std::int32_t partner = -1;                            // whom it hit to begin it; -1: the run's start
  std::uint32_t partner_serial = 0;                     // the partner's flight that began with the same event
  std::uint32_t generation = 0;                         // of that event
  std::uint32_t serial = 0;                             // no two flights of a body that ever were have the same
  std::int32_t passage = -1;                            // of the process that the body is part of; -1: it flies freely
  std::int32_t change = -1;                             // the scheduler's own: what it knows of the event that began it
  bool is_resting = false;                              // on an immovable support: keeps its place
};

/// A flight that an event has begun.
struct BegunFlight {
  int body;
  Flight flight;
};

}  // namespace tumble::engines
