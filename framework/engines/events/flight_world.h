/// The bodies of a scene as event-ordered engines see them: each alone, on flights in closed form, or on a passage of its process.
///
/// Sources: ballistic flight; free rotation by dynamics/free_rotation.h. Immovable bodies go by their prescribed motion: they have no
/// process and are never rolled back.
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
#include "framework/engines/events/processes.h"

namespace tumble::engines {

class FlightWorld {
 public:
  /// @param engine  named where the scene is refused
  /// @param laws, rules  for processes
  /// @throws UserError naming the scene's entry that is not followed, or two bodies that overlap at the start
  FlightWorld(const scene::Scene& scene, const std::string& engine, const Laws& laws, ProcessRules rules);
  FlightWorld(const FlightWorld&) = delete;
  FlightWorld& operator=(const FlightWorld&) = delete;

  int size() const { return static_cast<int>(world_.bodies.size()); }
  const World& world() const { return world_; }
  const Vector3d& gravity_world() const { return gravity_world_; }
  /// Movable bodies, ascending; immovable ones that may be hit, ascending.
  const std::vector<int>& movers() const { return movers_; }
  const std::vector<int>& obstacles() const { return obstacles_; }
  /// From now on several threads ask about flights at once, or one alone again. By the one thread that works at that moment.
  void share(bool shared);
  bool can_move(int body) const { return facts_[body].can_move; }
  bool is_ball(int body) const { return facts_[body].is_ball; }
  const Inertia& inertia(int body) const { return matter_[body].inertia; }
  double restitution(int body) const { return matter_[body].restitution; }
  bool collides(int body) const { return facts_[body].collides; }
  /// Immovable and without a motion of its own.
  bool is_still(int body) const { return facts_[body].is_still; }
  bool is_half_space(int body) const { return facts_[body].is_half_space; }
  bool may_collide(int a, int b) const;
  /// Of the ball around the body; infinite for a half-space. [m]
  double radius(int body) const { return facts_[body].radius; }
  const collision::CollisionShape& shape(int body) const { return shapes_[facts_[body].shape]; }

  /// The flight of a body at the start of the run, touching bodies drawn apart by what rounding made them overlap.
  const Flight& first_flight(int body) const { return first_[body]; }

  /// Processes; null where every body of the scene flies freely at all times.
  Processes* processes() const { return processes_->holds_any() ? processes_.get() : nullptr; }
  Processes& all_processes() const { return *processes_; }
  /// What is said of contacts that hold where the run begins.
  const std::vector<Event>& start_events() const { return start_events_; }
  /// The bodies that move with this one, ascending: itself alone on a free flight.
  std::vector<int> members(int body, const Flight& flight) const { return flight.passage < 0 ? std::vector<int>{body} : processes_->passages().members(flight.passage); }
  int first_member(int body, const Flight& flight) const { return flight.passage < 0 ? body : processes_->passages().members(flight.passage).front(); }
  /// Whether what the two do to each other is the affair of their process, and no event of two flights.
  bool is_internal(int a, const Flight& f, int b, const Flight& g) const {
    if (!processes_->holds_contacts()) return false;
    return (f.passage >= 0 && (f.passage == g.passage || !can_move(b))) || (g.passage >= 0 && !can_move(a));
  }
  /// A flight is dropped or will not be asked about again: once a flight.
  void release(const Flight& flight) const {
    if (flight.passage >= 0) processes_->passages().release(flight.passage);
  }
  /// How far from `low` the flight's motion is of one piece, at most to `high`; `low` itself where it has ended by then. [s]
  double smooth_until(const Flight& flight, double low, double high) const {
    return flight.passage < 0 ? high : std::min(high, processes_->passages().step_end(flight.passage, low));
  }
  /// Takes the places of the centre over [from, to] into the corners of a box. [m]
  void take_in_way(int body, const Flight& flight, double from, double to, Vector3d& low, Vector3d& high) const;

  /// @pre flight.passage < 0
  Vector3d acceleration(int body, const Flight& flight) const { return facts_[body].can_move && !flight.is_resting ? gravity_world_ : Vector3d(Vector3d::Zero()); }
  /// @pre t >= flight.begin
  Vector3d position(int body, const Flight& flight, double t) const {
    if (!facts_[body].can_move) return facts_[body].is_still ? flight.com_world : prescribed_position(world_.bodies[body], t);
    if (flight.passage >= 0) return processes_->passages().body_state(flight.passage, body, t).com_world;
    const double tau = t - flight.begin;
    if (flight.is_resting || tau == 0.0) return flight.com_world;
    return flight.com_world + tau * (flight.velocity_world + (0.5 * tau) * gravity_world_);
  }
  Vector3d velocity(int body, const Flight& flight, double t) const {
    if (!facts_[body].can_move) return prescribed_velocity(world_.bodies[body], t);
    if (flight.passage >= 0) return inertia(body).inverse_mass * processes_->passages().body_state(flight.passage, body, t).momentum_world;
    return flight.is_resting ? flight.velocity_world : Vector3d(flight.velocity_world + (t - flight.begin) * gravity_world_);
  }
  Spin spin(int body, const Flight& flight, double t) const;
  collision::MotionState motion_at(int body, const Flight& flight, double t) const;
  /// @param t  the bounds hold from here on as far as the motion is of one piece
  collision::MotionBounds bounds(int body, const Flight& flight, double t) const;
  /// From `low` on as far as the motion is of one piece. Both stay where they are as long as it is asked.
  collision::Motion motion_from(int body, const Flight& flight, double low) const;
  RigidBodyState state(int body, const Flight& flight, double t) const;
  /// As impulses need it.
  Body body_at(int body, const Flight& flight, double t) const;

 private:
  struct Facts {          // what the hot loop asks of a body
    double radius;
    int shape;
    bool can_move, is_ball, is_still, is_half_space, collides, passes;
  };

  struct Matter {         // what an impact asks of a body; apart from the rest of what is known of it, which is large
    Inertia inertia;
    double restitution;
  };

  // How a body turns on the flight that was asked about last: what questions about one flight share. No answer depends on it. Held by
  // whoever asks, where several threads do.
  struct Turning {
    std::atomic_flag is_held = ATOMIC_FLAG_INIT;
    double begin = kUnset;               // of the flight; unset: of none yet
    Quaterniond world_from_body = Quaterniond::Identity();
    Vector3d omega_body = Vector3d::Zero();
    RotationBounds bounds{};
    double reach = 0.0;                  // of a series [s]
    std::int64_t newest = -1;            // series of [begin + k reach, begin + (k + 1) reach] are kept up to this k
    std::array<SpinSeries, 4> series;    // of the last ones, by k modulo 4
  };
  class HeldTurning;
  HeldTurning turning(int body, const Flight& flight) const;
  void turn_to(int body, const Flight& flight, Turning& turning) const;

  void refuse_overlap(const scene::Scene& scene);
  void start_processes();

  World world_;
  Vector3d gravity_world_ = Vector3d::Zero();
  std::vector<collision::CollisionShape> shapes_;   // equal ones once
  std::vector<FreeRotation> rotations_;             // by body; of immovable ones none is asked
  mutable std::vector<std::unique_ptr<Turning>> turning_;   // by body; made where a solid turns
  bool is_shared_ = false;
  std::vector<Facts, LargePages<Facts>> facts_;
  std::vector<Matter, LargePages<Matter>> matter_;  // by body
  std::vector<int> movers_, obstacles_;
  std::vector<Flight> first_;
  std::vector<BodyPair> near_at_start_;
  std::vector<Event> start_events_;
  std::unique_ptr<Processes> processes_;
};

/// The first entry of a scene that event-ordered engines cannot follow, in words; empty: they can.
std::string unfollowed_entry(const scene::Scene& scene);

}  // namespace tumble::engines
