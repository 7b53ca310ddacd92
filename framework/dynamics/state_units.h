/// Units of a body's own size, in which a method of integration may compare all numbers of a state
/// with one tolerance.
///
/// In SI units it may not: 1e-9 of a kg m^2/s is nothing to a lorry and everything to a coin, whose
/// momenta it would then not follow at all. In units of the body
///   place / l,   orientation,   momentum / (m l / s),   angular momentum / (I / s)         (U.1)
///   l: its radius of gyration, or the size of what it is linked in [m]: its longest rod or spring,
///      its largest radius of gyration, but of point masses, which have no size
///   m: its mass [kg];  I = m r^2, r: its radius of gyration: a mean moment of inertia [kg m^2]
/// an error counts as a part of l, as an angle, as a velocity in l a second, and as an angular
/// velocity in radians a second: the same for a scene in other units of length and mass. Of a body
/// of 1 kg and r = 1 m these are the numbers in SI units.
///
/// Units are rounded to powers of two: changing to them and back leaves every bit.
#pragma once

#include "framework/dynamics/laws.h"

namespace tumble {

/// The power of two nearest to this in ratio. @param value  > 0 and finite
double nearest_power_of_two(double value);

/// sqrt(tr I / (3 m)) [m]; 0 for a body without size.
double radius_of_gyration(const Inertia& inertia);

/// (U.1): the units of a packed state, (13), each a power of two.
/// @param length  l; 0: where nothing has a size, 1 m
/// @pre the body is movable
VectorXd units_of_state(const Inertia& inertia, double length);

/// One step by the laws' integration: y(t) to y(t + h), in units where the laws ask for them
/// (Laws::steps_in_units).
/// @param units  (n), powers of two; not looked at where the laws do not ask for units
/// Cost: two products of n numbers an evaluation of f, where the laws ask for units; else nothing
VectorXd integrate_by(const Laws& laws, const OdeFunction& f, double t, const VectorXd& y, double h,
                      const VectorXd& units);

}  // namespace tumble
