/// The impulse of an impact at one point, with restitution and friction, on bodies that may be held
/// by links.
///
/// The relative velocity u of A against B at the point changes by K p, where p is the impulse on A
/// and K (3,3) the inverse effective mass of the two at that point: of the free bodies, or of the
/// bodies with what holds them, whose reactions act within the impact.
///   u'_n = u_n + rise
///       (Newton's restitution: rise = -(1 + e) u_n)                                          (I.1)
///   |p_t| <= mu p_n;   where |p_t| < mu p_n: u'_t = 0;   else u'_t = -s p_t, s >= 0
///       (Coulomb: against the final slip)                                                    (I.2)
/// Both are solved together: friction changes the normal velocity wherever K couples the two, so it
/// must not come after.
///
/// Newton's restitution and Coulomb's friction together can create energy (Kane and Levinson 1985):
/// friction that reverses the slip works along the first slip. Then the impulse is p = p_0 + lambda
/// (p_f - p_0), with p_0 the impulse without friction, p_f that of (I.1) and (I.2), and lambda the
/// largest number up to 1 at which the energy u . p + p . K p / 2 does not rise. (I.1) still holds,
/// |p_t| <= mu p_n still holds; there is less friction than Coulomb's. Such a lambda exists,
/// because p_0 never raises the energy for e <= 1. Where K leaves friction no freedom to act with
/// (a hinged bar against a wall), Coulomb's law may have no impulse that satisfies (I.1): a body
/// that wedges. Then friction is left out.
/// Sources: T. Kane, D. Levinson, "Dynamics: theory and applications", 1985; J. J. Moreau, CISM
/// 302, 1988; O. Bonnefon, G. Daviet, "Quartic formulation of Coulomb 3D frictional contact", INRIA
/// RT-400, 2011 (the equation in s).
#pragma once

#include "framework/core/math.h"

namespace tumble {

struct PointImpact {
  Matrix3d inverse_mass_world;   // K, symmetric, positive semi-definite, n . K n > 0 [1/kg]
  Vector3d velocity_world;       // u, of A against B at the point [m/s]
  Vector3d normal_b_to_a_world;  // unit
  double rise;                   // wanted change of the normal velocity, > 0 [m/s]
  double friction;               // mu >= 0
};

struct PointImpulse {
  Vector3d impulse_on_a_world;  // [N s]
  // lambda; below 1 where Coulomb's friction would have created energy
  double friction_share = 1.0;
};

/// The impulse of (I.1) and (I.2), to round-off. Deterministic.
/// @post  n . (u + K p) = u_n + rise;   |p_t| <= mu p_n;   the energy rises by no more than it does
/// without friction
PointImpulse impulse_of(const PointImpact& impact);

/// By how much the kinetic energy of bodies changes by an impulse p at a point where it changes
/// their velocity u by K p: p . u + p . K p / 2. [J]
double energy_of(const Vector3d& impulse_world, const Vector3d& velocity_world,
                 const Matrix3d& inverse_mass_world);

/// The largest x in [0, 1] at which  start + slope x + bend x^2  is not above max(0, start). [-]
/// @param start, slope, bend  energies of impulses p_0 + x (p_1 - p_0): bend >= 0 [J]
double share_without_gain(double start, double slope, double bend);

}  // namespace tumble
