/// Motor: a control law in a hinge. Every period it looks at the hinge's angle and sets its torque,
/// which it holds until the next look.
///   torque = stiffness (target(t) - angle) - damping rate,
///       target(t) = offset + amplitude sin(2 pi frequency t + phase)
#pragma once

#include <limits>
#include <string>

#include "framework/effects/joint/joint.h"

namespace tumble::effects {

/// What a scene says of it.
struct MotorSpec {
  std::string joint;  // a hinge's name
  double offset_rad = 0.0, amplitude_rad = 0.0, frequency_hz = 0.0, phase_rad = 0.0;
  double stiffness_n_m_rad = 0.0, damping_n_m_s_rad = 0.0;
  double largest_torque_n_m = std::numeric_limits<double>::infinity();
  double period_s = 0.01;
  // JSON pointer of the entry that asked for it, for messages; empty: made in memory
  std::string pointer{};
};

/// What a world holds of it.
struct Motor {
  JointLink hinge;  // that it turns
  MotorSpec law;
};

}  // namespace tumble::effects
