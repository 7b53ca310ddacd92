// Rows 2 and 4: masses far apart on rods, and long chains.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "tests/stability/cases.h"
#include "tests/stability/methods.h"
#include "tests/stability/support.h"

namespace tumble::battery {
namespace {

/// Largest relative error of any rod's tension in a chain that hangs, over all frames.
double tension_error(const Trajectory& run, const std::vector<double>& masses) {
  double worst = 0.0;
  for (const Frame& frame : run.frames) {
    double hanging = 0.0;
    for (std::size_t i = masses.size(); i-- > 0;) {
      hanging += masses[i] * kG;
      worst = std::max(worst, std::abs(frame.rod_tensions[i] / hanging - 1));
    }
  }
  return worst;
}

double length_error(const Trajectory& run, double length) {
  double worst = 0.0;
  for (const Frame& frame : run.frames) {
    Vector3d above = Vector3d::Zero();
    for (const BodyPose& pose : frame.poses) {
      worst = std::max(worst, std::abs((pose.com_world - above).norm() - length));
      above = pose.com_world;
    }
  }
  return worst;
}

// ---- Row 2 --------------------------------------------------------------------------------------

void mass_ratio_hanging(const Given& given, Findings& findings) {
  const Vector3d down = -Vector3d::UnitZ();
  report::Plot plot{"Tension of the upper rod: light above heavy",
                    {"mass ratio", "", report::Scale::kLog},
                    {"relative error", "", report::Scale::kLog},
                    {},
                    {{1e-8, "threshold"}},
                    "A direct solve loses digits with the condition number, some 4 times the "
                    "ratio; ten sweeps of Gauss and Seidel are wrong from a ratio of 10 on."};
  report::Curve direct{"sparse direct solve", {}, {}, true},
      sweeps{"10 sweeps of Gauss-Seidel", {}, {}, true}, bound{"2^-53 x condition number", {}, {}};
  const Laws bad = with_gauss_seidel(given.laws, 10);
  for (const double ratio : {1.0, 10.0, 1e2, 1e4, 1e6}) {
    const std::vector<double> masses{1.0, ratio};
    const double error =
        tension_error(run_by_steps(chain(masses, 0.7, down), given.laws, 0.5, 0.01, 5), masses);
    const double swept =
        tension_error(run_by_steps(chain(masses, 0.7, down), bad, 0.01, 0.01, 1), masses);
    direct.x.push_back(ratio), direct.y.push_back(std::max(error, 1e-17));
    sweeps.x.push_back(ratio), sweeps.y.push_back(swept);
    bound.x.push_back(ratio), bound.y.push_back(kRounding * 4 * ratio);
    if (ratio != 1e2 && ratio != 1e6) continue;
    findings.at_most(fmt::format("1 kg above {:g} kg: tensions", ratio), error, 1e-8, "",
                     "kappa = 4 x ratio = 4e6, u kappa = 4e-10, times 25");
    findings.must_fail(
        fmt::format("1 kg above {:g} kg, 10 sweeps of Gauss-Seidel: tensions", ratio), swept, 1e-8,
        "", "each sweep takes off 1/(2 ratio) of the error");
  }
  const std::vector<double> alternating{1e-6, 1.0, 1e-6, 1.0};
  findings.at_most(
      "light and heavy by turns, 1 : 10^6: tensions",
      tension_error(run_by_steps(chain(alternating, 0.7, down), given.laws, 0.5, 0.01, 5),
                    alternating),
      1e-8, "", "as above");
  plot.curves = {direct, sweeps, bound};
  findings.plot(std::move(plot));
  for (const char* id :
       {"double_pendulum/mass_ratio_1_100", "double_pendulum/rest_horizontal_equal"})
    compare_with_truth(given, findings, id);
}

// ---- Row 4 --------------------------------------------------------------------------------------

void hanging_hundred(const Given& given, Findings& findings, report::Plot& plot) {
  constexpr int n = 100;
  constexpr double kLength = 0.1;
  const std::vector<double> masses(n, 0.5);
  const double duration = given.is_long ? 60.0 : 2.0;
  const Trajectory run =
      run_by_steps(chain(masses, kLength, -Vector3d::UnitZ()), given.laws, duration, 1.0 / 60, 120);
  const double whole = n * 0.5 * kG;
  double top = 0.0;
  for (const Frame& frame : run.frames)
    top = std::max(top, std::abs(frame.rod_tensions[0] / whole - 1));
  findings.at_most("100 links hanging: tension of the top", top, 1e-10, "",
                   "kappa = 4 (n + 1)^2 / pi^2 = 4.1e3, u kappa = 5e-13");
  findings.at_most(fmt::format("100 links hanging, {:g} s: lowest bob, of the length", duration),
                   drift_of(run, n - 1) / (n * kLength), 1e-6, "",
                   "separates a direct solve from an iterative one, which lets it stretch");
  plot.curves.push_back(curve_of("sparse direct solve", run, [&](const Frame& frame) {
    return std::max(1e-17, std::abs(frame.poses[n - 1].com_world.z() / (n * kLength) + 1));
  }));
  // Without projection: what ten sweeps leave of the forces moves the chain.
  scene::Scene swept = chain(masses, kLength, -Vector3d::UnitZ());
  swept.stabilisation->kind = scene::StabilisationKind::kBaumgarte;
  const Trajectory stretched =
      run_by_steps(swept, with_gauss_seidel(given.laws, 10), 1.0, 1.0 / 60, 60);
  findings.must_fail("the same by 10 sweeps of Gauss-Seidel, 1 s: lowest bob, of the length",
                     drift_of(stretched, n - 1) / (n * kLength), 1e-6, "",
                     "it contracts by cos^2(pi / (n + 1)): 2.3e3 sweeps a decimal digit");
  plot.curves.push_back(curve_of("10 sweeps of Gauss-Seidel", stretched, [&](const Frame& frame) {
    return std::max(1e-17, std::abs(frame.poses[n - 1].com_world.z() / (n * kLength) + 1));
  }));
}

void swinging_hundred(const Given& given, Findings& findings) {
  constexpr int n = 100;
  const double duration = given.is_long ? 60.0 : 1.0, h = 1.0 / 240;
  const Trajectory run = run_by_steps(
      chain(std::vector<double>(n, 0.5), 0.1, Vector3d(0.6, 0, -0.8)), given.laws, duration, h, 60);
  findings.at_most(
      fmt::format("100 links let go at 37 degrees, {:g} s: length of any link, of the chain",
                  duration),
      length_error(run, 0.1) / (n * 0.1), 1e-6, "",
      "constraint residual with projection: roundings; the table asks for 1e-6 of the length");
}

void long_chain(const Given& given, Findings& findings) {
  report::Plot plot{
      "Chain of 100 links, hanging: how far its end is from where it belongs",
      {"time", "s"},
      {"of the length", "", report::Scale::kLog},
      {},
      {{1e-6, "threshold"}},
      "With the same forces solved by ten sweeps the chain stretches and swings like rubber."};
  findings.part("hanging", [&] { hanging_hundred(given, findings, plot); });
  findings.plot(std::move(plot));
  findings.part("swinging", [&] { swinging_hundred(given, findings); });
  compare_with_truth(given, findings, "chain/links4_uneven");
  compare_with_truth(given, findings, "chain/links8_horizontal");
}

}  // namespace

void add_chains(std::vector<Case>& cases) {
  cases.push_back(
      {2, "mass ratio, hanging",
       "A light bob on a rod carries one up to a million times heavier. Solvers that pass over the "
       "constraints some ten times cannot build up the force in the iterations they have: "
       "the rod stretches. A direct solve loses digits only as the condition number says.",
       "a3", mass_ratio_hanging});
  cases.push_back(
      {4, "chain of 100 links",
       "A chain of 100 rods hangs at rest, or is let go. A sweep passes a force on by one link, so "
       "that ten sweeps know nothing of ninety links: the chain stretches. "
       "A sparse direct solve costs as much a link and is exact.",
       "a3", long_chain});
}

}  // namespace tumble::battery
