// The lecture's logistic equation y' = a y - b y^2, computed with the steps of assignment 2.
//   exact: y(t) = K / (1 + (K / y0 - 1) exp(-a t)),  K = a / b                                (L.1)
#include "assignments/a2_integration/a2_truths.h"

#include <cmath>

#include "assignments/a2_integration/a2_integration.h"
#include "framework/truths/comparison.h"
#include "framework/truths/module_truths.h"

namespace tumble::a2 {
namespace {

using truths::Case;
using truths::Comparison;
using truths::Value;
using Step = std::function<VectorXd(const OdeFunction& f, double t, const VectorXd& y, double h)>;

VectorXd scalar(double x) { return VectorXd::Constant(1, x); }

struct Logistic {
  double a, b, y0;
  OdeFunction derivative() const {
    return [a = a, b = b](double, const VectorXd& y) { return scalar(a * y[0] - b * y[0] * y[0]); };
  }
  double exact(double t) const {  // (L.1)
    const double K = a / b;
    return K / (1.0 + (K / y0 - 1.0) * std::exp(-a * t));
  }
};

// Midpoint and Heun are in the files for comparison; no function of the module computes them.
VectorXd midpoint_step(const OdeFunction& f, double t, const VectorXd& y, double h) {
  return y + h * f(t + 0.5 * h, y + 0.5 * h * f(t, y));
}
VectorXd heun_step(const OdeFunction& f, double t, const VectorXd& y, double h) {
  const VectorXd k1 = f(t, y);
  return y + 0.5 * h * (k1 + f(t + h, y + h * k1));
}

/// y(T) after `steps` equal steps from y0.
double march(const Step& step, const Logistic& equation, double T, int steps) {
  const OdeFunction f = equation.derivative();
  const double h = T / steps;
  VectorXd y = scalar(equation.y0);
  for (int i = 0; i < steps; ++i) y = step(f, i * h, y, h);
  return y[0];
}

// ---- One step, and the stages of RK4 ---------------------------------------------------------

void compare_stages(const Module& module, const Case& truth, const Logistic& equation, double h,
                    Comparison& comparison) {
  std::vector<double> Y, k;
  const OdeFunction f = equation.derivative();
  const OdeFunction watched = [&](double t, const VectorXd& y) {
    const VectorXd rate = f(t, y);
    Y.push_back(y[0]);
    k.push_back(rate[0]);
    return rate;
  };
  const double result = module.rk4_step(watched, 0.0, scalar(equation.y0), h)[0];
  if (k.size() != 4) {
    comparison.agree(
        "rk4 stages", false,
        "the derivative was evaluated " + std::to_string(k.size()) + " times, RK4 needs 4");
  } else {
    for (int i = 0; i < 4; ++i) {
      const std::string number = std::to_string(i + 1), previous = std::to_string(i);
      if (i > 0) comparison.closed_form(truth, "rk4_Y" + previous, Y[static_cast<std::size_t>(i)]);
      comparison.closed_form(truth, "rk4_k" + number, k[static_cast<std::size_t>(i)]);
    }
  }
  comparison.closed_form(truth, "rk4_one_step", result);
}

// ---- Convergence -------------------------------------------------------------------------------

struct Method {
  std::string name;
  Step step;
  double order, order_tolerance;
};

void compare_table(const Method& method, const Case& truth, const Logistic& equation, double T,
                   Comparison& comparison) {
  const double floor = truth.floor("convergence_table_at_T");
  for (const Value& row : truth.output("convergence_table_at_T").list()) {
    const double found = march(method.step, equation, T, row.at("steps").integer());
    comparison.closed_form("table." + method.name + "[" + row.at("steps").text() + " steps]",
                           std::abs(found - row.at(method.name).number()), floor);
  }
}

/// The observed order of the two smallest steps with an error well above round-off.
void compare_order(const Method& method, const Case& truth, const Logistic& equation, double T,
                   Comparison& comparison) {
  // Euler has an error of 1 to 4 digits there; more would only cost time
  constexpr int kMostSteps = 1 << 16;
  // floors: an error this large is known to 0.1 %, its log2 to 0.002
  constexpr double kAboveRoundOff = 1000.0;
  const double floor = truth.floor("convergence_table_at_T");
  const double exact = equation.exact(T);
  double coarse = kUnset, order = kUnset;
  int steps_read = 0;
  for (int steps = 1; steps <= kMostSteps; steps *= 2) {
    const double error = std::abs(march(method.step, equation, T, steps) - exact);
    if (error < kAboveRoundOff * floor) break;
    order = std::log2(coarse / error);
    coarse = error;
    steps_read = steps;
  }
  const double rounded = std::round(order * 1e4) / 1e4;
  comparison.check("order_" + method.name, std::abs(order - method.order), kUnset,
                   method.order_tolerance,
                   "order " + std::to_string(rounded).substr(0, 6) + " between " +
                       std::to_string(steps_read / 2) + " and " + std::to_string(steps_read) +
                       " steps, expected " + std::to_string(method.order).substr(0, 3));
}

void compare_logistic(const Module& module, const Case& truth, Comparison& comparison) {
  const Logistic equation{truth.input("a").number(), truth.input("b").number(),
                          truth.input("y0").number()};
  const double h = truth.input("dt").number(), T = truth.input("T").number();
  const OdeFunction f = equation.derivative();
  const VectorXd y0 = scalar(equation.y0);

  comparison.closed_form(truth, "limit_K", equation.a / equation.b);
  comparison.closed_form(truth, "exact_y_at_dt", equation.exact(h));
  comparison.closed_form(truth, "exact_y_at_T", equation.exact(T));
  comparison.closed_form(truth, "midpoint_one_step", midpoint_step(f, 0.0, y0, h)[0]);
  comparison.closed_form(truth, "heun_one_step", heun_step(f, 0.0, y0, h)[0]);
  comparison.attempt("euler_step", [&] {
    comparison.closed_form(truth, "euler_one_step", module.euler_step(f, 0.0, y0, h)[0]);
  });
  comparison.attempt("rk4_step", [&] { compare_stages(module, truth, equation, h, comparison); });

  // Orders within 0.05 and 0.1; the commonest mistakes cost at least half an order.
  const Method methods[] = {{"euler", module.euler_step, 1.0, 0.05},
                            {"midpoint", midpoint_step, 2.0, 0.1},
                            {"heun", heun_step, 2.0, 0.1},
                            {"rk4", module.rk4_step, 4.0, 0.1}};
  for (const Method& method : methods) {
    comparison.attempt("table." + method.name, [&] {
      compare_table(method, truth, equation, T, comparison);
      compare_order(method, truth, equation, T, comparison);
    });
  }
  if (truth.has_output("slide_check"))
    comparison.not_compared("slide_check",
                            "about the slide's print, not about a computation; its exact values "
                            "are the rk4 stages above");
}

}  // namespace

void register_truths(modules::Registry& registry) {
  registry.set_note(Module::kId,
                    truths::ModuleTruths{{{"logistic", truths::for_module(&compare_logistic)}}});
}

}  // namespace tumble::a2
