/// The linear equations of one step of Newton's method on a contact problem. Internal to dynamics.
///
/// A contact's law, linearised, says how its impulse answers a change of its velocity; all answers
/// together are one matrix of 6 rows a body (contact_matrix.h).
#pragma once

#include <vector>

#include "framework/dynamics/contact_matrix.h"
#include "framework/dynamics/contact_system.h"

namespace tumble::contacts {

/// dp = f - D dv: how one contact's impulse answers.
struct Response {
  Vector3d f;
  Matrix3d d;
};

/// The linear equations of one Newton step:   dp + D G (G^T dp) = f   for all contacts and rows at
/// once.
class StepEquations {
 public:
  /// @param responses  by contact; f of the rows is their velocity, their D is 1 / (fade give)
  /// @return whether the matrix could be factorised
  bool prepare(const System& system, double fade, BodyMatrix& matrix, const Impulses& now,
               std::vector<Response> responses);
  /// The change of all impulses, refined until what is left of the equations is small beside
  /// `violation`. True if it got so far.
  bool solve(const BodyMatrix& matrix, double violation, Impulses& change);

 private:
  void add_solution(const BodyMatrix& matrix, Impulses& change);
  double renew_rest(const Impulses& change);

  const System* system_ = nullptr;
  double fade_ = 0;
  std::vector<Response> responses_;
  std::vector<double> row_pushes_;  // f of the rows; their D is 1 / (fade give)
  std::vector<Vector3d> rest_;      // what the equations still lack
  std::vector<double> row_rest_;
  std::vector<Vector6d> x_;
};

}  // namespace tumble::contacts
