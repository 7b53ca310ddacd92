/// Methods to compare with, as laws of the engine: some that hold where others do not, and some
/// that are known not to hold.
#pragma once

#include "framework/dynamics/laws.h"

namespace tumble::battery {

/// The same laws with another method of integration.
Laws with_method(
    Laws laws, const std::string& name,
    std::function<VectorXd(const OdeFunction&, double t, const VectorXd& y, double h)> step);

// All take packed states (13 numbers a body), or (place, velocity) of a swing.
VectorXd explicit_euler(const OdeFunction& f, double t, const VectorXd& y, double h);
/// Momenta first, then places with the new momenta.
VectorXd symplectic_euler(const OdeFunction& f, double t, const VectorXd& y, double h);
/// Half a step of momenta, a step of places, half a step of momenta (Stoermer, Verlet).
VectorXd verlet(const OdeFunction& f, double t, const VectorXd& y, double h);
/// y1 = y0 + h f((y0 + y1) / 2), by fixed-point iteration to rounding: for w h below 2.
VectorXd implicit_midpoint(const OdeFunction& f, double t, const VectorXd& y, double h);
VectorXd rk4(const OdeFunction& f, double t, const VectorXd& y, double h);
/// Dormand and Prince's pair of orders 5 and 4 with step control (Boost.Odeint), as many steps as
/// the tolerance asks for.
std::function<VectorXd(const OdeFunction&, double, const VectorXd&, double)> dormand_prince(
    double tolerance);

/// A step of a free symmetric top by two exponential maps, exact but for rounding: the spin about
/// the body's z that is not precession,
/// then the precession about L:  q1 = exp(h L / I_1) q exp(h w_3 (1 - I_3 / I_1) e_3).   Source:
/// Landau, Lifshitz, "Mechanics", section 33.
/// @param L_world  angular momentum [kg m^2/s]  @param moments  of the body's axes, the first two
///                 equal [kg m^2]
Quaterniond exponential_step(const Quaterniond& world_from_body, const Vector3d& L_world,
                             const Vector3d& moments, double h);

/// Multipliers by so many sweeps of Gauss and Seidel from a cold start: what engines for games do.
Laws with_gauss_seidel(Laws laws, int sweeps);

}  // namespace tumble::battery
