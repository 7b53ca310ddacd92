/// The bodies of a scene as event-driven engines see them: each on flights in closed form, or on
/// the island segment of its process.
///
/// Sources: ballistic flight; free rotation by dynamics/free_rotation.h. Immovable bodies follow
/// their prescribed motion: they have no process and are never rolled back.
#pragma once

#include <array>
#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "framework/collision/motion.h"
#include "framework/core/large_pages.h"
#include "framework/dynamics/rotation_bounds.h"
#include "framework/dynamics/spin_series.h"
#include "framework/dynamics/world.h"
#include "framework/engines/events/flight.h"
#include "framework/engines/events/logical_processes.h"

namespace tumble::engines {

class FlightWorld {
 public:
  /// @param engine  its name, for messages
  /// @param laws, rules  for processes
  /// @throws UserError with the scene's entry that is not modelled, or with two bodies that overlap
  ///   at the start
  FlightWorld(const scene::Scene& scene, const std::string& engine, const Laws& laws,
              ProcessRules rules);
  FlightWorld(const FlightWorld&) = delete;
  FlightWorld& operator=(const FlightWorld&) = delete;

  int size() const { return static_cast<int>(world_.bodies.size()); }
  const World& world() const { return world_; }
  const Vector3d& gravity_world() const { return gravity_world_; }
  /// Movable bodies, ascending; immovable bodies that can be hit, ascending.
  const std::vector<int>& movers() const { return movers_; }
  const std::vector<int>& obstacles() const { return obstacles_; }
  /// true: several threads query flights from now on; false: one thread again. Called while one
  /// thread runs alone.
  void share(bool shared);
  bool can_move(int body) const { return facts_[body].can_move; }
  bool is_ball(int body) const { return facts_[body].is_ball; }
  const Inertia& inertia(int body) const { return matter_[body].inertia; }
  double restitution(int body) const { return matter_[body].restitution; }
  bool collides(int body) const { return facts_[body].collides; }
  /// Immovable and without a prescribed motion.
  bool is_still(int body) const { return facts_[body].is_still; }
  bool is_half_space(int body) const { return facts_[body].is_half_space; }
  bool may_collide(int a, int b) const;
  /// Radius of the bounding ball; infinite for a half-space. [m]
  double radius(int body) const { return facts_[body].radius; }
  const collision::CollisionShape& shape(int body) const { return shapes_[facts_[body].shape]; }

  /// The flight of a body at the start of the run. Touching bodies are separated by the overlap
  /// that rounding has left.
  const Flight& first_flight(int body) const { return first_[body]; }

  /// Processes; null where every body of the scene flies freely at all times.
  LogicalProcesses* processes() const {
    return processes_->holds_any() ? processes_.get() : nullptr;
  }
  LogicalProcesses& all_processes() const { return *processes_; }
  /// Events of contacts that exist when the run begins.
  const std::vector<Event>& start_events() const { return start_events_; }
  /// The bodies of the island of this one, ascending: itself alone on a free flight.
  std::vector<int> members(int body, const Flight& flight) const {
    return flight.segment < 0 ? std::vector<int>{body}
                              : processes_->segments().members(flight.segment);
  }
  int first_member(int body, const Flight& flight) const {
    return flight.segment < 0 ? body : processes_->segments().members(flight.segment).front();
  }
  /// Whether impacts and contacts of the two are internal to their process, and no event of two
  /// flights.
  bool is_internal(int a, const Flight& f, int b, const Flight& g) const {
    if (!processes_->holds_contacts()) return false;
    return (f.segment >= 0 && (f.segment == g.segment || !can_move(b))) ||
           (g.segment >= 0 && !can_move(a));
  }
  /// A flight is dropped or will not be queried again. Called once for each flight.
  void release(const Flight& flight) const {
    if (flight.segment >= 0) processes_->segments().release(flight.segment);
  }
  /// The flight is part of the run up to `until`, whatever happens (IslandSegments::stand). Called
  /// before it is released, unless it is rolled back. [s]
  void stand(const Flight& flight, double until) const {
    if (flight.segment >= 0) processes_->segments().stand(flight.segment, until);
  }
  /// The time from `low` up to which the flight's motion is smooth, at most `high`; `low` itself
  /// where the flight has ended by then, or cannot go on. [s]
  double smooth_until(const Flight& flight, double low, double high) const {
    return flight.segment < 0
               ? high
               : std::min(high, processes_->segments().step_end(flight.segment, low));
  }
  /// Extends a box by the positions of the centre of mass over [from, to]. [m]
  void extend_by_path(int body, const Flight& flight, double from, double to, Vector3d& low,
                      Vector3d& high) const;

  /// @pre flight.segment < 0
  Vector3d acceleration(int body, const Flight& flight) const {
    return facts_[body].can_move && !flight.is_resting ? gravity_world_
                                                       : Vector3d(Vector3d::Zero());
  }
  /// @pre t >= flight.begin
  Vector3d position(int body, const Flight& flight, double t) const {
    if (!facts_[body].can_move)
      return facts_[body].is_still ? flight.com_world : prescribed_position(world_.bodies[body], t);
    if (flight.segment >= 0)
      return processes_->segments().body_state(flight.segment, body, t).com_world;
    const double tau = t - flight.begin;
    if (flight.is_resting || tau == 0.0) return flight.com_world;
    return flight.com_world + tau * (flight.velocity_world + (0.5 * tau) * gravity_world_);
  }
  Vector3d velocity(int body, const Flight& flight, double t) const {
    if (!facts_[body].can_move) return prescribed_velocity(world_.bodies[body], t);
    if (flight.segment >= 0)
      return inertia(body).inverse_mass *
             processes_->segments().body_state(flight.segment, body, t).momentum_world;
    return flight.is_resting
               ? flight.velocity_world
               : Vector3d(flight.velocity_world + (t - flight.begin) * gravity_world_);
  }
  Spin spin(int body, const Flight& flight, double t) const;
  collision::MotionState motion_at(int body, const Flight& flight, double t) const;
  /// @param t  the bounds hold from here for as long as the motion is smooth
  collision::MotionBounds bounds(int body, const Flight& flight, double t) const;
  /// The motion from `low` for as long as it is smooth. References to body and flight must outlive
  /// it.
  collision::Motion motion_from(int body, const Flight& flight, double low) const;
  RigidBodyState state(int body, const Flight& flight, double t) const;
  /// The body's state as impact laws take it.
  Body body_at(int body, const Flight& flight, double t) const;

 private:
  struct Facts {  // read in the innermost loops
    double radius;
    int shape;
    bool can_move, is_ball, is_still, is_half_space, collides, passes;
  };

  struct Matter {  // read at impacts; separate from the other data of a body, which is large
    Inertia inertia;
    double restitution;
  };

  // The rotation of a body on the flight that was queried last, cached for queries about one
  // flight. No answer depends on it. A thread that uses it holds its lock.
  struct Turning {
    std::atomic_flag is_held = ATOMIC_FLAG_INIT;
    double begin = kUnset;  // of the flight; unset: no flight yet
    Quaterniond world_from_body = Quaterniond::Identity();
    Vector3d omega_body = Vector3d::Zero();
    RotationBounds bounds{};
    double reach = 0.0;  // of a series [s]
    // series of [begin + k reach, begin + (k + 1) reach] are kept up to this k
    std::int64_t newest = -1;
    std::array<SpinSeries, 4> series;  // of the last ones, by k modulo 4
  };
  class HeldTurning;
  HeldTurning turning(int body, const Flight& flight) const;
  void turn_to(int body, const Flight& flight, Turning& turning) const;

  void refuse_overlap(const scene::Scene& scene);
  void start_processes();

  World world_;
  Vector3d gravity_world_ = Vector3d::Zero();
  std::vector<collision::CollisionShape> shapes_;  // equal ones once
  std::vector<FreeRotation> rotations_;            // by body; of immovable ones none is asked
  mutable std::vector<std::unique_ptr<Turning>> turning_;  // by body; made where a solid turns
  bool is_shared_ = false;
  std::vector<Facts, LargePages<Facts>> facts_;
  std::vector<Matter, LargePages<Matter>> matter_;  // by body
  std::vector<int> movers_, obstacles_;
  std::vector<Flight> first_;
  std::vector<BodyPair> near_at_start_;
  std::vector<Event> start_events_;
  std::unique_ptr<LogicalProcesses> processes_;
};

/// The first entry of a scene that event-ordered engines cannot follow, in words; empty: they can.
std::string unfollowed_entry(const scene::Scene& scene);

}  // namespace tumble::engines
