/// Numbers of double precision that formulas name.
#pragma once

#include <limits>

namespace tumble {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
// spacing of doubles at 1: 2.2e-16
inline constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

}  // namespace tumble
