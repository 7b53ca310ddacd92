// Integration by Boost.Odeint and root finding by Boost.Math, behind the same laws that a student
// fills.
#include <array>
#include <cmath>

#include <boost/math/tools/toms748_solve.hpp>
#include <boost/numeric/odeint/algebra/vector_space_algebra.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta4.hpp>

#include "framework/dynamics/laws.h"

namespace tumble {
namespace {

namespace odeint = boost::numeric::odeint;

VectorXd odeint_step(const OdeFunction& f, double t, const VectorXd& y, double h) {
  // std::vector as the state: Odeint's range algebra needs no adapter for it.
  using State = std::vector<double>;
  odeint::runge_kutta4<State> stepper;
  State state(y.data(), y.data() + y.size());
  stepper.do_step(
      [&f](const State& at, State& derivative, double time) {
        const VectorXd dy =
            f(time, Eigen::Map<const VectorXd>(at.data(), static_cast<Eigen::Index>(at.size())));
        derivative.assign(dy.data(), dy.data() + dy.size());
      },
      state, t, h);
  return Eigen::Map<const VectorXd>(state.data(), static_cast<Eigen::Index>(state.size()));
}

/// y' for y = (x, q, P, L), with the turning written in the body frame, where the inertia is
/// constant: w_b = I_b^-1 (q* L q), q' = q (0, w_b) / 2.
VectorXd newton_euler(const RigidBodyState& state, const Inertia& inertia, const Wrench& wrench) {
  const Quaterniond& q = state.world_from_body;
  const Vector3d omega_body =
      inertia.inverse_inertia_body *
      q.normalized().inverse()._transformVector(state.angular_momentum_world);
  const Quaterniond turning =
      q * Quaterniond(0.0, omega_body.x() / 2, omega_body.y() / 2, omega_body.z() / 2);
  return pack({.com_world = state.momentum_world * inertia.inverse_mass,
               .world_from_body = turning,
               .momentum_world = wrench.force_world,
               .angular_momentum_world = wrench.torque_world});
}

RootResult bracketed_root(const ScalarFunction& f, const ScalarFunction&, double low, double high,
                          double tolerance) {
  RootResult result;
  const auto counted = [&](double t) {
    ++result.evaluations;
    return f(t);
  };
  const double f_low = counted(low), f_high = counted(high);
  if (std::isnan(f_low) || std::isnan(f_high)) return result;  // not converged
  if (f_low < 0 || (f_low > 0 && f_high > 0)) {
    result.status = RootStatus::kNoSignChange;  // overlap from the start, or no impact seen
  } else if (f_low == 0.0 || f_high == 0.0) {
    result = {RootStatus::kConverged, f_low == 0.0 ? low : high, 0.0, result.evaluations};
  } else {
    std::uintmax_t limit = 200;
    const auto close = [tolerance](double a, double b) { return std::abs(b - a) <= tolerance; };
    const auto [a, b] =
        boost::math::tools::toms748_solve(counted, low, high, f_low, f_high, close, limit);
    result.status = close(a, b) || std::nextafter(a, b) == b ? RootStatus::kConverged
                                                             : RootStatus::kNotConverged;
    result.time = a;  // the end of the bracket on the side of t_low: a gap there has not closed yet
    result.residual = counted(a);
  }
  return result;
}

}  // namespace

Laws library_laws() {
  Laws laws;
  laws.integrate_step = odeint_step;
  laws.state_derivative = newton_euler;
  laws.renormalize = [](const Quaterniond& q) { return q.normalized(); };
  laws.find_impact_time = bracketed_root;
  laws.integrator_source = "Boost.Odeint";
  return laws;
}

}  // namespace tumble
