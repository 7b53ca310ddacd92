#include "tests/stability/methods.h"

#include <cmath>
#include <vector>

#include <Eigen/LU>
#include <boost/numeric/odeint/integrate/integrate_adaptive.hpp>
#include <boost/numeric/odeint/stepper/generation.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_dopri5.hpp>

#include "framework/dynamics/ode.h"

namespace tumble::battery {
namespace {

constexpr int kFirstMomentum = 7;   // of the 13 numbers of a body

// Adds h dy to the places, or to the momenta.
void add(const VectorXd& dy, double h, bool momenta, VectorXd& y) {
  if (y.size() == 2) {
    y[momenta ? 1 : 0] += h * dy[momenta ? 1 : 0];
    return;
  }
  for (Eigen::Index body = 0; body < y.size(); body += kStateSize) {
    const Eigen::Index first = momenta ? body + kFirstMomentum : body, count = momenta ? kStateSize - kFirstMomentum : kFirstMomentum;
    y.segment(first, count) += h * dy.segment(first, count);
  }
}

struct Assembled {
  MatrixXd matrix;       // J M^-1 J^T
  VectorXd right;        // wanted - (J u'_free + J' u)
};

Assembled assemble(const std::vector<Constraint>& rows, const std::vector<ConstrainedBody>& bodies, const VectorXd& wanted) {
  const auto n = static_cast<Eigen::Index>(rows.size());
  MatrixXd J = MatrixXd::Zero(n, 6 * static_cast<Eigen::Index>(bodies.size())), weighted = J;
  VectorXd free(J.cols());
  for (std::size_t b = 0; b < bodies.size(); ++b) free.segment<6>(6 * static_cast<Eigen::Index>(b)) = bodies[b].free_acceleration;
  Assembled all{MatrixXd(), wanted};
  for (Eigen::Index i = 0; i < n; ++i) {
    const Constraint& c = rows[static_cast<std::size_t>(i)];
    J.row(i).segment<6>(6 * c.body_a) += c.row.jacobian_a;
    J.row(i).segment<6>(6 * c.body_b) += c.row.jacobian_b;
    all.right[i] -= c.row.velocity_product;
  }
  all.right -= J * free;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const Eigen::Index at = 6 * static_cast<Eigen::Index>(b);
    weighted.middleCols<3>(at) = J.middleCols<3>(at) * bodies[b].inverse_mass;
    weighted.middleCols<3>(at + 3) = J.middleCols<3>(at + 3) * bodies[b].inverse_inertia_world;
  }
  all.matrix = weighted * J.transpose();
  return all;
}

}  // namespace

Laws with_method(Laws laws, const std::string& name, std::function<VectorXd(const OdeFunction&, double, const VectorXd&, double)> step) {
  laws.integrate_step = std::move(step);
  laws.integrator_source = name;
  return laws;
}

VectorXd explicit_euler(const OdeFunction& f, double t, const VectorXd& y, double h) { return y + h * f(t, y); }

VectorXd symplectic_euler(const OdeFunction& f, double t, const VectorXd& y, double h) {
  VectorXd next = y;
  add(f(t, y), h, true, next);
  add(f(t, next), h, false, next);
  return next;
}

VectorXd verlet(const OdeFunction& f, double t, const VectorXd& y, double h) {
  VectorXd next = y;
  add(f(t, y), 0.5 * h, true, next);
  add(f(t + 0.5 * h, next), h, false, next);
  add(f(t + h, next), 0.5 * h, true, next);
  return next;
}

VectorXd implicit_midpoint(const OdeFunction& f, double t, const VectorXd& y, double h) {
  constexpr int kMostRounds = 200;
  VectorXd change = h * f(t, y), last = change;
  for (int round = 0; round < kMostRounds; ++round) {
    last.swap(change);
    change = h * f(t + 0.5 * h, y + 0.5 * last);
    if ((change - last).norm() <= 1e-16 * y.norm()) break;
  }
  return y + change;
}

VectorXd rk4(const OdeFunction& f, double t, const VectorXd& y, double h) {
  const VectorXd k1 = f(t, y), k2 = f(t + h / 2, y + h / 2 * k1), k3 = f(t + h / 2, y + h / 2 * k2), k4 = f(t + h, y + h * k3);
  return y + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
}

std::function<VectorXd(const OdeFunction&, double, const VectorXd&, double)> dormand_prince(double tolerance) {
  namespace odeint = boost::numeric::odeint;
  return [tolerance](const OdeFunction& f, double t, const VectorXd& y, double h) -> VectorXd {
    using State = std::vector<double>;
    State state(y.data(), y.data() + y.size());
    const auto system = [&f](const State& at, State& derivative, double time) {
      const VectorXd dy = f(time, Eigen::Map<const VectorXd>(at.data(), static_cast<Eigen::Index>(at.size())));
      derivative.assign(dy.data(), dy.data() + dy.size());
    };
    odeint::integrate_adaptive(odeint::make_controlled(tolerance, tolerance, odeint::runge_kutta_dopri5<State>()), system, state, t, t + h, h);
    return Eigen::Map<const VectorXd>(state.data(), static_cast<Eigen::Index>(state.size()));
  };
}

Laws with_gauss_seidel(Laws laws, int sweeps) {
  laws.constraint_multipliers = [sweeps](const std::vector<Constraint>& rows, const std::vector<ConstrainedBody>& bodies, const VectorXd& wanted) {
    const Assembled all = assemble(rows, bodies, wanted);
    VectorXd lambda = VectorXd::Zero(all.right.size());
    for (int sweep = 0; sweep < sweeps; ++sweep)
      for (Eigen::Index i = 0; i < lambda.size(); ++i) lambda[i] += (all.right[i] - all.matrix.row(i).dot(lambda)) / all.matrix(i, i);
    return lambda;
  };
  return laws;
}

Laws with_explicit_inverse(Laws laws) {
  laws.constraint_multipliers = [](const std::vector<Constraint>& rows, const std::vector<ConstrainedBody>& bodies, const VectorXd& wanted) -> VectorXd {
    const Assembled all = assemble(rows, bodies, wanted);
    return all.matrix.inverse() * all.right;
  };
  return laws;
}

}  // namespace tumble::battery
