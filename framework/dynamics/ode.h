/// Ordinary differential equations y' = f(t, y), and roots along their solutions: the words that integrators share.
#pragma once

#include <functional>
#include <stdexcept>

#include "framework/core/math.h"
#include "framework/dynamics/body.h"

namespace tumble {

/// Right-hand side: the derivative of y at time t. @return (n), as y, per second
using OdeFunction = std::function<VectorXd(double t, const VectorXd& y)>;

/// A scalar function of time whose sign change is looked for, e.g. the gap between two bodies [m].
using ScalarFunction = std::function<double(double t)>;

enum class RootStatus {
  kConverged,    // the bracket is as small as asked, or the function is exactly zero
  kNoSignChange, // f(t_low) and f(t_high) have the same strict sign: nothing was searched
  kNotConverged, // the iteration limit was reached first; `time` is the best so far
};

/// What a root finder found, and how good it is.
struct RootResult {
  RootStatus status = RootStatus::kNotConverged;
  double time = kUnset;       // [s]
  double residual = kUnset;   // f(time)
  int evaluations = 0;        // of f (not of its derivative)
};

/// Layout of a rigid body's state as a vector (13): com_world (3), quaternion w x y z (4), momentum (3), angular momentum (3).
inline constexpr int kStateSize = 13;
inline VectorXd pack(const RigidBodyState& state) {
  VectorXd y(kStateSize);
  const Quaterniond& q = state.world_from_body;
  y << state.com_world, q.w(), q.x(), q.y(), q.z(), state.momentum_world, state.angular_momentum_world;
  return y;
}

/// @pre y has 13 rows. The quaternion is copied as it stands, not normalised.
inline RigidBodyState unpack(const VectorXd& y) {
  if (y.size() != kStateSize) throw std::invalid_argument("unpack: a rigid body's state has 13 numbers");
  return {y.segment<3>(0), Quaterniond(y[3], y[4], y[5], y[6]), y.segment<3>(7), y.segment<3>(10)};
}

}  // namespace tumble
