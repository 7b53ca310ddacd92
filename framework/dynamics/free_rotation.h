/// Rotation of a rigid body under no torque, over any time, to round-off: what integrators are
/// compared with, and what an engine may use where nothing but gravity acts.
///
/// Frames: `body` has its origin at the centre of mass; its axes need not be principal. `world` is
/// inertial. Quaternions are unit, Hamilton, body to world. Spherical and symmetric tops are turned
/// in closed form; the others by a Taylor series.
///   I w' = (I w) x w   in the body frame,     q' = 1/2 q (0, w)                              (F.1)
/// Source: L. Landau, E. Lifshitz, Mechanics, sections 35 to 37.
#pragma once

#include "framework/dynamics/body.h"

namespace tumble {

/// An orientation after a turn, given as axis times angle in the world frame. [rad]
Quaterniond turned(const Quaterniond& world_from_body, const Vector3d& turn_world);

/// How a body is turned, and how it turns. The angular velocity is in the body frame, where a
/// needle's slender axis (moments 1e-9 : 1) keeps all its digits; recovering it from an angular
/// momentum in the world frame loses nine of them.
struct Spin {
  Quaterniond world_from_body{kUnset, kUnset, kUnset, kUnset};  // unit, Hamilton
  Vector3d omega_body = unset_vector();                         // (3), body frame [rad/s]
};

/// How an asymmetric top tumbles (Landau and Lifshitz, section 37).
struct Tumbling {
  double modulus_m = kUnset;  // of the elliptic functions: in [0, 1]; 1 on the separatrix
  // of the angular velocity seen by the body [s]; infinite on the separatrix
  double period = kUnset;
};

/// The free rotation of one body: made once, asked for any time.
class FreeRotation {
 public:
  /// @param inertia_body  (3, 3), symmetric positive definite, about the centre of mass, body frame
  /// [kg m^2]
  explicit FreeRotation(const Matrix3d& inertia_body);

  /// The spin a time t after `start`; t may be negative.
  /// @pre    start.world_from_body is unit, everything is finite
  /// @return orientation within about 1e-15 + 1e-16 |w| t of the exact one for exact inputs, unless
  /// the motion itself
  ///         amplifies rounding (turning about the middle axis); unit to round-off
  /// Cost: spherical and symmetric tops O(1); others O(|w| t) up to a few periods of the tumbling,
  /// then O(period)
  Spin after(const Spin& start, double t) const;

  /// Whether all three moments differ: turning has no closed form in sines and cosines then.
  bool is_asymmetric() const { return kind_ == Kind::kAsymmetric; }
  const Vector3d& moments() const { return moments_; }
  const Quaterniond& body_from_principal() const { return body_from_principal_; }

  /// Modulus and period of the tumbling. Spherical and symmetric tops have modulus 0.
  /// @param omega_body  (3), body frame [rad/s]
  Tumbling tumbling(const Vector3d& omega_body) const;

  /// Smallest relative difference of two moments at which a body counts as a symmetric top: what
  /// computing them leaves.
  static constexpr double kSameMoment = 4e-16;

 private:
  enum class Kind { kSpherical, kSymmetric, kAsymmetric };

  Spin after_in_principal_frame(const Spin& start, double t) const;

  Vector3d moments_;                 // principal, in the order of the principal frame's axes
  Quaterniond body_from_principal_;  // identity for a diagonal tensor
  Kind kind_ = Kind::kAsymmetric;
  int axis_ = 0;  // of symmetry, where kSymmetric
};

/// A whole body that nothing pushes: the centre of mass goes straight, momenta stay bit for bit,
/// the body turns freely. The angular velocity is taken from the angular momentum, which costs a
/// needle digits (see Spin).
/// @pre inertia is finite
RigidBodyState advance_freely(const RigidBodyState& state, const Inertia& inertia, double t);

}  // namespace tumble
