/// Roots of a scalar function of time: the types that root finders and collision detection share.
#pragma once

#include <functional>

#include "framework/core/math.h"

namespace tumble {

/// A scalar function of time whose change of sign is sought, e.g. the gap between two bodies [m].
using ScalarFunction = std::function<double(double t)>;

enum class RootStatus {
  kConverged,  // the bracket is as small as requested, or the function is exactly zero
  // f does not go from + (or 0) to - (or 0): no impact seen, or overlap from the start. Nothing was
  // searched
  kNoSignChange,
  // the search ended with a larger bracket: f was NaN, or a method's own iteration limit was
  // reached; `time` is the best so far
  kNotConverged,
};

/// What a root finder found, and how good it is.
struct RootResult {
  RootStatus status = RootStatus::kNotConverged;
  double time = kUnset;      // [s]
  double residual = kUnset;  // f(time)
  int evaluations = 0;       // of f (not of its derivative)
};

}  // namespace tumble
