// Rows 3, 9, 10 and 35: boxes on boxes, heavy on light, and steps as long as one likes.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "tests/dynamics/contact_scenes.h"
#include "tests/stability/cases.h"
#include "tests/stability/support.h"

#include "framework/dynamics/solve_contacts.h"

namespace tumble::battery {
namespace {

// of a body's size: penetration that is allowed; there is none here
constexpr double kSlop = 1e-4;

/// Unit boxes one on another, masses from the bottom up; the floor comes last.
scene::Scene stack(const std::vector<double>& masses) {
  std::vector<scene::BodySpec> bodies;
  for (std::size_t i = 0; i < masses.size(); ++i)
    bodies.push_back(rough(box("box" + std::to_string(i), Vector3d(0.5, 0.5, 0.5), masses[i],
                               Vector3d(0, 0, static_cast<double>(i) + 0.5)),
                           0.5));
  bodies.push_back(floor_of(0.5));
  return with_contact("stack", std::move(bodies));
}

/// Error of the impulse at the bottom after so many sweeps of Gauss and Seidel from a cold start,
/// for the fall of a step of 1/60 s.
double bottom_after_sweeps(const std::vector<double>& masses, int sweeps) {
  const ContactProblem problem = testing::stack_of_boxes(masses);
  ContactOptions options;
  options.largest_direct = 0;
  options.most_sweeps_alone = sweeps;
  const ContactSolution solution = solve_contacts(problem, options);
  double mass = 0.0;
  for (const double m : masses) mass += m;
  return std::abs(testing::sum_of_impulses(solution, 0, 4).z() /
                      (mass * testing::kGravity * testing::kStep) -
                  1);
}

report::Plot plot_of_sweeps(const std::vector<double>& masses, const std::string& title) {
  report::Plot plot{
      title,
      {"sweeps", "", report::Scale::kLog},
      {"error of the force at the bottom", "", report::Scale::kLog},
      {},
      {{1e-6, "threshold"}},
      "What sweeps from a cold start know of the weight above; the direct solve needs none."};
  report::Curve curve{"Gauss-Seidel, cold start", {}, {}, true},
      direct{"this project's solver", {}, {}};
  const ContactSolution solution = solve_contacts(testing::stack_of_boxes(masses));
  double mass = 0.0;
  for (const double m : masses) mass += m;
  const double error = std::max(1e-17, std::abs(testing::sum_of_impulses(solution, 0, 4).z() /
                                                    (mass * testing::kGravity * testing::kStep) -
                                                1));
  for (int sweeps = 1; sweeps <= 1000; sweeps *= 2) {
    curve.x.push_back(sweeps),
        curve.y.push_back(std::max(1e-17, bottom_after_sweeps(masses, sweeps)));
    direct.x.push_back(sweeps), direct.y.push_back(error);
  }
  plot.curves = {curve, direct};
  return plot;
}

struct Settled {
  double drift = 0.0, tilt = 0.0, gap = 0.0, kinetic = 0.0, reaction = 0.0;
};

/// Over all frames but the first, in which no force has been solved for yet.
Settled settle(const Trajectory& run, const std::vector<double>& masses) {
  const std::size_t n = masses.size();
  double mass = 0.0;
  for (const double m : masses) mass += m;
  Settled s{drift_of(run, n - 1), 0.0, smallest_gap(run), 0.0, 0.0};
  for (std::size_t b = 0; b < n; ++b) s.tilt = std::max(s.tilt, tilt_of(run, b));
  for (std::size_t i = 1; i < run.frames.size(); ++i) {
    s.kinetic = std::max(s.kinetic, run.frames[i].kinetic_energy / mass);
    s.reaction = std::max(
        s.reaction, std::abs(push_up(run.frames[i], 0, static_cast<int>(n)) / (mass * kG) - 1));
  }
  return s;
}

// ---- Rows 9 and 10 ------------------------------------------------------------------------------

void stack_at_rest(const Given& given, Findings& findings, int n, double duration, double h) {
  const std::vector<double> masses(static_cast<std::size_t>(n), 1.0);
  findings.part(fmt::format("h = 1/{:g} s", 1 / h), [&] {
    const Trajectory run = run_by_steps(stack(masses), given.laws, duration, h, 200);
    const Settled s = settle(run, masses);
    const std::string name = fmt::format("{} boxes, {:g} s, h = 1/{:g} s: ", n, duration, 1 / h);
    findings.at_most(name + "drift of the top", s.drift, 1e-3, "m",
                     "static equilibrium: any creep is the solver's");
    findings.at_most(name + "tilt", s.tilt, 1e-3, "rad", "the same");
    findings.at_most(name + "penetration", std::max(0.0, -s.gap), kSlop, "m",
                     "1e-4 of a box; here nothing overlaps at all");
    findings.at_most(name + "kinetic energy", s.kinetic, 1e-8, "J/kg",
                     "0.14 mm/s: nothing jitters");
    findings.at_most(name + "force at the bottom over N m g - 1", s.reaction, 1e-6, "",
                     "statically determinate sum");
  });
}

void stack_of(const Given& given, Findings& findings, int n, double shortest) {
  for (const double h : {1.0 / 60, 1.0 / 240})
    stack_at_rest(given, findings, n, given.is_long ? 60.0 : shortest, h);
  const std::vector<double> masses(static_cast<std::size_t>(n), 1.0);
  findings.must_fail(
      fmt::format("{} boxes, 10 sweeps of Gauss-Seidel from a cold start: force at the bottom", n),
      bottom_after_sweeps(masses, 10), 1e-6, "", "2.3 N^2 / pi^2 sweeps a decimal digit");
  findings.plot(plot_of_sweeps(masses, fmt::format("Stack of {} boxes: force at the bottom", n)));
}

// ---- Row 3 --------------------------------------------------------------------------------------

void heavy_on_light(const Given& given, Findings& findings) {
  for (const double ratio : {100.0, 1e4}) {
    const std::vector<double> masses{1.0, ratio};
    const std::string name = fmt::format("{:g} kg on 1 kg: ", ratio);
    findings.part(name, [&] {
      const Trajectory run =
          run_by_steps(stack(masses), given.laws, given.is_long ? 10.0 : 3.0, 1.0 / 60, 200);
      const Settled s = settle(run, masses);
      double top = 0.0;
      for (std::size_t i = 1; i < run.frames.size(); ++i)
        top = std::max(top, std::abs(push_up(run.frames[i], 1, 0) / (ratio * kG) - 1));
      findings.at_most(name + "penetration", std::max(0.0, -s.gap), kSlop, "m", "1e-4 of a box");
      findings.at_most(name + "lateral drift", std::max(s.drift, drift_of(run, 0)), 1e-3, "m",
                       "1e-3 of a box");
      findings.at_most(name + "force on the upper box over its weight - 1", top, 1e-6, "",
                       "statically determinate");
      findings.at_most(name + "force at the bottom over all weight - 1", s.reaction, 1e-6, "",
                       "statically determinate");
    });
    findings.must_fail(name + "10 sweeps of Gauss-Seidel, force at the bottom",
                       bottom_after_sweeps(masses, 10), 1e-6, "",
                       "each sweep moves 1 / ratio of what is missing");
  }
  findings.plot(plot_of_sweeps({1.0, 1e4}, "10^4 kg on 1 kg: force at the bottom"));
}

// ---- Row 35 -------------------------------------------------------------------------------------

void large_steps(const Given& given, Findings& findings) {
  report::Plot plot{"A block slides down an incline and stops: error of its way",
                    {"step", "s", report::Scale::kLog},
                    {"error", "m", report::Scale::kLog},
                    {},
                    {{1e-6, "threshold"}},
                    "Constant forces are followed exactly and the end of sliding is located: the "
                    "step does not enter."};
  report::Curve located{"this project", {}, {}, true},
      steps{"stop at the end of a step", {}, {}, true};
  const double angle = 20 * std::numbers::pi / 180, mu = 0.5,
               deceleration = kG * (mu * std::cos(angle) - std::sin(angle)),
               way = 9.0 / (2 * deceleration);
  for (const double h : {1.0 / 240, 1.0 / 60, 0.1, 0.5}) {
    const Vector3d normal(std::sin(angle), 0, std::cos(angle)),
        down(std::cos(angle), 0, -std::sin(angle));
    scene::BodySpec block =
        turned(rough(box("block", Vector3d(0.1, 0.1, 0.05), 1.0, 0.05 * normal), mu), angle,
               Vector3d::UnitY());
    block.velocity_m_s = 3.0 * down;
    const Trajectory run =
        run_by_steps(with_contact("slope", {block, turned(floor_of(mu), angle, Vector3d::UnitY())}),
                     given.laws, 4.0, h, 100);
    const double error = std::abs(drift_of(run, 0) - way);
    findings.at_most(fmt::format("block that slides and stops, h = {:.3g} s: way", h), error, 1e-6,
                     "m", "event-driven: the end of sliding is located within the step");
    located.x.push_back(h), located.y.push_back(std::max(error, 1e-17));
    // Implicit Euler with friction at the end of the step, as time-stepping engines do.
    double x = 0.0, v = 3.0;
    for (int i = 0; v > 0; ++i) v = std::max(0.0, v - h * deceleration), x += h * v;
    steps.x.push_back(h), steps.y.push_back(std::abs(x - way));
    if (h == 0.1)
      findings.must_fail("the same with the stop at the end of a step, h = 0.1 s: way",
                         std::abs(x - way), 1e-6, "m", "of order h");
  }
  plot.curves = {located, steps};
  findings.plot(std::move(plot));
  for (const double h : {1.0 / 60, 0.1, 0.5}) {
    std::vector<scene::BodySpec> bodies;
    for (int row = 0; row < 4; ++row)
      for (int i = 0; i < 4 - row; ++i)
        bodies.push_back(rough(box(fmt::format("box{}{}", row, i), Vector3d(0.25, 0.25, 0.25), 1.0,
                                   Vector3d(0.55 * (i + 0.5 * row), 0, 0.25 + 0.5 * row)),
                               0.5));
    bodies.push_back(floor_of(0.5));
    const Trajectory run = run_by_steps(with_contact("pyramid", bodies), given.laws, 5.0, h, 50);
    double drift = 0.0;
    for (std::size_t b = 0; b + 1 < bodies.size(); ++b) drift = std::max(drift, drift_of(run, b));
    findings.at_most(
        fmt::format("pyramid of 10 boxes, h = {:.3g} s: contact problems left unsolved", h),
        static_cast<double>(run.counters.counts.at("contact_unsolved")), 0.0, "",
        "the solver converges whatever the step");
    findings.at_most(fmt::format("pyramid of 10 boxes, h = {:.3g} s, 5 s: drift", h), drift, 1e-3,
                     "m", "accuracy limits a step, not the solver");
  }
}

}  // namespace

void add_stacks(std::vector<Case>& cases) {
  cases.push_back({3, "mass ratio, stacked",
                   "A hundred kilograms, and ten tons, on a box of one kilogram. Iterative solvers "
                   "clip, topple or squeeze the light box out: in one sweep it can pass on only "
                   "what its own mass allows. The forces are determined by statics alone.",
                   "a1 a3", heavy_on_light});
  cases.push_back({9, "stack of 10",
                   "Ten boxes at rest. What a solver leaves unsolved makes them creep, lean and "
                   "jitter; from a cold start a sweep carries a force up by one box.",
                   "a1 a3", [](const Given& given, Findings& findings) {
                     stack_of(given, findings, 10, 4.0);
                   }});
  cases.push_back({10, "stack of 50",
                   "Fifty boxes at rest: sweeps from a cold start need 580 for every digit of the "
                   "force at the bottom.",
                   "a1 a3", [](const Given& given, Findings& findings) {
                     stack_of(given, findings, 50, 1.0);
                   }});
  cases.push_back(
      {35, "large steps",
       "Steps from 4 milliseconds to half a second. The contact problem of each must be solved "
       "whatever its size: accuracy and tunnelling limit a step, the solver must not.",
       "a1 a3", large_steps});
}

}  // namespace tumble::battery
