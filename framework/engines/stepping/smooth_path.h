/// The path of a body within a step as polynomials of time, for bodies whose motion depends on
/// others: springs, rods, joints and contacts. Asking it costs no integration, and what bounds it
/// is exact.
///
/// The centre goes along the cubic through both ends with their velocities (Hermite). The body
/// turns as q(t) = q0 exp(phi(t)), phi a cubic rotation vector in the frame of the body at the
/// start, with the angular velocities of both ends. Between the ends the path is off the solution
/// by O(h^4); at the ends it is the states themselves. The polynomials are worked out when they are
/// first asked for: where nothing can collide, nothing asks.
#pragma once

#include "framework/collision/motion.h"
#include "framework/dynamics/body.h"

namespace tumble::engines {

/// |omega|, which is the same in every frame. [rad/s]
double turning_speed_of(const RigidBodyState& state, const Inertia& inertia);

class SmoothPath {
 public:
  SmoothPath() = default;
  /// What a state between the ends takes for its momenta. Where position correction has removed an
  /// overlap the path goes where no velocity stands for, and the shorter the step the faster:
  /// momenta that change evenly from end to end know nothing of it.
  enum class Momenta { kOfPath, kEven };

  /// @pre t0 < t1. Velocities are those of the states' momenta.
  SmoothPath(const RigidBodyState& start, const RigidBodyState& end, const Inertia& inertia,
             double t0, double t1, Momenta momenta = Momenta::kOfPath);

  /// Momenta that change evenly begin with those of `state`, where the path begins with a velocity
  /// of its own: a straight path has that of its end from the start, which the impacts and the
  /// weight of the whole step have made.
  void begin_momenta(const RigidBodyState& state) {
    momentum_[0] = state.momentum_world;
    angular_momentum_[0] = state.angular_momentum_world;
  }

  Momenta momenta() const { return momenta_; }
  RigidBodyState at(double t) const;
  /// Velocities of the path.
  collision::MotionState motion_at(double t) const;
  const collision::MotionBounds& bounds() const {
    work_out();
    return bounds_;
  }
  /// How far its ends would turn it through the step by their angular velocities, the farther.
  /// [rad]
  double turning_at_ends() const;
  /// Works out the polynomials. What several threads may ask has been worked out before.
  void work_out() const {
    if (!is_worked_out_) find_polynomials();
  }

 private:
  Vector3d omega_world(double s, Quaterniond& world_from_body) const;
  collision::MotionState motion_of(double s) const;

  void find_polynomials() const;

  double t0_ = 0.0, h_ = 1.0;
  Inertia inertia_;
  mutable bool is_worked_out_ = true;
  mutable Vector3d x_[4];    // coefficients of s^k, s = (t - t0) / h
  mutable Vector3d phi_[4];  // likewise; phi_[0] = 0
  RigidBodyState from_, to_;
  Quaterniond start_;
  Momenta momenta_ = Momenta::kOfPath;
  Vector3d momentum_[2], angular_momentum_[2];  // at the ends
  mutable collision::MotionBounds bounds_;
  mutable collision::MotionState at_start_;  // a search for impacts asks for it once a pair
};

}  // namespace tumble::engines
