// Rows 30 and 34: dense piles, and hard contact against penalty springs.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "tests/stability/cases.h"
#include "tests/stability/support.h"

namespace tumble::battery {
namespace {

constexpr double kRadius = 0.1;

/// n^3 balls of 10 kg close above each other, a little askew, between four walls (SimBenchmark's
/// 666).
scene::Scene pile(int n, bool elastic) {
  std::vector<scene::BodySpec> bodies;
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const double skew = 0.02 * kRadius * ((3 * i + 5 * j + 7 * k) % 5 - 2);
        const Vector3d place((2.1 * i + 1.1) * kRadius + skew, (2.1 * j + 1.1) * kRadius - skew,
                             (2.1 * k + 1.1) * kRadius);
        bodies.push_back(truths::ball(fmt::format("ball{}{}{}", i, j, k), 10.0, kRadius, place,
                                      Vector3d::Zero(), elastic ? 1.0 : 0.0));
      }
  const double width = (2.1 * n + 0.1) * kRadius, e = elastic ? 1.0 : 0.0;
  bodies.push_back(truths::wall("floor", Vector3d::Zero(), Vector3d::UnitZ(), e));
  for (int axis = 0; axis < 2; ++axis) {
    bodies.push_back(truths::wall("low", Vector3d::Zero(), Vector3d::Unit(axis), e));
    bodies.push_back(truths::wall("high", width * Vector3d::Unit(axis), -Vector3d::Unit(axis), e));
  }
  scene::Scene scene = with_contact("pile", std::move(bodies));
  if (elastic) scene.contact.reset();
  // what one impact changes changes dozens of others in the same instant
  else if (n > 3)
    scene.contact->plastic_impacts = scene::PlasticImpacts::kInStep;
  return scene;
}

void dense_pile(const Given& given, Findings& findings) {
  const int n = given.is_long ? 6 : 3;
  constexpr double duration = 0.6;
  const std::string size = fmt::format("{0} x {0} x {0} balls", n);
  findings.part(size + ", e = 0", [&] {
    const Trajectory run = run_by_steps(pile(n, false), given.laws, duration, 1e-3, 100);
    findings.at_most(
        size + fmt::format(", e = 0, mu = 0, {:g} s: penetration over the diameter", duration),
        std::max(0.0, -smallest_gap(run)) / (2 * kRadius), 1e-4, "",
        "the mean is asked for; the worst is taken");
    if (given.is_long)
      findings.at_most(
          size + ": rise of the energy over what was there", energy_rise(run), 1e-3, "",
          "SimBenchmark's limit; plastic impacts only take, but taken with the step they fall into "
          "('in_step') they give back a shell of 1e-4 of a ball here and there");
    else
      findings.at_most(size + ": rise of the energy over what was there", energy_rise(run), 1e-7,
                       "",
                       "plastic impacts only take; a ball that follows another's curve is right to "
                       "second order in the step: 1.2e-8 at 1 ms, 7.5e-10 at 0.5 ms");
    findings.plot({"Pile of " + size + ", e = 0",
                   {"time", "s"},
                   {"kinetic energy", "J", report::Scale::kLog},
                   {curve_of("kinetic energy", run,
                             [](const Frame& f) { return std::max(1e-12, f.kinetic_energy); })},
                   {},
                   "It comes to rest without a ball inside another."});
  });
  findings.part("elastic", [&] {
    const Trajectory run =
        run_by_steps(pile(n, true), given.laws, given.is_long ? 2.0 : 0.5, 1e-3, 100);
    findings.at_most(size + ", e = 1: energy", energy_drift(run, energy_of(run.frames.front())),
                     1e-3, "",
                     "SimBenchmark's limit; impacts at their instants keep it to rounding");
    findings.at_least(size + ", e = 1: smallest gap", smallest_gap(run), 0.0, "m",
                      "nothing interpenetrates");
  });
  // Springs between balls, as stiff as a step of 1 ms bears (w h = 1): k = m / h^2 sinks by m g n /
  // k at the bottom.
  findings.must_fail(
      "penalty springs as stiff as w h = 1 bears, 6 layers at rest: penetration over the diameter",
      6 * 10.0 * kG / (10.0 / 1e-6) / (2 * kRadius), 1e-4, "",
      "six weights on a spring of m / h^2 = 1e7 N/m");
}

// ---- Row 34 -------------------------------------------------------------------------------------

constexpr int kColumn = 10;  // unit boxes of 1 kg
// m: how deep penalty springs may let the lowest of them sink, as much as a hard contact is allowed
constexpr double kSinks = 1e-4;
constexpr double kStiffness = kColumn * kG / kSinks;  // N/m

/// Largest way of any box of a column on penalty springs from where it belongs, by symplectic
/// Euler; in 5 s or until it is thrown off. [m] Springs push only; they start with the load they
/// carry, so that nothing moves unless the method moves it but for a touch of 1 um/s.
double way_on_penalty_springs(double h) {
  std::vector<double> z(kColumn), v(kColumn, 0.0), rest(kColumn);
  double below = 0.0;
  for (int i = 0; i < kColumn; ++i)
    rest[i] = z[i] = below = below + 1.0 - (kColumn - i) * kG / kStiffness;
  v.back() = 1e-6;
  double way = 0.0;
  for (long k = 0; static_cast<double>(k) * h < 5.0 && way < 1e3; ++k) {
    std::vector<double> push(kColumn + 1, 0.0);  // from below on box i
    for (int i = 0; i < kColumn; ++i)
      push[i] = kStiffness * std::max(0.0, 1.0 - (z[i] - (i > 0 ? z[i - 1] : 0.0)));
    for (int i = 0; i < kColumn; ++i) {
      v[i] += h * (push[i] - push[i + 1] - kG);
      z[i] += h * v[i];
      way = std::max(way, std::abs(z[i] - rest[i]));
    }
  }
  return way;
}

void soft_contact(const Given& given, Findings& findings) {
  constexpr double kHardStep = 0.5, kDrift = 1e-3;  // s, m
  std::vector<scene::BodySpec> bodies;
  for (int i = 0; i < kColumn; ++i)
    bodies.push_back(
        rough(box("box" + std::to_string(i), Vector3d(0.5, 0.5, 0.5), 1.0, Vector3d(0, 0, i + 0.5)),
              0.5));
  bodies.push_back(floor_of(0.5));
  const Trajectory run =
      run_by_steps(with_contact("column", std::move(bodies)), given.laws, 5.0, kHardStep, 10);
  findings.at_most("column of 10 boxes, hard contacts, h = 0.5 s: drift of the top",
                   drift_of(run, kColumn - 1), kDrift, "m", "1e-3 of a box");
  findings.at_most("column of 10 boxes, hard contacts: penetration",
                   std::max(0.0, -smallest_gap(run)), kSinks, "m",
                   "1e-4 of a box; here nothing overlaps at all");
  report::Plot plot{"Column of 10 boxes on penalty springs that sink 1e-4 of a box: way in 5 s",
                    {"step", "s", report::Scale::kLog},
                    {"way", "m", report::Scale::kLog},
                    {},
                    {{kDrift, "threshold"}},
                    "The springs' fastest swing allows steps of 2 / (2 sqrt(k / m)) = 1 ms; hard "
                    "contacts hold at any step."};
  report::Curve curve{"penalty springs", {}, {}, true};
  double largest = 0.0;
  for (double h = 1.0 / 60; h > 1e-4; h /= std::sqrt(2.0)) {
    const double way = way_on_penalty_springs(h);
    curve.x.push_back(h), curve.y.push_back(std::max(1e-12, way));
    if (h == 1.0 / 60)
      findings.must_fail("the same on penalty springs, h = 1/60 s: way", way, kDrift, "m",
                         "w h = 33 for the fastest swing, stable is 2");
    if (way <= kDrift) largest = std::max(largest, h);
  }
  findings.at_least(
      "step that hard contacts hold at, over the largest that penalty springs do",
      largest > 0 ? kHardStep / largest : 0.0, 100.0, "",
      "Chrono reports two to three orders of magnitude; 2 / (2 sqrt(k / m)) = 1.0e-3 s says 500");
  plot.curves = {curve};
  findings.plot(std::move(plot));
}

}  // namespace

void add_piles(std::vector<Case>& cases) {
  cases.push_back({30, "dense pile",
                   "Heavy balls without friction fall on each other between walls (SimBenchmark's "
                   "666). Hundreds of contacts begin within milliseconds; engines leave balls "
                   "inside each other or blow up.",
                   "a1 a3", dense_pile});
  cases.push_back({34, "soft contact",
                   "A penalty spring stiff enough to sink no deeper than a hard contact may needs "
                   "steps two to three orders of magnitude smaller for the same column of boxes.",
                   "a1 a3", soft_contact});
}

}  // namespace tumble::battery
