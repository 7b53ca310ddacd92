/// Gauss's method of order 6: implicit, for systems with oscillations much faster than the motion
/// of interest.
#pragma once

#include "framework/dynamics/ode.h"

namespace tumble {

/// y(t) to y(t + h) by collocation at the three Gauss points: the polynomial of degree 3 through y
/// whose slope is f at t + c_i h,
///   k_i = f(t + c_i h, y + h sum_j a_ij k_j),    y(t + h) = y + h sum_i b_i k_i            (G.1)
/// It is symplectic and keeps quadratic invariants (|q|, the energy of a linear oscillator), so it
/// is stable for an oscillation of any frequency w. One with w h > 2 keeps its amplitude, but not
/// its phase. What is damped within less than h decays slowly and with alternating sign: for
/// friction and strong dampers use Rosenbrock's method.
///
/// (G.1) is solved by Newton's method with df/dy at y, by differences. Where that does not end, the
/// two halves of h are taken one after the other, and so on. Numbers of y below 1 count as 1, in
/// the step of a difference and at the iteration's end: y is to come in units of its bodies
/// (state_units.h).
/// @return (n), as y
/// @throws std::runtime_error where no part of h down to a thousandth will do; whatever f throws
/// Source: E. Hairer, G. Wanner, "Solving ODEs II", IV.5 and IV.8; E. Hairer, C. Lubich, G. Wanner,
/// "Geometric Numerical Integration", IV.2.1 and VI.4.
/// Cost: n + 1 evaluations for df/dy, O(n^3) for its factors, 3 evaluations an iteration of some 4
VectorXd gauss_step(const OdeFunction& f, double t, const VectorXd& y, double h);

}  // namespace tumble
