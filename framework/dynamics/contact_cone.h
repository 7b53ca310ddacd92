/// Coulomb's law at one contact: projections, and the impulse of one contact alone. Internal to
/// dynamics.
///
/// (C.1) and (C.2) together say, for any r > 0,   p = P(p - v / r),   P(z) = (max(0, z_n), z_t
/// brought into the disk of radius mu P_n) (P. Alart, A. Curnier, Comput. Methods Appl. Mech. Eng.
/// 92, 1991).
#pragma once

#include <algorithm>
#include <cmath>

#include "framework/core/math.h"

namespace tumble::contacts {

inline Vector3d coulomb_projection(const Vector3d& z, double friction) {
  const double normal = std::max(0.0, z[0]);
  const double radius = friction * normal, length = std::sqrt(z[1] * z[1] + z[2] * z[2]);
  if (length <= radius) return {normal, z[1], z[2]};
  const double shrink = length > 0 ? radius / length : 0.0;
  return {normal, shrink * z[1], shrink * z[2]};
}

/// One contact alone, its W_ii prepared: what Gauss-Seidel solves exactly.
struct LocalContact {
  double w_nn = 0;
  Matrix3d w = Matrix3d::Zero();
  // eigenvalues of S = W_tt - w_tn w_tn^T / w_nn
  double stiff_1 = 0, stiff_2 = 0;
  // first eigenvector in the tangent plane
  double cosine = 1, sine = 0;
  double coupling_1 = 0, coupling_2 = 0;  // w_tn along the eigenvectors
  double coupling = 0;                    // their length
  // s of (C.5) in the last answer; 0: it did not slide
  double slide = 0;
};

LocalContact prepare_local(const Matrix3d& w);

/// The impulse p of a contact whose velocity is  W p + free  : (C.1) and (C.2) to round-off.
///   sliding:  (W_tt + s I) p_t + w_tn p_n + free_t = 0,   v_n = 0,   |p_t| = mu p_n,
///       s >= 0                                                                               (C.5)
/// One equation in s after p_n is eliminated; |p_t(s)| - mu p_n(s) changes its sign between 0 and a
/// closed bound, so there is always an answer (with strong coupling up to three: the one that
/// Newton's iteration, kept in the bracket, reaches from the last answer's s, which it leaves in
/// `local`).
/// Source: O. Bonnefon, G. Daviet, "Quartic formulation of Coulomb 3D frictional contact", INRIA
/// RT-400, 2011.
Vector3d solve_local(LocalContact& local, const Vector3d& free, double friction);

}  // namespace tumble::contacts
