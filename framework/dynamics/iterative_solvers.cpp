#include "framework/dynamics/iterative_solvers.h"

#include <algorithm>
#include <cmath>

#include "framework/core/error.h"
#include "framework/dynamics/solve_contacts.h"

namespace tumble {
namespace {

constexpr int kMostSweeps = 100000;
constexpr int kMostSweepsWithFriction = 10000;  // each is a hundred times as dear
// in exact arithmetic one a row is enough; round-off makes it more
constexpr int kIterationsARow = 20;

using Constraints = std::vector<Constraint>;
using Bodies = std::vector<ConstrainedBody>;

Vector6d accelerated(const ConstrainedBody& body, const Vector6d& push) {
  Vector6d u;
  u << body.inverse_mass * push.head<3>(), body.inverse_inertia_world * push.tail<3>();
  return u;
}

/// M^-1 J^T lambda, (6n).
VectorXd motion_of(const Constraints& constraints, const Bodies& bodies, const VectorXd& lambda) {
  VectorXd push = VectorXd::Zero(6 * static_cast<Eigen::Index>(bodies.size()));
  for (std::size_t i = 0; i < constraints.size(); ++i) {
    push.segment<6>(6 * constraints[i].body_a) +=
        lambda[static_cast<Eigen::Index>(i)] * constraints[i].row.jacobian_a;
    push.segment<6>(6 * constraints[i].body_b) +=
        lambda[static_cast<Eigen::Index>(i)] * constraints[i].row.jacobian_b;
  }
  for (std::size_t k = 0; k < bodies.size(); ++k)
    push.segment<6>(6 * static_cast<Eigen::Index>(k)) =
        accelerated(bodies[k], push.segment<6>(6 * static_cast<Eigen::Index>(k)));
  return push;
}

/// J u, (m).
VectorXd along(const Constraints& constraints, const VectorXd& u) {
  VectorXd along(static_cast<Eigen::Index>(constraints.size()));
  for (std::size_t i = 0; i < constraints.size(); ++i)
    along[static_cast<Eigen::Index>(i)] =
        constraints[i].row.jacobian_a.dot(u.segment<6>(6 * constraints[i].body_a)) +
        constraints[i].row.jacobian_b.dot(u.segment<6>(6 * constraints[i].body_b));
  return along;
}

/// J M^-1 J^T lambda = right
VectorXd gradients(const Constraints& constraints, const Bodies& bodies, const VectorXd& right,
                   double tolerance) {
  VectorXd lambda = VectorXd::Zero(right.size()), residual = right, direction = right;
  double size = residual.squaredNorm();
  const double enough = tolerance * tolerance * size;
  for (Eigen::Index k = 0; k < kIterationsARow * right.size() && size > enough; ++k) {
    const VectorXd pushed = along(constraints, motion_of(constraints, bodies, direction));
    const double curvature = direction.dot(pushed);
    // a redundant row, or round-off: nothing more is to be had in this direction
    if (!(curvature > 0.0)) break;
    const double step = size / curvature;
    lambda += step * direction;
    residual -= step * pushed;
    const double next = residual.squaredNorm();
    direction = residual + (next / size) * direction;
    size = next;
  }
  return lambda;
}

}  // namespace

void solve_links_by_gradients(double tolerance, Laws& laws) {
  require(tolerance > 0.0, "dynamics: an iterative solver needs a tolerance > 0");
  laws.constraint_multipliers = [tolerance](const Constraints& constraints, const Bodies& bodies,
                                            const VectorXd& wanted) -> VectorXd {
    // C'' = J (u' + M^-1 J^T lambda) + J' u  is what is wanted.
    VectorXd free(6 * static_cast<Eigen::Index>(bodies.size()));
    for (std::size_t k = 0; k < bodies.size(); ++k)
      free.segment<6>(6 * static_cast<Eigen::Index>(k)) = bodies[k].free_acceleration;
    VectorXd right = wanted - along(constraints, free);
    for (std::size_t i = 0; i < constraints.size(); ++i)
      right[static_cast<Eigen::Index>(i)] -= constraints[i].row.velocity_product;
    return gradients(constraints, bodies, right, tolerance);
  };
  laws.constraint_correction = [tolerance](const Constraints& constraints, const Bodies& bodies,
                                           const VectorXd& error) -> VectorXd {
    return motion_of(constraints, bodies, gradients(constraints, bodies, -error, tolerance));
  };
  laws.link_solver = "conjugate gradients";
}

void solve_contacts_by_sweeps(double tolerance, Laws& laws) {
  require(tolerance > 0.0, "dynamics: an iterative solver needs a tolerance > 0");
  laws.contact_forces = [tolerance](const MatrixXd& A, const VectorXd& b) -> VectorXd {
    VectorXd f = VectorXd::Zero(b.size());
    for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
      double change = 0.0;
      for (Eigen::Index i = 0; i < b.size(); ++i) {
        const double before = f[i];
        f[i] = std::max(0.0, before - (A.row(i).dot(f) + b[i]) / A(i, i));
        change = std::max(change, std::abs(f[i] - before));
      }
      if (change <= tolerance * f.lpNorm<Eigen::Infinity>()) break;
    }
    return f;
  };
  laws.friction_impulses = [tolerance](const ContactProblem& problem,
                                       const ContactOptions& engine) {
    ContactOptions options = engine;
    options.tolerance = options.enough = tolerance;
    options.largest_direct = 0;
    options.most_sweeps_alone = kMostSweepsWithFriction;
    options.eliminates_links = false;
    return solve_contacts(problem, options);
  };
  laws.contact_solver = "Gauss-Seidel sweeps";
}

void solve_contacts_by_newton(double tolerance, Laws& laws) {
  require(tolerance > 0.0, "dynamics: an iterative solver needs a tolerance > 0");
  laws.friction_impulses = [tolerance](const ContactProblem& problem,
                                       const ContactOptions& engine) {
    ContactOptions options = engine;
    options.tolerance = options.enough = tolerance;
    return solve_contacts(problem, options);
  };
}

}  // namespace tumble
