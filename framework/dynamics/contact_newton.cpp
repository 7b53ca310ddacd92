#include "framework/dynamics/contact_newton.h"

#include <cmath>
#include <limits>

#include <Eigen/LU>

#include "framework/dynamics/contact_cone.h"

namespace tumble::contacts {
namespace {

constexpr double kTie = 1e-9;   // of the problem's speed: a contact this near to opening or sliding is taken as closed, or sticking

/// delta, the compliance of a step over the contact's own give. A full step takes the error in the stiffest direction down by delta over the
/// smallest eigenvalue of W (N^-4 in a stack of N), but rounding grows with 1 / delta: it is lessened where steps turn out slow.
constexpr double kFirstFade = 1e-8, kLeastFade = 1e-11;

/// dp = f - D dv: how one contact's impulse answers.
struct Response {
  Vector3d f;
  Matrix3d d;
};

/// Linearised p = P(p - v / r):  (I - (1 - delta) P') dp = F - P' dv / r,   F = P(z) - p.
Response law_response(const ContactBlock& c, const Vector3d& p, const Vector3d& v, double r, double fade, double tie) {
  const Vector3d z = p - v / r;
  Response response{-p, Matrix3d::Zero()};
  if (z[0] < -tie) return response;  // open
  const double length = z.tail<2>().norm(), radius = c.friction * z[0];
  if (!c.is_frictional() || length <= radius + tie) {
    response.f = -v / (fade * r);
    response.d.diagonal().setConstant(1 / (fade * r));
    if (!c.is_frictional()) response.f.tail<2>().setZero();
    return response;
  }
  const Vector2d t = z.tail<2>() / length;
  Matrix3d slope = Matrix3d::Zero();  // P'
  slope(0, 0) = 1;
  slope.block<2, 1>(1, 0) = c.friction * t;
  slope.block<2, 2>(1, 1) = radius / length * (Eigen::Matrix2d::Identity() - t * t.transpose());
  Vector3d misfit;
  misfit << z[0] - p[0], radius * t - p.tail<2>();
  misfit[0] = -v[0] / r;  // the same, without rounding
  const Matrix3d inverse = (Matrix3d::Identity() - (1 - fade) * slope).inverse();
  response.f = inverse * misfit;
  response.d = inverse * slope / r;
  return response;
}

/// The change of all impulses that one Newton step asks for. Empty: the matrix failed.
bool newton_step(const System& system, double fade, BodyMatrix& matrix, const Impulses& now, Impulses& change) {
  const std::size_t contacts = system.contacts.size(), rows = system.rows.size();
  std::vector<Response> responses(contacts);
  change.contacts.assign(contacts, Vector3d::Zero());
  change.rows.assign(rows, 0.0);
  std::vector<Vector6d> x(now.y.size(), Vector6d::Zero());
  matrix.set_identity();
  for (std::size_t i = 0; i < contacts; ++i) {
    const ContactBlock& c = system.contacts[i];
    if (!(c.give > 0)) continue;
    responses[i] = law_response(c, now.contacts[i], contact_velocity(c, now.y), c.give, fade, kTie * system.speed / c.give);
    push(c, responses[i].f, x);
    if (!responses[i].d.isZero(0)) matrix.add(c, responses[i].d);
  }
  std::vector<double> row_pushes(rows, 0.0);
  for (std::size_t i = 0; i < rows; ++i) {
    const RowBlock& row = system.rows[i];
    if (!(row.give > 0)) continue;
    row_pushes[i] = -row_velocity(row, now.y) / (fade * row.give);
    push(row, row_pushes[i], x);
    matrix.add(row, 1 / (fade * row.give));
  }
  if (!matrix.factorise()) return false;
  matrix.solve(x);
  for (std::size_t i = 0; i < contacts; ++i) {
    ContactBlock const& c = system.contacts[i];
    if (c.give > 0) change.contacts[i] = responses[i].f - responses[i].d * velocity_change(c, x);
  }
  for (std::size_t i = 0; i < rows; ++i) {
    const RowBlock& row = system.rows[i];
    if (row.give > 0) change.rows[i] = row_pushes[i] - velocity_change(row, x) / (fade * row.give);
  }
  return true;
}

/// impulses + share * change, back into the law's set.
Impulses moved(const System& system, const Impulses& impulses, const Impulses& change, double share) {
  Impulses next = impulses;
  for (std::size_t i = 0; i < next.contacts.size(); ++i) {
    next.contacts[i] = coulomb_projection(impulses.contacts[i] + share * change.contacts[i], system.contacts[i].friction);
  }
  for (std::size_t i = 0; i < next.rows.size(); ++i) next.rows[i] += share * change.rows[i];
  sum_impulses(system, next);
  return next;
}

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

/// The problem (C.6) and its derivatives at y.
struct SoftProblem {
  const System& system;
  const Impulses& before;            // p_i
  std::vector<double> shifts;        // g_i
  double compliance;                 // eps over give

  Vector3d argument(std::size_t i, const std::vector<Vector6d>& y) const {
    const ContactBlock& c = system.contacts[i];
    Vector3d v = contact_velocity(c, y);
    v[0] += shifts[i];
    return before.contacts[i] - v / (compliance * c.give);
  }
  double row_argument(std::size_t i, const std::vector<Vector6d>& y) const {
    return before.rows[i] - row_velocity(system.rows[i], y) / (compliance * system.rows[i].give);
  }

  /// y - sum G^T Pi(z); with a matrix, its derivative too.
  std::vector<Vector6d> gradient(const std::vector<Vector6d>& y, BodyMatrix* matrix) const {
    std::vector<Vector6d> result = y;
    if (matrix) matrix->set_identity();
    for (std::size_t i = 0; i < system.contacts.size(); ++i) {
      const ContactBlock& c = system.contacts[i];
      if (!(c.give > 0)) continue;
      const ConeProjection projection = project_on_cone(argument(i, y), c.friction);
      if (projection.p[0] > 0) push(c, -projection.p, result);
      if (matrix && projection.p[0] > 0) matrix->add(c, projection.slope / (compliance * c.give));
    }
    for (std::size_t i = 0; i < system.rows.size(); ++i) {
      const RowBlock& row = system.rows[i];
      if (!(row.give > 0)) continue;
      push(row, -row_argument(i, y), result);
      if (matrix) matrix->add(row, 1 / (compliance * row.give));
    }
    return result;
  }
};

double dot(const std::vector<Vector6d>& a, const std::vector<Vector6d>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i].dot(b[i]);
  return sum;
}

std::vector<Vector6d> along(const std::vector<Vector6d>& y, double share, const std::vector<Vector6d>& direction) {
  std::vector<Vector6d> result = y;
  for (std::size_t i = 0; i < y.size(); ++i) result[i] += share * direction[i];
  return result;
}

/// The step along `direction` at which the slope of (C.6), rising from `slope_0` < 0, has nearly gone. Bracketed secants (Illinois).
double line_search(const SoftProblem& problem, const std::vector<Vector6d>& y, const std::vector<Vector6d>& direction, double slope_0) {
  constexpr double kSmall = 0.1;
  constexpr int kMost = 30;
  const auto slope = [&](double share) { return dot(problem.gradient(along(y, share, direction), nullptr), direction); };
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

}  // namespace

void finish(const System& system, const Goal& goal, int most_steps, BodyMatrix& matrix, Impulses& impulses, Progress& progress) {
  constexpr double kHelps = 0.7;  // a step that leaves more of the violation than this is not of the quadratic kind
  constexpr double kShortest = 0.1;
  constexpr double kSlow = 0.01;  // a full step that leaves more than this may owe it to the fade
  double fade = kFirstFade;
  Impulses change;
  for (int i = 0; i < most_steps; ++i) {
    const bool was_accepted = progress.accepted;
    if (!newton_step(system, fade, matrix, impulses, change)) return;
    ++progress.factorisations;
    double share = 1;
    Impulses next = moved(system, impulses, change, share);
    double violation = largest_violation(system, next);
    while (violation > kHelps * progress.violation && share > kShortest && !was_accepted) {
      share *= 0.5;
      next = moved(system, impulses, change, share);
      violation = largest_violation(system, next);
    }
    if (!(violation < progress.violation)) return;
    const bool helped = violation <= kHelps * progress.violation;
    if (share == 1 && violation > kSlow * progress.violation) fade = std::max(kLeastFade, 0.1 * fade);
    impulses = std::move(next);
    progress.violation = violation;
    progress.accepted = goal.accepts(system, impulses, violation);
    // One step past the goal: the velocities of a high stack are sums of many contacts' violations.
    if (was_accepted || !helped || violation <= rounding_floor(system, impulses)) return;
  }
}

void soften(const System& system, double compliance_over_give, BodyMatrix& matrix, Impulses& impulses, Progress& progress) {
  constexpr int kMostSteps = 40;
  constexpr double kSmall = 1e-6;  // gradient over the size of y: the rounds that follow renew the problem anyway
  SoftProblem problem{system, impulses, std::vector<double>(system.contacts.size(), 0.0), compliance_over_give};
  for (std::size_t i = 0; i < system.contacts.size(); ++i)
    if (system.contacts[i].is_frictional())
      problem.shifts[i] = system.contacts[i].friction * contact_velocity(system.contacts[i], impulses.y).tail<2>().norm();
  std::vector<Vector6d> y = impulses.y;
  for (int i = 0; i < kMostSteps; ++i) {
    const std::vector<Vector6d> gradient = problem.gradient(y, &matrix);
    if (dot(gradient, gradient) <= kSmall * kSmall * (dot(y, y) + system.speed * system.speed * 1e-6)) break;
    if (!matrix.factorise()) break;
    ++progress.factorisations;
    std::vector<Vector6d> direction = gradient;
    matrix.solve(direction);
    for (Vector6d& part : direction) part = -part;
    const double slope = dot(gradient, direction);
    if (!(slope < 0)) break;
    y = along(y, line_search(problem, y, direction, slope), direction);
  }
  Impulses next = impulses;
  for (std::size_t i = 0; i < system.contacts.size(); ++i)
    if (system.contacts[i].give > 0) next.contacts[i] = project_on_cone(problem.argument(i, y), system.contacts[i].friction).p;
  for (std::size_t i = 0; i < system.rows.size(); ++i)
    if (system.rows[i].give > 0) next.rows[i] = problem.row_argument(i, y);
  sum_impulses(system, next);
  impulses = std::move(next);
  progress.violation = largest_violation(system, impulses);
}

void solve_together(const System& system, const Goal& goal, int most_rounds, BodyMatrix& matrix, Impulses& impulses, Progress& progress) {
  constexpr int kMostSteps = 25;
  constexpr double kFirstCompliance = 1e-2, kLeastCompliance = 1e-6;
  Impulses best = impulses;
  double least = progress.violation, compliance = kFirstCompliance;
  const auto keep = [&] {
    if (!(progress.violation < least)) return;
    least = progress.violation;
    best = impulses;
  };
  for (int round = 0; round < most_rounds; ++round) {
    finish(system, goal, kMostSteps, matrix, impulses, progress);
    keep();
    if (progress.accepted) break;
    soften(system, compliance, matrix, impulses, progress);
    keep();
    compliance = std::max(kLeastCompliance, 0.1 * compliance);
  }
  impulses = std::move(best);
  progress.violation = least;
  progress.accepted = goal.accepts(system, impulses, least);
}

}  // namespace tumble::contacts
