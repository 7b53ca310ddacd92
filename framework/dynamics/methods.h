/// Methods of integration to compare with, by name: each is a step that can stand in the laws'
/// place (Laws::integrate_step).
///
/// All take any y; symplectic ones take packed states (13 numbers a body) or the (place, velocity)
/// of a swing, since they must know places from momenta. Controlled methods cut the step that they
/// are given into as many as their tolerance asks for.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "framework/dynamics/ode.h"

namespace tumble {

/// y(t) to y(t + h).
using StepFunction =
    std::function<VectorXd(const OdeFunction& f, double t, const VectorXd& y, double h)>;

struct Method {
  std::string word;  // on the command line: "dopri5"
  std::string name;  // for people: "Dormand-Prince 5(4)"
  double order;      // p: the error goes as h^p; NaN where the method chooses its own
  bool controlled;   // takes a tolerance, and chooses its steps by it
  // for stiff systems: its price a step is higher, and its steps are not bounded by stability
  bool implicit;
};

/// In the order in which they are drawn: euler, symplectic, midpoint, verlet, rk4, dopri5,
/// fehlberg78, bulirsch-stoer, rosenbrock4, gauss6.
const std::vector<Method>& methods();

/// @throws UserError naming the known words
const Method& method_named(const std::string& word);

/// Whether it compares numbers of y with one size, 1 or a tolerance: laws with such a method say so
/// (Laws::steps_in_units), and get states in units of the bodies.
inline bool needs_units(const Method& method) { return method.controlled || method.implicit; }

/// The method as a step.
/// @param tolerance  of a controlled method: error a step it allows itself, absolute and relative,
/// > 0, the same for all numbers of y as they come; not looked at by others. In a run the absolute
/// one is in units of the bodies (dynamics/state_units.h): 1e-6 is a millionth of a body's size, of
/// that size a second, of a radian, of a radian a second.
/// A controlled method takes back a trial in which f throws (but UserError and NotImplemented), or
/// which ends in a value that is not a number, and tries a quarter of it. It throws
/// std::runtime_error where no step will do (none of 1e-12 of h), or it would need more than 1e6
/// steps inside one.
/// Source: E. Hairer, S. P. Norsett, G. Wanner, "Solving ODEs I", II.4-II.9; "II", IV.7;
/// implementations: Boost.Odeint.
StepFunction step_of(const Method& method, double tolerance);

}  // namespace tumble
