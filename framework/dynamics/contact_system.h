/// A contact problem made ready for solvers: mass-weighted coordinates, one small block of numbers
/// a contact. Internal to dynamics.
///
/// With M^-1 = L L^T body by body, the velocities are u = u_free + L y. Then
///   v_i = base_i + G_i y,     y = sum G_i^T p_i,     G_i = J_i L,     W_ij = G_i G_j^T       (C.4)
/// where v_i is (normal, tangent 1, tangent 2), the target already taken off the normal. Bodies
/// that cannot be pushed have no part of y; directions in which a body cannot move (zero inverse
/// inertia) have a zero row of L. No mass is ever divided by.
/// Source: V. Acary, B. Brogliato, "Numerical methods for nonsmooth dynamical systems", 2008, ch.
/// 13 (Delassus operator W).
#pragma once

#include <vector>

#include "framework/dynamics/contact_problem.h"

namespace tumble::contacts {

using Jacobian = Eigen::Matrix<double, 3, 6, Eigen::RowMajor>;

// in place of the index of a body that cannot be pushed
inline constexpr int kFixed = -1;

struct ContactBlock {
  int body_a = kFixed, body_b = kFixed;
  double friction = 0;
  // mean of W_ii's diagonal: velocity per impulse [1/kg]; 0: nothing moves
  double inverse_effective_mass = 0;
  // G_i; rows n, t1, t2; without friction only the first is set
  Jacobian g_a, g_b;
  Vector3d base = Vector3d::Zero();  // v_i without impulses [m/s]
  // of the surface along the normal: v_n grows by this times p_n [1/kg]; only while a load is
  // spread (contact_spread.h)
  double compliance = 0;
  Matrix3d contact_from_world;  // rows n, t1, t2
  bool is_frictional() const { return friction > 0; }
};

struct RowBlock {
  int body_a = kFixed, body_b = kFixed;
  // W_ii [1/kg, or what the row's units make of it]
  double inverse_effective_mass = 0;
  Vector6d g_a, g_b;
  double base = 0;
};

/// The constant part of a problem.
struct System {
  std::vector<ContactBlock> contacts;
  std::vector<RowBlock> rows;
  // by body: L = diag(this, root_inverse_inertia)
  std::vector<double> root_inverse_mass;
  std::vector<Matrix3d> root_inverse_inertia;  // by body, lower triangular
  // largest speed of a touching point or of a target [m/s]
  double speed = 0;
};

/// The unknowns. The velocities follow from the impulses; y keeps their sum.
struct Impulses {
  std::vector<Vector3d> contacts;  // (n, t1, t2) [N s]
  std::vector<double> rows;
  std::vector<Vector6d> y;  // by body
};

System build_system(const ContactProblem& problem);
/// The mean of W_ii's diagonal.
double diagonal_mean(const ContactBlock& block);
/// The warm start of the problem, made to obey |p_t| <= mu p_n.
Impulses warm_start_of(const System& system, const ContactProblem& problem);
/// y from the impulses, summed anew in a fixed order: what rounding has gathered in y goes.
void sum_impulses(const System& system, Impulses& impulses);

/// v += G y.
inline void add_velocity(const ContactBlock& c, const std::vector<Vector6d>& y, Vector3d& v) {
  if (!c.is_frictional()) {
    if (c.body_a != kFixed) v[0] += c.g_a.row(0).dot(y[c.body_a]);
    if (c.body_b != kFixed) v[0] += c.g_b.row(0).dot(y[c.body_b]);
    return;
  }
  if (c.body_a != kFixed) v.noalias() += c.g_a * y[c.body_a];
  if (c.body_b != kFixed) v.noalias() += c.g_b * y[c.body_b];
}

inline Vector3d contact_velocity(const ContactBlock& c, const std::vector<Vector6d>& y) {
  Vector3d v = c.base;
  add_velocity(c, y, v);
  return v;
}

/// With what the surface yields.
inline Vector3d yielding_velocity(const ContactBlock& c, const Vector3d& impulse,
                                  const std::vector<Vector6d>& y) {
  Vector3d v = contact_velocity(c, y);
  if (c.compliance > 0) v[0] += c.compliance * impulse[0];
  return v;
}

/// G y: what a change of y changes. Not a difference of two velocities, which would round it away.
inline Vector3d velocity_change(const ContactBlock& c, const std::vector<Vector6d>& y) {
  Vector3d v = Vector3d::Zero();
  add_velocity(c, y, v);
  return v;
}

inline double velocity_change(const RowBlock& r, const std::vector<Vector6d>& y) {
  return (r.body_a != kFixed ? r.g_a.dot(y[r.body_a]) : 0.0) +
         (r.body_b != kFixed ? r.g_b.dot(y[r.body_b]) : 0.0);
}

inline double row_velocity(const RowBlock& r, const std::vector<Vector6d>& y) {
  return r.base + velocity_change(r, y);
}

inline void push(const ContactBlock& c, const Vector3d& impulse, std::vector<Vector6d>& y) {
  if (!c.is_frictional()) {
    if (c.body_a != kFixed) y[c.body_a] += impulse[0] * c.g_a.row(0).transpose();
    if (c.body_b != kFixed) y[c.body_b] += impulse[0] * c.g_b.row(0).transpose();
    return;
  }
  if (c.body_a != kFixed) y[c.body_a].noalias() += c.g_a.transpose() * impulse;
  if (c.body_b != kFixed) y[c.body_b].noalias() += c.g_b.transpose() * impulse;
}

inline void push(const RowBlock& r, double impulse, std::vector<Vector6d>& y) {
  if (r.body_a != kFixed) y[r.body_a] += impulse * r.g_a;
  if (r.body_b != kFixed) y[r.body_b] += impulse * r.g_b;
}

/// How far the impulses are from (C.1) to (C.3), as velocities:  give |p - P(p - v / give)|,  P as
/// in contact_cone.h.
struct Violation {
  double largest = 0;  // [m/s]
  double squares = 0;  // sum of their squares [m^2/s^2]
};
Violation measure_violation(const System& system, const Impulses& impulses);

/// Below this no iteration gets: what the rounding of the largest impulse alone does to a velocity.
double rounding_floor(const System& system, const Impulses& impulses);
/// The same from the largest impulse, as a velocity: over contacts and rows, of their inverse
/// effective mass times the largest part of their impulse. [m/s]
double rounding_of(double largest);

}  // namespace tumble::contacts
