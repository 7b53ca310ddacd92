#include "tests/stability/methods.h"

#include <cmath>
#include <vector>

#include <boost/numeric/odeint/integrate/integrate_adaptive.hpp>
#include <boost/numeric/odeint/stepper/euler.hpp>
#include <boost/numeric/odeint/stepper/generation.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_dopri5.hpp>

#include "framework/dynamics/contact_problem.h"
#include "framework/dynamics/ode.h"

namespace tumble::battery {
namespace {

namespace odeint = boost::numeric::odeint;
using State = std::vector<double>;   // Odeint's range algebra needs no adapter for it

VectorXd vector_of(const State& state) { return Eigen::Map<const VectorXd>(state.data(), static_cast<Eigen::Index>(state.size())); }

auto system_of(const OdeFunction& f) {
  return [&f](const State& at, State& derivative, double time) {
    const VectorXd dy = f(time, vector_of(at));
    derivative.assign(dy.data(), dy.data() + dy.size());
  };
}

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

}  // namespace

Laws with_method(Laws laws, const std::string& name, std::function<VectorXd(const OdeFunction&, double, const VectorXd&, double)> step) {
  laws.integrate_step = std::move(step);
  laws.integrator_source = name;
  return laws;
}

VectorXd explicit_euler(const OdeFunction& f, double t, const VectorXd& y, double h) {
  State state(y.data(), y.data() + y.size());
  odeint::euler<State>().do_step(system_of(f), state, t, h);
  return vector_of(state);
}

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
  static const Laws library = library_laws();
  return library.integrate_step(f, t, y, h);
}

std::function<VectorXd(const OdeFunction&, double, const VectorXd&, double)> dormand_prince(double tolerance) {
  return [tolerance](const OdeFunction& f, double t, const VectorXd& y, double h) -> VectorXd {
    State state(y.data(), y.data() + y.size());
    odeint::integrate_adaptive(odeint::make_controlled(tolerance, tolerance, odeint::runge_kutta_dopri5<State>()), system_of(f), state, t, t + h, h);
    return vector_of(state);
  };
}

// Accelerations in the place of velocities: the rows shall accelerate as wanted, whatever their velocity product.
Laws with_gauss_seidel(Laws laws, int sweeps) {
  laws.constraint_multipliers = [sweeps](const std::vector<Constraint>& rows, const std::vector<ConstrainedBody>& bodies, const VectorXd& wanted) -> VectorXd {
    ContactProblem problem;
    for (const ConstrainedBody& body : bodies)
      problem.bodies.push_back({body.inverse_mass, body.inverse_inertia_world, Vector3d::Zero(), body.free_acceleration.head<3>(), body.free_acceleration.tail<3>()});
    problem.rows = rows;
    problem.row_targets = wanted;
    for (std::size_t i = 0; i < rows.size(); ++i) problem.row_targets[static_cast<Eigen::Index>(i)] -= rows[i].row.velocity_product;
    ContactOptions options;
    options.largest_direct = 0;
    options.most_sweeps_alone = sweeps;
    return solve_contacts(problem, options).row_impulses;
  };
  return laws;
}

}  // namespace tumble::battery
