/// The motion of one body between two discontinuities, in closed form, and the order of
/// discontinuities.
#pragma once

#include <cstdint>
#include <tuple>

#include "framework/core/math.h"

namespace tumble::engines {

/// Kinds of events, in the order in which events of one instant and one microstep are committed.
enum class StampKind : std::uint8_t {
  // a process continues after a rollback, before any other event of the instant, because it may
  // find the earliest one; never committed
  kRecheck = 0,
  // a callback changes bodies; body_a is the first of them, body_b -1, the microstep its index in
  // the list
  kCallback = 1,
  kCollision = 2,
  // internal event of a process: an impact within it, a contact that begins or opens; body_a is its
  // first body, body_b -1
  kProcess = 3,
  // the step of a process that begins now cannot be taken; body_a is its first body, body_b -1, the
  // microstep the last of the instant. Never committed: where it is the next event of all, the run
  // stops for it
  kFault = 4,
  kAdvance = 255  // forward execution of a process; never committed
};

/// The total order of committed events: time, microstep, kind, bodies. Two events of a run never
/// have the same stamp, so no result depends on the order in which events are found or executed.
///
/// The microstep (superdense time) orders cause and effect at one instant (A hits B at t, and B,
/// which touches C, hits C at t): the microstep of an event is above those of the events at the
/// same instant that began its flights. It is compared before the bodies, because an effect must
/// not precede its cause.
///
/// `Stamp` (dynamics/scheduling.h) is the part of it that the schedulers of assignment a4 see.
struct EventStamp {
  double time;  // [s]
  std::uint32_t microstep;
  StampKind kind;
  std::int32_t body_a, body_b;  // body_a < body_b for two bodies

  std::tuple<double, std::uint32_t, StampKind, std::int32_t, std::int32_t> as_tuple() const {
    return {time, microstep, kind, body_a, body_b};
  }
};
inline bool operator==(const EventStamp& x, const EventStamp& y) {
  return x.as_tuple() == y.as_tuple();
}
inline bool operator<(const EventStamp& x, const EventStamp& y) {
  // Times are different in nearly all comparisons.
  if (x.time != y.time) return x.time < y.time;
  return x.as_tuple() < y.as_tuple();
}

/// A free-flight (ballistic) segment: the motion of a body from one discontinuity to the next,
/// whenever that is. The centre of mass follows a parabola; the rotation is free.
/// A flight is the state that a logical process of timewarp saves: the history of a body is a
/// sequence of flights. Bodies that move as one island (linked, driven by forces, in persistent
/// contact) share an island segment (island_segments.h), which gives their motion; their flights
/// name it, and begin and end together.
struct Flight {
  double begin = 0.0;                                     // [s]
  Vector3d com_world = Vector3d::Zero();                  // at `begin` [m]
  Vector3d velocity_world = Vector3d::Zero();             // at `begin` [m/s]
  Quaterniond world_from_body = Quaterniond::Identity();  // at `begin`
  Vector3d omega_body = Vector3d::Zero();                 // at `begin` [rad/s]
  // the body that it hit at `begin`; -1: the run's start
  std::int32_t partner = -1;
  // version of the partner's flight that began with the same event
  std::uint32_t partner_version = 0;
  std::uint32_t microstep = 0;  // of that event
  // version number: no two flights of a body in a run have the same
  std::uint32_t version = 0;
  // index of the island segment of the body's process; -1: the body flies freely
  std::int32_t segment = -1;
  // used by the scheduler only: its record of the event that began the flight
  std::int32_t change = -1;
  // on an immovable support: the position is constant
  bool is_resting = false;
};

/// A flight that begins with an event.
struct BegunFlight {
  int body;
  Flight flight;
};

}  // namespace tumble::engines
