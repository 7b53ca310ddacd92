#include "framework/dynamics/methods.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

#include <boost/numeric/odeint/stepper/bulirsch_stoer.hpp>
#include <boost/numeric/odeint/stepper/controlled_step_result.hpp>
#include <boost/numeric/odeint/stepper/euler.hpp>
#include <boost/numeric/odeint/stepper/generation.hpp>
#include <boost/numeric/odeint/stepper/rosenbrock4.hpp>
#include <boost/numeric/odeint/stepper/rosenbrock4_controller.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta4.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_dopri5.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_fehlberg78.hpp>
#include <boost/numeric/odeint/util/detail/less_with_sign.hpp>

#include "framework/core/error.h"
#include "framework/core/nearest_word.h"
#include "framework/core/not_implemented.h"
#include "framework/dynamics/gauss.h"
#include "framework/dynamics/split_ode.h"

namespace tumble {
namespace {

namespace odeint = boost::numeric::odeint;
namespace ublas = boost::numeric::ublas;
using State = std::vector<double>;          // Odeint's range algebra needs no adapter for it
using UblasVector = ublas::vector<double>;  // what its Rosenbrock method solves with
using UblasMatrix = ublas::matrix<double>;

constexpr int kFirstMomentum = 7;     // of the 13 numbers of a body
constexpr long kMostParts = 1000000;  // of one step, by a controlled method
// of one step: shorter ones do not end within kMostParts, nor do they move its time much beyond
// rounding
constexpr double kShortestPart = 1e-12;

template <class Container>
VectorXd vector_of(const Container& state) {
  return Eigen::Map<const VectorXd>(&state[0], static_cast<Eigen::Index>(state.size()));
}

auto system_of(const OdeFunction& f) {
  return [&f](const State& at, State& derivative, double time) {
    const VectorXd dy = f(time, vector_of(at));
    derivative.assign(dy.data(), dy.data() + dy.size());
  };
}

template <class Stepper>
VectorXd one_step(const OdeFunction& f, double t, const VectorXd& y, double h) {
  State state(y.data(), y.data() + y.size());
  Stepper().do_step(system_of(f), state, t, h);
  return vector_of(state);
}

VectorXd midpoint(const OdeFunction& f, double t, const VectorXd& y, double h) {
  return y + h * f(t + 0.5 * h, y + 0.5 * h * f(t, y));
}

// Adds h dy to the places, or to the momenta.
void add(const VectorXd& dy, double h, bool momenta, VectorXd& y) {
  if (y.size() % kStateSize != 0) {  // a swing: places, then velocities
    const Eigen::Index half = y.size() / 2;
    (momenta ? y.tail(half) : y.head(half)) += h * (momenta ? dy.tail(half) : dy.head(half));
    return;
  }
  for (Eigen::Index body = 0; body < y.size(); body += kStateSize) {
    const Eigen::Index first = momenta ? body + kFirstMomentum : body,
                       count = momenta ? kStateSize - kFirstMomentum : kFirstMomentum;
    y.segment(first, count) += h * dy.segment(first, count);
  }
}

// Momenta first, then places with the new momenta.
VectorXd symplectic_euler(const OdeFunction& f, double t, const VectorXd& y, double h) {
  VectorXd next = y;
  add(f(t, y), h, true, next);
  add(rates_of_places(f, t, next), h, false, next);
  return next;
}

// Half a step of momenta, a step of places, half a step of momenta (Stoermer, Verlet). Of second
// order where forces and the turning of places depend on places alone; a body that tumbles turns
// with the orientation it had, which is of first order.
VectorXd verlet(const OdeFunction& f, double t, const VectorXd& y, double h) {
  VectorXd next = y;
  add(f(t, y), 0.5 * h, true, next);
  add(rates_of_places(f, t + 0.5 * h, next), h, false, next);
  add(f(t + h, next), 0.5 * h, true, next);
  return next;
}

constexpr const char* kNotANumber = "a slope, or where it leads, is not a number";

// std::max ignores NaN, so a derivative that is NaN must reject the trial step here.
OdeFunction with_finite_slopes(const OdeFunction& f) {
  return [&f](double t, const VectorXd& y) {
    VectorXd slope = f(t, y);
    if (!slope.allFinite()) throw std::runtime_error(kNotANumber);
    return slope;
  };
}

// Where a trial leads to is wrong: a stage left what the equations can bear. Slips of a person are
// none of the step's, nor is what stays so.
template <class Trial>
std::optional<std::string> what_went_wrong(const Trial& trial) {
  try {
    if (trial()) return std::nullopt;
    return kNotANumber;
  } catch (const NotImplemented&) {
    throw;
  } catch (const UserError&) {
    throw;
  } catch (const std::exception& error) {
    if (dynamic_cast<const Final*>(&error)) throw;
    return error.what();
  }
}

template <class Container>
bool is_finite(const Container& state) {
  return std::all_of(state.begin(), state.end(), [](double value) { return std::isfinite(value); });
}

/// Steps as long as the control allows, from t to t + h. A trial step that fails was too long: it
/// is rejected, and a quarter of it tried.
/// @throws std::runtime_error where no step will do: a solution that grows without bound asks for
/// ever shorter steps
template <class Controlled, class System, class Container>
void advance(const Controlled& fresh, const System& system, Container& state, double t, double h,
             double first) {
  std::optional<Controlled> stepper(fresh);
  const double end = t + h;
  double part = first;
  long parts = 0;
  for (double time = t; odeint::detail::less_with_sign(time, end, part);) {
    if (++parts > kMostParts)
      throw std::runtime_error(
          "a tolerance too small to be reached: more than a million steps inside one, at t = " +
          std::to_string(time) + " s");
    if (odeint::detail::less_with_sign(end, time + part, part)) part = end - time;
    for (bool taken = false; !taken;) {
      Container next = state;
      double next_time = time, next_part = part;
      const auto wrong = what_went_wrong([&] {
        taken = stepper->try_step(system, next, next_time, next_part) == odeint::success;
        return !taken || is_finite(next);
      });
      if (wrong) {
        taken = false;
        stepper.emplace(fresh);  // what it remembers of the trial is as wrong
        part *= 0.25;
      } else {
        part = next_part;
        if (taken) state = next, time = next_time;
      }
      // What is taken may be shorter: a cautious beginning, or what rounding has left of the step.
      if (taken || std::abs(part) >= kShortestPart * std::abs(h)) continue;
      const std::string at = " at t = " + std::to_string(time) + " s";
      throw std::runtime_error(wrong ? "no step is short enough" + at + ": " + *wrong
                                     : "no step is short enough for the tolerance" + at);
    }
  }
}

// What a controlled method tries first: small enough that y and its slope hardly change in it. A
// trial over all of h may leave what the equations can bear (a stiff spring flung out to 1e30 m)
// before the control can say no.
// Source: Hairer, Norsett, Wanner, "Solving ODEs I", II.4 (starting step size), with the sizes of y
// in place of tolerances.
double first_part(const OdeFunction& f, double t, const VectorXd& y, double h) {
  const auto size = [&](const VectorXd& v) {
    return (v.array() / (1.0 + y.array().abs())).matrix().norm();
  };
  const VectorXd slope = f(t, y);
  const double speed = size(slope), most = std::abs(h);
  if (!(speed > 0.0)) return h;
  const double first = std::min(most, 0.01 / speed);
  VectorXd beyond;
  if (what_went_wrong([&] {
        return (beyond = f(t + std::copysign(first, h), y + std::copysign(first, h) * slope))
            .allFinite();
      }))
    return std::copysign(0.25 * first, h);
  const double bend = size(beyond - slope) / first;
  return std::copysign(
      std::min({most, 100.0 * first, std::sqrt(0.02 / std::max(bend, 0.02 / (most * most)))}), h);
}

template <class Controlled>
VectorXd adaptive(const Controlled& stepper, const OdeFunction& any, double t, const VectorXd& y,
                  double h) {
  if (h == 0.0) return y;
  const OdeFunction f = with_finite_slopes(any);
  State state(y.data(), y.data() + y.size());
  advance(stepper, system_of(f), state, t, h, first_part(f, t, y, h));
  return vector_of(state);
}

// df/dy by central differences, df/dt by one more pair: as a Rosenbrock method asks for it. Error
// of each entry: eps^(2/3) of its size.
class DifferencedJacobian {
 public:
  explicit DifferencedJacobian(const OdeFunction& f) : f_(f) {}
  void operator()(const UblasVector& at, UblasMatrix& jacobian, double t,
                  UblasVector& by_time) const {
    const VectorXd y = vector_of(at);
    const double part = std::cbrt(std::numeric_limits<double>::epsilon());
    for (Eigen::Index column = 0; column < y.size(); ++column) {
      const double step = part * std::max(1.0, std::abs(y[column]));
      VectorXd before = y, after = y;
      before[column] -= step;
      after[column] += step;
      const VectorXd slope = (f_(t, after) - f_(t, before)) / (after[column] - before[column]);
      for (Eigen::Index row = 0; row < y.size(); ++row)
        jacobian(static_cast<std::size_t>(row), static_cast<std::size_t>(column)) = slope[row];
    }
    const double step = part * std::max(1.0, std::abs(t));
    const VectorXd slope = (f_(t + step, y) - f_(t - step, y)) / (2.0 * step);
    for (Eigen::Index row = 0; row < y.size(); ++row)
      by_time(static_cast<std::size_t>(row)) = slope[row];
  }

 private:
  const OdeFunction& f_;
};

VectorXd rosenbrock(const OdeFunction& any, double t, const VectorXd& y, double h,
                    double tolerance) {
  if (h == 0.0) return y;
  const OdeFunction f = with_finite_slopes(any);
  UblasVector state(static_cast<std::size_t>(y.size()));
  std::copy(y.data(), y.data() + y.size(), state.begin());
  const auto system = [&f](const UblasVector& at, UblasVector& derivative, double time) {
    const VectorXd dy = f(time, vector_of(at));
    std::copy(dy.data(), dy.data() + dy.size(), derivative.begin());
  };
  const auto with_jacobian = std::make_pair(system, DifferencedJacobian(f));
  advance(odeint::rosenbrock4_controller<odeint::rosenbrock4<double>>(tolerance, tolerance),
          with_jacobian, state, t, h, h);
  return vector_of(state);
}

}  // namespace

const std::vector<Method>& methods() {
  static const std::vector<Method> all = {{"euler", "Euler", 1, false, false},
                                          {"symplectic", "symplectic Euler", 1, false, false},
                                          {"midpoint", "midpoint", 2, false, false},
                                          {"verlet", "Verlet", 2, false, false},
                                          {"rk4", "RK4", 4, false, false},
                                          {"dopri5", "Dormand-Prince 5(4)", 5, true, false},
                                          {"fehlberg78", "Fehlberg 7(8)", 8, true, false},
                                          {"bulirsch-stoer", "Bulirsch-Stoer", kUnset, true, false},
                                          {"rosenbrock4", "Rosenbrock 4 (implicit)", 4, true, true},
                                          {"gauss6", "Gauss 6 (implicit)", 6, false, true}};
  return all;
}

const Method& method_named(const std::string& word) {
  std::vector<std::string> words;
  std::string known;
  for (const Method& method : methods()) {
    if (method.word == word) return method;
    words.push_back(method.word);
    known += (known.empty() ? "" : ", ") + method.word;
  }
  throw UserError("method '" + word + "'",
                  "there is no method of integration of that name." + did_you_mean(word, words),
                  "Known: " + known + ".");
}

StepFunction step_of(const Method& method, double tolerance) {
  require(!method.controlled || tolerance > 0.0,
          "dynamics: a controlled method needs a tolerance > 0");
  if (method.word == "euler") return one_step<odeint::euler<State>>;
  if (method.word == "symplectic") return symplectic_euler;
  if (method.word == "midpoint") return midpoint;
  if (method.word == "verlet") return verlet;
  if (method.word == "rk4") return one_step<odeint::runge_kutta4<State>>;
  if (method.word == "gauss6") return gauss_step;
  if (method.word == "dopri5")
    return [tolerance](const OdeFunction& f, double t, const VectorXd& y, double h) {
      return adaptive(
          odeint::make_controlled(tolerance, tolerance, odeint::runge_kutta_dopri5<State>()), f, t,
          y, h);
    };
  if (method.word == "fehlberg78")
    return [tolerance](const OdeFunction& f, double t, const VectorXd& y, double h) {
      return adaptive(
          odeint::make_controlled(tolerance, tolerance, odeint::runge_kutta_fehlberg78<State>()), f,
          t, y, h);
    };
  if (method.word == "bulirsch-stoer")
    return [tolerance](const OdeFunction& f, double t, const VectorXd& y, double h) {
      return adaptive(odeint::bulirsch_stoer<State>(tolerance, tolerance), f, t, y, h);
    };
  require(method.word == "rosenbrock4", "dynamics: a method of methods()");
  return [tolerance](const OdeFunction& f, double t, const VectorXd& y, double h) {
    return rosenbrock(f, t, y, h, tolerance);
  };
}

}  // namespace tumble
