/// Ordinary differential equations y' = f(t, y), and a rigid body's state as their y.
#pragma once

#include <functional>
#include <stdexcept>

#include "framework/core/math.h"
#include "framework/core/root.h"
#include "framework/dynamics/body.h"

namespace tumble {

/// Right-hand side: the derivative of y at time t. @return (n), as y, per second
using OdeFunction = std::function<VectorXd(double t, const VectorXd& y)>;

/// Layout of a rigid body's state as a vector (13): com_world (3), quaternion w x y z (4), momentum
/// (3), angular momentum (3).
inline constexpr int kStateSize = 13;
inline VectorXd pack(const RigidBodyState& state) {
  VectorXd y(kStateSize);
  const Quaterniond& q = state.world_from_body;
  y << state.com_world, q.w(), q.x(), q.y(), q.z(), state.momentum_world,
      state.angular_momentum_world;
  return y;
}

/// @pre y has 13 rows. The quaternion is copied as it stands, not normalised.
inline RigidBodyState unpack(const VectorXd& y) {
  if (y.size() != kStateSize)
    throw std::invalid_argument("unpack: a rigid body's state has 13 numbers");
  return {y.segment<3>(0), Quaterniond(y[3], y[4], y[5], y[6]), y.segment<3>(7), y.segment<3>(10)};
}

}  // namespace tumble
