// Rows 1 and 24: a stiff spring, and energy over a million steps.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>

#include "framework/core/error.h"
#include "framework/effects/build_world.h"
#include "framework/effects/spring/spring.h"
#include "framework/engines/stepping/stability.h"
#include "tests/stability/cases.h"
#include "tests/stability/methods.h"
#include "tests/stability/support.h"

namespace tumble::battery {
namespace {

using truths::run_in_steps;

/// One kilogram on a spring of length 0 at the origin, let go at 0.1 m: x'' = -w^2 x.
scene::Scene swing(double w) {
  scene::Scene scene = truths::empty_scene("swing", 1.0, 1e-9);
  scene.bodies = {truths::point_mass("bob", 1.0, Vector3d(0.1, 0, 0), Vector3d::Zero())};
  scene.effects.of<effects::SpringSpec>() = {
      {"spring", {"", Vector3d::Zero()}, {"bob", Vector3d::Zero()}, w * w, 0.0, 0.0}};
  return scene;
}

/// Energy over the energy at the start, frame by frame, over the number of the step.
report::Curve energies(const std::string& name, const Trajectory& run, double h) {
  report::Curve curve = curve_of(name, run, [&](const Frame& frame) {
    return energy_of(frame) / energy_of(run.frames.front());
  });
  for (double& t : curve.x) t /= h;
  return curve;
}

// ---- Row 1 --------------------------------------------------------------------------------------

constexpr double kStiff = 1000.0;  // rad/s: k = 1e6 N/m on 1 kg

void band_of_symplectic_euler(const Given& given, Findings& findings, report::Plot& plot) {
  const long steps = given.is_long ? 1000000 : 20000;
  for (const double h : {1.0e-3, 1.9e-3}) {
    const Trajectory run =
        run_in_steps(swing(kStiff), with_method(given.laws, "symplectic Euler", symplectic_euler),
                     static_cast<double>(steps) * h, steps, 10000);
    report::Curve curve = energies(fmt::format("symplectic Euler, w h = {:g}", kStiff * h), run, h);
    const auto [low, high] = std::minmax_element(curve.y.begin(), curve.y.end());
    const double a = 0.5 * kStiff * h, band = (1 + a) / (1 - a);
    findings.at_most(
        fmt::format("symplectic Euler, w h = {:g}, {} steps: largest over smallest energy",
                    kStiff * h, steps),
        *high / *low, band * (1 + 1e-9), "",
        "p^2 + w^2 q^2 - h w^2 p q is an exact invariant of the method: H stays within (1 + a)/(1 "
        "- a), a = w h / 2");
    for (auto* v : {&curve.x, &curve.y}) v->resize(std::min<std::size_t>(v->size(), 60));
    plot.curves.push_back(std::move(curve));
  }
}

void growth_of_explicit_euler(const Given& given, Findings& findings, report::Plot& plot) {
  const double h = 1e-4;
  const long steps = 200;  // after some more the engine stops it
  const Laws euler = with_method(given.laws, "explicit Euler", explicit_euler);
  const Trajectory run =
      run_in_steps(swing(kStiff), euler, static_cast<double>(steps) * h, steps, steps);
  report::Curve curve = energies("explicit Euler, w h = 0.1", run, h);
  const double a = 0.5 * kStiff * h;
  findings.must_fail("explicit Euler, w h = 0.1, 200 steps: energy over the start's",
                     curve.y.back(), (1 + a) / (1 - a), "",
                     "it grows as (1 + (w h)^2)^n, here 7.3 times: outside of any band");
  plot.curves.push_back(std::move(curve));
  bool stopped = false;
  try {
    run_in_steps(swing(kStiff), euler, 600 * h, 600, 600);
  } catch (const std::runtime_error& error) {
    const std::string words = error.what();
    stopped = words.find("runaway energy") != std::string::npos &&
              words.find("'bob'") != std::string::npos;
  }
  findings.is_true("explicit Euler, 600 steps: stopped, the body named", stopped,
                   "energy that nothing brought in ends a run with body, time and effect named");
  bool refused = false;
  try {
    run_in_steps(swing(kStiff), euler, 1e4 * h, 10000, 1);
  } catch (const UserError&) {
    refused = true;
  }
  findings.is_true("explicit Euler, 10^4 steps: refused at start-up", refused,
                   "a step outside the method's range is reported with the largest stable one, not "
                   "left to blow up");
}

void limit_of_rk4(const Given& given, Findings& findings) {
  const auto judged =
      engines::judge_springs(build_world(swing(kStiff)), with_method(given.laws, "RK4", rk4), 0.01);
  findings.at_most("RK4: largest stable step told at start-up, |w h - 2 sqrt(2)|",
                   std::abs(judged->largest_step * kStiff - 2 * std::sqrt(2.0)), 1e-6, "",
                   "|1 + z + z^2/2 + z^3/6 + z^4/24| <= 1 on the imaginary axis up to 2.828");
  for (const double part : {0.99, 1.01}) {
    const double h = part * 2 * std::sqrt(2.0) / kStiff;
    bool refused = false;
    try {
      run_in_steps(swing(kStiff), with_method(given.laws, "RK4", rk4), 20000 * h, 20000, 1);
    } catch (const UserError&) {
      refused = true;
    }
    if (part < 1)
      findings.is_true("RK4 at 0.99 of that step: runs", !refused,
                       "inside the range nothing is refused");
    else
      findings.is_true("RK4 at 1.01 of that step: refused", refused,
                       "outside of it the swing would grow without bound");
  }
}

/// Ten steps just beyond the range double the swing: too little to refuse a run for, and too much
/// to say nothing.
void told_with_the_largest_step(const Given& given, Findings& findings) {
  const auto notices_of = [&](const Laws& laws, double h) {
    return run_in_steps(swing(kStiff), laws, 10 * h, 10, 1).counters.notices;
  };
  const auto tells = [](const std::vector<std::string>& notices, const char* words) {
    return std::any_of(notices.begin(), notices.end(), [&](const std::string& notice) {
      return notice.find("'spring'") != std::string::npos &&
             notice.find(words) != std::string::npos;
    });
  };
  findings.is_true(
      "RK4, 10 steps at 1.01 of that step: run, and told with the largest stable step",
      tells(notices_of(with_method(given.laws, "RK4", rk4), 1.01 * 2 * std::sqrt(2.0) / kStiff),
            "at most 0.002828 s"),
      "whoever is told that a step is too long wants to know which is not: 2 sqrt(2) / w");
  findings.is_true(
      "explicit Euler, 10 steps of w h = 0.2: told that no step will do",
      tells(notices_of(with_method(given.laws, "explicit Euler", explicit_euler), 2e-4),
            "at every step size"),
      "|1 + i w h| > 1 for every h");
}

void error_of_dormand_prince(const Given& given, Findings& findings) {
  constexpr double kTolerance = 1e-10, kTau = 6.283185307179586;
  const double t = 100 * kTau / kStiff;
  const Trajectory run = run_in_steps(
      swing(kStiff), with_method(given.laws, "Dormand-Prince", dormand_prince(kTolerance)), t, 400,
      400);
  double worst = 0.0;
  for (const Frame& frame : run.frames)
    worst = std::max({worst,
                      std::abs(frame.poses[0].com_world.x() - 0.1 * std::cos(kStiff * frame.time)),
                      std::abs(frame.poses[0].velocity_world.x() / kStiff +
                               0.1 * std::sin(kStiff * frame.time))});
  findings.at_most("Dormand-Prince, tolerance 1e-10, 100 periods: error of the phase", worst / 0.1,
                   1e3 * kTolerance, "rad",
                   "global error <= 1e3 times the local tolerance over 100 periods");
}

void stiff_spring(const Given& given, Findings& findings) {
  report::Plot plot{"Energy of a spring of 10^6 N/m on 1 kg",
                    {"step"},
                    {"energy / energy at the start", "", report::Scale::kLog},
                    {},
                    {},
                    "The symplectic method keeps its band for ever, at steps up to w h = 2; the "
                    "explicit one leaves it at every step size."};
  findings.part("symplectic Euler", [&] { band_of_symplectic_euler(given, findings, plot); });
  findings.part("explicit Euler", [&] { growth_of_explicit_euler(given, findings, plot); });
  findings.part("RK4", [&] { limit_of_rk4(given, findings); });
  findings.part("told with the largest step", [&] { told_with_the_largest_step(given, findings); });
  findings.part("Dormand-Prince", [&] { error_of_dormand_prince(given, findings); });
  for (const char* id : {"spring_mass/undamped_stiff_k1e6", "spring_mass/damped_stiff_k1e6_c20",
                         "elastic_pendulum/stiff_1e5", "two_body_spring/stiff_k1e4"})
    compare_with_truth(given, findings, id);
  plot.limits.push_back({(1 + 0.95) / (1 - 0.95), "band at w h = 1.9"});
  findings.plot(std::move(plot));
}

// ---- Row 24 -------------------------------------------------------------------------------------

// Slope of E/E0 a step by least squares.
double slope_of(const report::Curve& curve) {
  const auto n = static_cast<double>(curve.x.size());
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t i = 0; i < curve.x.size(); ++i) {
    sx += curve.x[i];
    sy += curve.y[i];
    sxx += curve.x[i] * curve.x[i];
    sxy += curve.x[i] * curve.y[i];
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

struct Method {
  const char* name;
  VectorXd (*step)(const OdeFunction&, double, const VectorXd&, double);
  double z;  // w h
};

// A symplectic method's energy swings by a part w h in every turn, which hides a trend of 1e-12 a
// step behind the part of a turn at a run's end. So w h is chosen such that the method's own turn
// is 64 steps, and the energy is looked at once a turn.
constexpr long kTurn = 64;
const double kHalfAngle = std::numbers::pi / kTurn;  // of a step, half
// A step turns by p: cos p = 1 - z^2 / 2, or (implicit midpoint) tan(p / 2) = z / 2.
const Method kSymplectic[] = {{"symplectic Euler", symplectic_euler, 2 * std::sin(kHalfAngle)},
                              {"Verlet", verlet, 2 * std::sin(kHalfAngle)},
                              {"implicit midpoint", implicit_midpoint, 2 * std::tan(kHalfAngle)}};

void oscillator_over_many_steps(const Given& given, Findings& findings, report::Plot& plot) {
  const double h = 0.01;
  const long steps = kTurn * (given.is_long ? 15625 : 480);  // 10^6 in the long run
  for (const Method& method : kSymplectic) {
    const Trajectory run =
        run_in_steps(swing(method.z / h), with_method(given.laws, method.name, method.step),
                     static_cast<double>(steps) * h, steps, steps / kTurn);
    report::Curve curve = energies(method.name, run, h);
    findings.at_most(
        fmt::format("{}, {} steps: slope of E/E0 from turn to turn", method.name, steps),
        std::abs(slope_of(curve)), 1e-12, "a step",
        "no secular trend: looked at once a turn of the method, nothing is left but roundings of "
        "1e-16 a step, which do not all lean one way");
    for (double& y : curve.y) y = std::max(std::abs(y - 1), 1e-17);
    plot.curves.push_back(std::move(curve));
  }
  for (const Method& method :
       {Method{"RK4", rk4, 0.1}, Method{"explicit Euler", explicit_euler, 0.1}}) {
    const bool is_rk4 = method.step == rk4;
    const long count = is_rk4 ? steps : 200;  // more of it is stopped
    const Trajectory run =
        run_in_steps(swing(method.z / h), with_method(given.laws, method.name, method.step),
                     static_cast<double>(count) * h, count, count / 10);
    report::Curve curve = energies(method.name, run, h);
    if (is_rk4) {
      const double expected = std::expm1(
                       static_cast<double>(count) *
                       std::log1p(-std::pow(method.z, 6) / 72 + std::pow(method.z, 8) / 576)),
                   found = curve.y.back() - 1;
      findings.at_most(
          fmt::format("RK4, {} steps: loss of energy against (w h)^6/72 a step", count),
          std::abs(found / expected - 1), 0.1, "",
          "1.4 % after 10^6 steps at w h = 0.1, measured = predicted within 10 %");
      findings.must_fail("RK4: slope of E/E0", std::abs(slope_of(curve)), 1e-12, "a step",
                         "it is not symplectic: (w h)^6/72 = 1.4e-8 a step");
    } else {
      findings.must_fail("explicit Euler: slope of E/E0", std::abs(slope_of(curve)), 1e-12,
                         "a step", "energy grows by (w h)^2 a step");
    }
    for (double& y : curve.y) y = std::abs(y - 1);
    plot.curves.push_back(std::move(curve));
  }
}

/// A pendulum as an angle, q'' = -g sin q with a rod of 1 m, let go at rest at 90 degrees: (angle,
/// speed).
VectorXd pendulum_rates(double, const VectorXd& y) {
  VectorXd dy(2);
  dy << y[1], -kG * std::sin(y[0]);
  return dy;
}

VectorXd after_steps(const Method& method, double h, long steps, VectorXd y) {
  for (long i = 0; i < steps; ++i)
    y = method.step(pendulum_rates, static_cast<double>(i) * h, y, h);
  return y;
}

VectorXd pendulum_let_go() {
  VectorXd y(2);
  y << 0.5 * std::numbers::pi, 0.0;
  return y;
}

/// The step of which the method makes a whole swing in kTurn: there the speed is back at 0. By
/// secants.
double step_of_a_whole_swing(const Method& method) {
  const auto speed = [&](double h) { return after_steps(method, h, kTurn, pendulum_let_go())[1]; };
  // exact, from 90 degrees
  const double period = 4 * std::comp_ellint_1(std::sin(0.25 * std::numbers::pi)) / std::sqrt(kG);
  double before = period / kTurn, h = before * (1 + 1e-4), speed_before = speed(before);
  for (int round = 0; round < 30; ++round) {
    const double here = speed(h);
    if (here == 0.0 || here == speed_before) break;
    const double next = h - here * (h - before) / (here - speed_before);
    before = h, speed_before = here, h = next;
  }
  return h;
}

void pendulum_as_an_angle(const Given& given, Findings& findings) {
  const long turns = given.is_long ? 15625 : 480;
  for (const Method& method :
       {kSymplectic[0], kSymplectic[1], kSymplectic[2], Method{"RK4", rk4, 0.0}}) {
    const double h = step_of_a_whole_swing(method);
    report::Curve curve{method.name, {}, {}};
    VectorXd y = pendulum_let_go();
    for (long turn = 0; turn <= turns; ++turn) {
      curve.x.push_back(static_cast<double>(turn * kTurn));
      // E + m g L over its value here, where cos q = 0
      curve.y.push_back(1 + (0.5 * y[1] * y[1] - kG * std::cos(y[0])) / kG);
      y = after_steps(method, h, kTurn, y);
    }
    const double slope = std::abs(slope_of(curve));
    const std::string name =
        fmt::format("pendulum as an angle, {}, {} steps: slope of E/E0 from turn to turn",
                    method.name, turns * kTurn);
    if (method.step == rk4)
      findings.must_fail(name, slope, 1e-12, "a step", "a loss of order (w h)^6 a step, here 1e-8");
    else
      findings.at_most(
          name, slope, 1e-12, "a step",
          "no secular trend: looked at once a turn of the method, of 64 steps, roundings are left");
  }
}

void pendulum_over_many_steps(const Given& given, Findings& findings) {
  const long steps = given.is_long ? 1000000 : 10000;
  const double h = 0.01;
  scene::Scene scene = chain({1.0}, 1.0, Vector3d(1, 0, 0));
  const Trajectory run =
      run_in_steps(scene, given.laws, static_cast<double>(steps) * h, steps, steps / 10);
  // RK4 on the projected circle: what order 4 says of an amplitude of 90 degrees, w h = 0.031 to
  // 0.044; (w h)^5 a step, with a factor 1.
  const double mark = static_cast<double>(steps) * std::pow(4.43 * h, 5);
  findings.at_most(
      fmt::format("planar pendulum on a rod, RK4 with projection, {} steps: energy", steps),
      energy_drift(run, kG), mark, "m g L",
      "order 4: an error of at most (w h)^5 a step at the fastest, w = 4.43 rad/s");
  double length = 0.0;
  for (const Frame& frame : run.frames)
    length = std::max(length, std::abs(frame.poses[0].com_world.norm() - 1.0));
  findings.at_most("planar pendulum: length of the rod", length, 1e-12, "m",
                   "projected at every step's end: a few roundings, whatever the number of steps");
}

void energy_over_a_million_steps(const Given& given, Findings& findings) {
  report::Plot plot{"Error of the energy of an oscillator, w h = 0.1",
                    {"step"},
                    {"|E / E0 - 1|", "", report::Scale::kLog},
                    {},
                    {},
                    "Seen once a turn a symplectic method's energy stays, to rounding; RK4 loses "
                    "(w h)^6/72 a step, exactly as predicted; explicit Euler explodes."};
  findings.part("oscillator", [&] { oscillator_over_many_steps(given, findings, plot); });
  findings.plot(std::move(plot));
  findings.part("pendulum as an angle", [&] { pendulum_as_an_angle(given, findings); });
  findings.part("pendulum", [&] { pendulum_over_many_steps(given, findings); });
}

}  // namespace

void add_springs(std::vector<Case>& cases) {
  cases.push_back(
      {1, "stiff spring",
       "A spring of 10^6 N/m on one kilogram swings at 1000 rad/s. Explicit Euler blows up at "
       "every step size; symplectic Euler holds up to w h = 2, RK4 up to 2.83. "
       "Steps outside a method's range are refused at start-up with the largest step that holds.",
       "a3", stiff_spring});
  cases.push_back({24, "energy, 10^6 steps",
                   "A swing of a million steps. Symplectic methods keep the energy within a band "
                   "for ever; others gain or lose a little at every step, which adds up: RK4 by an "
                   "amount that is known beforehand.",
                   "a3", energy_over_a_million_steps});
}

}  // namespace tumble::battery
