#include "framework/dynamics/contact_equations.h"

#include <cmath>
#include <limits>
#include <utility>

namespace tumble::contacts {

bool StepEquations::prepare(const System& system, double fade, BodyMatrix& matrix,
                            const Impulses& now, std::vector<Response> responses) {
  system_ = &system;
  fade_ = fade;
  responses_ = std::move(responses);
  row_pushes_.assign(system.rows.size(), 0.0);
  matrix.set_identity();
  for (std::size_t i = 0; i < responses_.size(); ++i)
    if (responses_[i].d(0, 0) != 0) matrix.add(system.contacts[i], responses_[i].d);
  for (std::size_t i = 0; i < row_pushes_.size(); ++i) {
    const RowBlock& row = system.rows[i];
    if (!(row.inverse_effective_mass > 0)) continue;
    row_pushes_[i] = -row_velocity(row, now.y) / (fade * row.inverse_effective_mass);
    matrix.add(row, 1 / (fade * row.inverse_effective_mass));
  }
  return matrix.factorise();
}

/// change += rest - D G H^-1 G^T rest.
void StepEquations::add_solution(const BodyMatrix& matrix, Impulses& change) {
  const System& system = *system_;
  x_.assign(system.root_inverse_mass.size(), Vector6d::Zero());
  for (std::size_t i = 0; i < rest_.size(); ++i) push(system.contacts[i], rest_[i], x_);
  for (std::size_t i = 0; i < row_rest_.size(); ++i) push(system.rows[i], row_rest_[i], x_);
  matrix.solve(x_);
  for (std::size_t i = 0; i < rest_.size(); ++i)
    change.contacts[i] += rest_[i] - responses_[i].d * velocity_change(system.contacts[i], x_);
  for (std::size_t i = 0; i < row_rest_.size(); ++i)
    if (system.rows[i].inverse_effective_mass > 0)
      change.rows[i] += row_rest_[i] - velocity_change(system.rows[i], x_) /
                                           (fade_ * system.rows[i].inverse_effective_mass);
}

/// rest := f - dp - D G G^T dp; returns its largest part as a velocity.
double StepEquations::renew_rest(const Impulses& change) {
  const System& system = *system_;
  double largest = 0;
  x_.assign(system.root_inverse_mass.size(), Vector6d::Zero());
  for (std::size_t i = 0; i < rest_.size(); ++i) push(system.contacts[i], change.contacts[i], x_);
  for (std::size_t i = 0; i < row_rest_.size(); ++i) push(system.rows[i], change.rows[i], x_);
  for (std::size_t i = 0; i < rest_.size(); ++i) {
    rest_[i] = responses_[i].f - change.contacts[i] -
               responses_[i].d * velocity_change(system.contacts[i], x_);
    largest =
        std::max(largest, fade_ * system.contacts[i].inverse_effective_mass * rest_[i].norm());
  }
  for (std::size_t i = 0; i < row_rest_.size(); ++i) {
    if (!(system.rows[i].inverse_effective_mass > 0)) continue;
    const double stiffness = 1 / (fade_ * system.rows[i].inverse_effective_mass);
    row_rest_[i] =
        row_pushes_[i] - change.rows[i] - stiffness * velocity_change(system.rows[i], x_);
    largest = std::max(largest, std::abs(row_rest_[i]) / stiffness);
  }
  return largest;
}

bool StepEquations::solve(const BodyMatrix& matrix, double violation, Impulses& change) {
  constexpr int kMostPasses = 4;
  constexpr double kSmall = 1e-3;
  change.contacts.assign(responses_.size(), Vector3d::Zero());
  change.rows.assign(row_pushes_.size(), 0.0);
  rest_.resize(responses_.size());
  for (std::size_t i = 0; i < rest_.size(); ++i) rest_[i] = responses_[i].f;
  row_rest_ = row_pushes_;
  double before = std::numeric_limits<double>::infinity();
  for (int pass = 0; pass < kMostPasses; ++pass) {
    add_solution(matrix, change);
    const double left = renew_rest(change);
    if (left <= kSmall * violation) return true;
    if (!(left < 0.5 * before)) return false;
    before = left;
  }
  return false;
}

}  // namespace tumble::contacts
