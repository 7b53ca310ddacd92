/// Iterative solvers to compare with: what the tolerance of a solver costs, and what it does to a
/// motion. Each can stand in the place of a law that solves to the last digit
/// (Laws::constraint_multipliers, constraint_correction, contact_forces, friction_impulses).
///
/// They show what engines pay that stop their sweeps early; nothing in the framework uses them
/// otherwise.
#pragma once

#include "framework/dynamics/laws.h"

namespace tumble {

/// Multipliers and corrections by conjugate gradients on J M^-1 J^T, without ever making that
/// matrix: until the residual is at most tolerance times the right-hand side (both in the 2-norm),
/// or it falls no further.
/// @param tolerance  > 0
/// Source: M. Hestenes, E. Stiefel, "Methods of conjugate gradients", J. Res. NBS 49 (1952); J.
/// Shewchuk, "An introduction to the conjugate gradient method without the agonizing pain", 1994,
/// B2.
/// Cost: O(rows) an iteration; as many iterations as the root of the condition number, which grows
/// with the length of a chain.
void solve_links_by_gradients(double tolerance, Laws& laws);

/// Contact forces by projected Gauss-Seidel sweeps: without friction until no force changes by more
/// than tolerance times the largest; with friction contact by contact, from the last step's
/// impulses, until (C.1) to (C.3) hold to tolerance times the problem's speed; or 1e5 and 1e4
/// sweeps. What is heavy on what is light, or high, takes many.
/// Source: R. Cottle, J. Pang, R. Stone, "The linear complementarity problem", 5.2 (projected SOR,
/// relaxation 1).
void solve_contacts_by_sweeps(double tolerance, Laws& laws);

/// Contacts with friction by the framework's own means (Newton's method from a guess, then sweeps),
/// which end at this tolerance, relative to the problem's speed, instead of at the last digit.
/// Those without friction keep the laws' contact_forces, which have no tolerance.
void solve_contacts_by_newton(double tolerance, Laws& laws);

}  // namespace tumble
