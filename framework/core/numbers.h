/// Numbers of double precision that formulas name.
#pragma once

#include <limits>

namespace tumble {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr double kEpsilon = std::numeric_limits<double>::epsilon();   // spacing of doubles at 1: 2.2e-16

}  // namespace tumble
