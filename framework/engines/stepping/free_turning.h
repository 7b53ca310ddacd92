/// A free body's turning by the laws' integration, beside the exact one.
///
/// What no torque acts on turns freely, which is known to rounding (dynamics/free_rotation.h). From
/// each state that the method did not lead to, after an impact or a contact, an exact rotation runs
/// along; what the two differ by is the method's error since then:
///   e(t) = angle between q(t) of the method and q(t) of L(0), q(0)                        (1)
/// No energy tells of it: a body that spins evenly keeps its energy to rounding however wrong it
/// points, and one that tumbles and has lost a thousandth of its energy is a radian off after a
/// thousand. What flights leave adds up.
#pragma once

#include "framework/dynamics/body.h"
#include "framework/dynamics/free_rotation.h"

namespace tumble::engines {

class FreeTurning {
 public:
  explicit FreeTurning(const Inertia& inertia);

  /// A step under no torque. @param speed  |omega| at its start [rad/s]
  void step(const RigidBodyState& from, const RigidBodyState& to, double duration, double speed);
  /// How far the body has been turned wrong, all flights together, when it was looked last: that is
  /// once a radian, and where a flight has ended. [rad]
  double error() const { return error_before_ + error_; }
  /// The longest step since the start. [s]
  double longest_step() const { return longest_step_; }

 private:
  void look();

  Matrix3d inverse_inertia_body_;
  FreeRotation rotation_;
  Spin exact_;                                           // when it was looked last
  Quaterniond reached_{kUnset, kUnset, kUnset, kUnset};  // by the method
  Vector3d angular_momentum_world_ = unset_vector();
  double since_look_ = 0.0, turned_since_look_ = 0.0;  // [s], [rad]
  double error_ = 0.0, error_before_ = 0.0;            // of this flight, of those before [rad]
  double longest_step_ = 0.0;
};

}  // namespace tumble::engines
