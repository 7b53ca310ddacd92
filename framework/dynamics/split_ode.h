/// A right-hand side y' = f(t, y) of which the rates of places can be had alone.
///
/// A symplectic step wants accelerations at one state and the rates of places at another. Rates of
/// places follow from velocities, which is cheap; accelerations ask for all forces and joints.
#pragma once

#include <utility>

#include "framework/dynamics/ode.h"

namespace tumble {

/// As an OdeFunction it is `whole`; what asks by rates_of_places gets `places`.
struct SplitOde {
  OdeFunction whole;
  OdeFunction places;  ///< (n), right in the places' numbers; what stands in the others is not said
  VectorXd operator()(double t, const VectorXd& y) const { return whole(t, y); }
};

/// y' in the numbers that are places; what stands in the others is not said.
/// Cost: the whole of f where it is not split. A function that only calls f is not.
inline VectorXd rates_of_places(const OdeFunction& f, double t, const VectorXd& y) {
  const auto* split = f.target<SplitOde>();
  return split ? split->places(t, y) : f(t, y);
}

}  // namespace tumble
