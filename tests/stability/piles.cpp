// Rows 30 and 34: dense piles, and what is not part of the battery yet.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "tests/stability/cases.h"
#include "tests/stability/support.h"

namespace tumble::battery {
namespace {

constexpr double kRadius = 0.1;

/// n^3 balls of 10 kg close above each other, a little askew, between four walls (SimBenchmark's 666).
scene::Scene pile(int n, bool elastic) {
  std::vector<scene::BodySpec> bodies;
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const double skew = 0.02 * kRadius * ((3 * i + 5 * j + 7 * k) % 5 - 2);
        const Vector3d place((2.1 * i + 1.1) * kRadius + skew, (2.1 * j + 1.1) * kRadius - skew, (2.1 * k + 1.1) * kRadius);
        bodies.push_back(truths::ball(fmt::format("ball{}{}{}", i, j, k), 10.0, kRadius, place, Vector3d::Zero(), elastic ? 1.0 : 0.0));
      }
  const double width = (2.1 * n + 0.1) * kRadius, e = elastic ? 1.0 : 0.0;
  bodies.push_back(truths::wall("floor", Vector3d::Zero(), Vector3d::UnitZ(), e));
  for (int axis = 0; axis < 2; ++axis) {
    bodies.push_back(truths::wall("low", Vector3d::Zero(), Vector3d::Unit(axis), e));
    bodies.push_back(truths::wall("high", width * Vector3d::Unit(axis), -Vector3d::Unit(axis), e));
  }
  scene::Scene scene = with_contact("pile", std::move(bodies));
  if (elastic) scene.contact.reset();
  else if (n > 3) scene.contact->plastic_impacts = scene::PlasticImpacts::kInStep;   // what one blow changes changes dozens of others in the same instant
  return scene;
}

void dense_pile(const Given& given, Findings& findings) {
  const int n = given.is_long ? 6 : 3;
  const double duration = given.is_long ? 2.0 : 0.6;
  const std::string size = fmt::format("{0} x {0} x {0} balls", n);
  findings.part(size + ", e = 0", [&] {
    const Trajectory run = run_by_steps(pile(n, false), given.laws, duration, 1e-3, 100);
    findings.at_most(size + fmt::format(", e = 0, mu = 0, {:g} s: penetration over the diameter", duration), std::max(0.0, -smallest_gap(run)) / (2 * kRadius), 1e-4, "", "the mean is asked for; the worst is taken");
    findings.at_most(size + ": rise of the energy over what was there", energy_rise(run), 1e-9, "", "plastic impacts only take");
    findings.plot({"Pile of " + size + ", e = 0", {"time", "s"}, {"kinetic energy", "J", report::Scale::kLog}, {curve_of("kinetic energy", run, [](const Frame& f) { return std::max(1e-12, f.kinetic_energy); })}, {}, "It comes to rest without a ball inside another."});
  });
  findings.part("elastic", [&] {
    const Trajectory run = run_by_steps(pile(n, true), given.laws, given.is_long ? 2.0 : 0.5, 1e-3, 100);
    findings.at_most(size + ", e = 1: energy", energy_drift(run, energy_of(run.frames.front())), 1e-3, "", "SimBenchmark's limit; impacts at their instants keep it to rounding");
    findings.at_least(size + ", e = 1: smallest gap", smallest_gap(run), 0.0, "m", "nothing interpenetrates");
  });
  // Springs between balls, as stiff as a step of 1 ms bears (w h = 1): k = m / h^2 sinks by m g n / k at the bottom.
  findings.must_fail("penalty springs as stiff as w h = 1 bears, 6 layers at rest: penetration over the diameter", 6 * 10.0 * kG / (10.0 / 1e-6) / (2 * kRadius), 1e-4, "", "six weights on a spring of m / h^2 = 1e7 N/m");
}

}  // namespace

void add_piles(std::vector<Case>& cases) {
  cases.push_back({30, "dense pile", "Heavy balls without friction fall on each other between walls (SimBenchmark's 666). Hundreds of contacts begin within milliseconds; engines leave balls inside each other or blow up.", "a1 a3", dense_pile});
  cases.push_back({34, "soft contact", "A penalty spring needs steps two to three orders of magnitude smaller than a hard contact for the same scene.", "", {}, "there is no soft contact to compare with: contacts of this project are hard"});
}

}  // namespace tumble::battery
