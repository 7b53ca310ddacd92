// Contacts made compliant: the convex problem of given De Saxce shifts, and Coulomb's law on a path
// of falling compliance (contact_newton.h).
#include "framework/dynamics/contact_newton.h"

#include <cmath>

#include "framework/dynamics/contact_cone.h"

namespace tumble::contacts {
namespace {

/// Projection on the friction cone K = {|p_t| <= mu p_n} and its derivative.
struct ConeProjection {
  Vector3d p;
  Matrix3d slope;
};

ConeProjection project_on_cone(const Vector3d& z, double mu) {
  ConeProjection result{Vector3d::Zero(), Matrix3d::Zero()};
  const double length = z.tail<2>().norm();
  if (mu > 0 ? mu * length <= -z[0] : z[0] <= 0) return result;
  if (mu == 0) {
    result.p[0] = z[0];
    result.slope(0, 0) = 1;
    return result;
  }
  if (length <= mu * z[0]) return {z, Matrix3d::Identity()};
  const double share = 1 / (1 + mu * mu), normal = share * (z[0] + mu * length);
  const Vector2d t = z.tail<2>() / length;
  Vector3d edge;
  edge << 1, mu * t;
  const Vector3d side(0, -t[1], t[0]);
  result.p = normal * edge;
  result.slope = share * edge * edge.transpose() + mu * normal / length * side * side.transpose();
  return result;
}

/// P of Coulomb's law (contact_cone.h) and its derivative, which is not symmetric where the contact
/// slides.
ConeProjection project_on_law(const Vector3d& z, double mu) {
  ConeProjection result{coulomb_projection(z, mu), Matrix3d::Zero()};
  if (!(z[0] > 0)) return result;
  result.slope(0, 0) = 1;
  const double length = z.tail<2>().norm(), radius = mu * z[0];
  if (length <= radius) {
    result.slope.setIdentity();
  } else if (mu > 0) {
    const Vector2d t = z.tail<2>() / length;
    result.slope.block<2, 1>(1, 0) = mu * t;
    result.slope.block<2, 2>(1, 1) =
        radius / length * (Eigen::Matrix2d::Identity() - t * t.transpose());
  }
  return result;
}

/// The problem (C.6), or with `law` (C.7), and its derivatives at y.
struct SoftProblem {
  const System& system;
  const Impulses& before;      // p_i
  std::vector<double> shifts;  // g_i
  double compliance;           // eps over give
  // (C.7): project on Coulomb's law instead of the cone; no shifts
  bool law = false;

  Vector3d argument(std::size_t i, const std::vector<Vector6d>& y) const {
    const ContactBlock& c = system.contacts[i];
    Vector3d v = contact_velocity(c, y);
    v[0] += shifts[i];
    return before.contacts[i] - v / (compliance * c.inverse_effective_mass);
  }
  double row_argument(std::size_t i, const std::vector<Vector6d>& y) const {
    return before.rows[i] -
           row_velocity(system.rows[i], y) / (compliance * system.rows[i].inverse_effective_mass);
  }

  ConeProjection project(std::size_t i, const std::vector<Vector6d>& y) const {
    const Vector3d z = argument(i, y);
    return law ? project_on_law(z, system.contacts[i].friction)
               : project_on_cone(z, system.contacts[i].friction);
  }

  /// y - sum G^T Pi(z); with a matrix, its derivative too.
  std::vector<Vector6d> gradient(const std::vector<Vector6d>& y, BodyMatrix* matrix) const {
    std::vector<Vector6d> result = y;
    if (matrix) matrix->set_identity();
    for (std::size_t i = 0; i < system.contacts.size(); ++i) {
      const ContactBlock& c = system.contacts[i];
      if (!(c.inverse_effective_mass > 0)) continue;
      const ConeProjection projection = project(i, y);
      if (projection.p[0] > 0) push(c, -projection.p, result);
      if (matrix && projection.p[0] > 0)
        matrix->add(c, projection.slope / (compliance * c.inverse_effective_mass));
    }
    for (std::size_t i = 0; i < system.rows.size(); ++i) {
      const RowBlock& row = system.rows[i];
      if (!(row.inverse_effective_mass > 0)) continue;
      push(row, -row_argument(i, y), result);
      if (matrix) matrix->add(row, 1 / (compliance * row.inverse_effective_mass));
    }
    return result;
  }
};

double dot(const std::vector<Vector6d>& a, const std::vector<Vector6d>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i].dot(b[i]);
  return sum;
}

std::vector<Vector6d> along(const std::vector<Vector6d>& y, double share,
                            const std::vector<Vector6d>& direction) {
  std::vector<Vector6d> result = y;
  for (std::size_t i = 0; i < y.size(); ++i) result[i] += share * direction[i];
  return result;
}

/// The step along `direction` at which the slope of (C.6), rising from `slope_0` < 0, has nearly
/// gone. Bracketed secants (Illinois).
double line_search(const SoftProblem& problem, const std::vector<Vector6d>& y,
                   const std::vector<Vector6d>& direction, double slope_0) {
  constexpr double kSmall = 0.1;
  constexpr int kMost = 30;
  const auto slope = [&](double share) {
    return dot(problem.gradient(along(y, share, direction), nullptr), direction);
  };
  double low = 0, high = 1, at_low = slope_0, at_high = slope(1);
  if (at_high <= kSmall * std::abs(slope_0)) return 1;
  double share = 1;
  for (int i = 0; i < kMost; ++i) {
    share = low + (high - low) * at_low / (at_low - at_high);
    const double here = slope(share);
    if (std::abs(here) <= kSmall * std::abs(slope_0)) break;
    if (here > 0) {
      high = share;
      at_high = here;
      at_low *= 0.5;
    } else {
      low = share;
      at_low = here;
      at_high *= 0.5;
    }
  }
  return share;
}

/// The impulses that belong to y become those of `progress`.
void take_over(const SoftProblem& problem, const std::vector<Vector6d>& y, const Goal& goal,
               Progress& progress) {
  Impulses next = progress.impulses;
  for (std::size_t i = 0; i < next.contacts.size(); ++i)
    if (problem.system.contacts[i].inverse_effective_mass > 0)
      next.contacts[i] = problem.project(i, y).p;
  for (std::size_t i = 0; i < next.rows.size(); ++i)
    if (problem.system.rows[i].inverse_effective_mass > 0)
      next.rows[i] = problem.row_argument(i, y);
  sum_impulses(problem.system, next);
  progress.impulses = std::move(next);
  goal.measure(progress);
}

/// What rounding leaves of the gradient where impulses of this size cancel in y, as in a pile at
/// rest. In units of y.
double gradient_rounding(const System& system, const Impulses& impulses) {
  double squares = 0;
  for (std::size_t i = 0; i < system.contacts.size(); ++i)
    squares += system.contacts[i].inverse_effective_mass * impulses.contacts[i].squaredNorm();
  for (std::size_t i = 0; i < system.rows.size(); ++i)
    squares += system.rows[i].inverse_effective_mass * impulses.rows[i] * impulses.rows[i];
  return rounding_of(std::sqrt(squares));
}

}  // namespace

bool soften(const Goal& goal, double compliance_over_give, BodyMatrix& matrix, Progress& progress) {
  constexpr int kMostSteps = 40;
  // gradient over the size of y: the rounds that follow renew the problem anyway
  constexpr double kSmall = 1e-6;
  const System& system = goal.system;
  SoftProblem problem{system, progress.impulses, std::vector<double>(system.contacts.size(), 0.0),
                      compliance_over_give};
  std::vector<Vector6d> y = progress.impulses.y;
  for (std::size_t i = 0; i < system.contacts.size(); ++i)
    if (system.contacts[i].is_frictional())
      problem.shifts[i] =
          system.contacts[i].friction * contact_velocity(system.contacts[i], y).tail<2>().norm();
  const double rounding = gradient_rounding(system, progress.impulses);
  bool there = false;
  for (int i = 0; i < kMostSteps && !there; ++i) {
    const std::vector<Vector6d> gradient = problem.gradient(y, &matrix);
    const double left = dot(gradient, gradient);
    there = left <= kSmall * kSmall * dot(y, y) || left <= rounding * rounding;
    if (there || !matrix.factorise()) break;
    ++progress.factorisations;
    std::vector<Vector6d> direction = gradient;
    matrix.solve(direction);
    for (Vector6d& part : direction) part = -part;
    const double slope = dot(gradient, direction);
    if (!(slope < 0)) break;
    y = along(y, line_search(problem, y, direction, slope), direction);
  }
  if (!there) return false;
  take_over(problem, y, goal, progress);
  return true;
}

void follow(const Goal& goal, double compliance_over_give, BodyMatrix& matrix, Progress& progress) {
  constexpr int kMostSteps = 15;
  constexpr double kSmall = 1e-12;  // of |y|^2: this is one point of a path, no answer
  constexpr double kShortest = 1e-3;
  Impulses nothing = progress.impulses;
  for (Vector3d& p : nothing.contacts) p.setZero();
  for (double& p : nothing.rows) p = 0;
  const SoftProblem problem{goal.system, nothing,
                            std::vector<double>(goal.system.contacts.size(), 0.0),
                            compliance_over_give, true};
  std::vector<Vector6d> y = progress.impulses.y;
  std::vector<Vector6d> direction = problem.gradient(y, &matrix);
  double square = dot(direction, direction);
  for (int i = 0; i < kMostSteps && square > kSmall * dot(y, y) && matrix.factorise(); ++i) {
    ++progress.factorisations;
    matrix.solve(direction);
    double share = 1, next = square;
    for (; share > kShortest; share *= 0.5) {
      const std::vector<Vector6d> gradient = problem.gradient(along(y, -share, direction), nullptr);
      next = dot(gradient, gradient);
      if (next < (1 - 0.1 * share) * square) break;
    }
    y = along(y, -share, direction);
    direction = problem.gradient(y, &matrix);
    square = next;
  }
  take_over(problem, y, goal, progress);
}

}  // namespace tumble::contacts
