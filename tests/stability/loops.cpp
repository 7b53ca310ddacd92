// Rows 5 and 6: closed loops that pass a singular posture, and constraints that say the same twice.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "framework/core/shortest_turn.h"
#include "framework/effects/gravity/gravity.h"
#include "framework/effects/joint/joint.h"
#include "tests/stability/cases.h"
#include "tests/stability/methods.h"
#include "tests/stability/support.h"

namespace tumble::battery {
namespace {

// ---- Row 5 --------------------------------------------------------------------------------------

/// A slender link of 1 m and 1 kg between two points.
scene::BodySpec link(const std::string& name, const Vector3d& from, const Vector3d& to) {
  scene::BodySpec body = truths::point_mass(name, 1.0, 0.5 * (from + to), Vector3d::Zero());
  // along x of the body
  body.inertia_body_kg_m2 = Vector3d(1e-3, 1.0 / 12, 1.0 / 12).asDiagonal();
  body.world_from_body = shortest_turn(Vector3d::UnitX(), to - from);
  return body;
}

/// N four-bars side by side (IFToMM benchmark A02): N + 1 cranks on the ground, N couplers; the
/// cranks stand upright and go at 1 m/s.
scene::Scene four_bars(int n) {
  scene::Scene scene = truths::empty_scene("four-bars", 1.0, 1e-9);
  effects::set_gravity(scene, kDown);
  scene.stabilisation = scene::StabilisationSpec{};
  const Vector3d y = Vector3d::UnitY();
  for (int i = 0; i <= n; ++i) {
    const Vector3d ground(i, 0, 0), top(i, 0, 1);
    scene::BodySpec crank = link("crank" + std::to_string(i), ground, top);
    crank.velocity_m_s = Vector3d(0.5, 0, 0);
    crank.omega_world_rad_s = y;
    scene.bodies.push_back(crank);
    scene.effects.of<effects::JointSpec>().push_back(
        {"A" + std::to_string(i), effects::JointKind::kHinge, crank.name, "", ground, y});
  }
  for (int i = 0; i < n; ++i) {
    const Vector3d left(i, 0, 1), right(i + 1, 0, 1);
    scene::BodySpec coupler = link("coupler" + std::to_string(i), left, right);
    coupler.velocity_m_s = Vector3d(1, 0, 0);
    scene.bodies.push_back(coupler);
    scene.effects.of<effects::JointSpec>().push_back({"L" + std::to_string(i),
                                                      effects::JointKind::kHinge, coupler.name,
                                                      "crank" + std::to_string(i), left, y});
    scene.effects.of<effects::JointSpec>().push_back({"R" + std::to_string(i),
                                                      effects::JointKind::kHinge, coupler.name,
                                                      "crank" + std::to_string(i + 1), right, y});
  }
  return scene;
}

/// Where B0 is at each time: cranks at an angle a from upright, a'' = P/I sin a by the energy of
/// parallel cranks alone.
std::vector<Vector3d> parallel_cranks(int n, const std::vector<double>& times) {
  const double inertia = (n + 1) / 3.0 + n, moment = kG * (0.5 * (n + 1) + n);
  std::vector<Vector3d> places;
  VectorXd y(2);
  y << 0.0, 1.0;
  const OdeFunction f = [&](double, const VectorXd& s) {
    return Eigen::Vector2d(s[1], moment / inertia * std::sin(s[0]));
  };
  double t = 0.0;
  for (const double until : times) {
    const int parts = std::max(1, static_cast<int>(std::ceil((until - t) / 2e-4)));
    for (int i = 0; i < parts; ++i) y = rk4(f, t, y, (until - t) / parts);
    t = until;
    places.emplace_back(std::sin(y[0]), 0.0, std::cos(y[0]));
  }
  return places;
}

void loop_of(const Given& given, Findings& findings, int n, double duration, double h,
             report::Plot& plot) {
  const scene::Scene scene = four_bars(n);
  const Trajectory run = run_by_steps(scene, with_method(given.laws, "RK4", rk4), duration, h, 400);
  const std::string name = fmt::format("{} loops, {:g} s, h = {:g} s", n, duration, h);
  std::vector<double> times;
  for (const Frame& frame : run.frames) times.push_back(frame.time);
  const std::vector<Vector3d> exact = parallel_cranks(n, times);
  double place = 0.0, residual = 0.0, slant = 0.0;
  report::Curve curve{fmt::format("{} loops", n), times, {}};
  for (std::size_t i = 0; i < run.frames.size(); ++i) {
    const auto& poses = run.frames[i].poses;
    const auto end = [&](std::size_t body, double side) -> Vector3d {
      return poses[body].com_world + poses[body].world_from_body * Vector3d(0.5 * side, 0, 0);
    };
    const double error = (end(0, 1) - exact[i]).norm();
    place = std::max(place, error);
    curve.y.push_back(std::max(error, 1e-17));
    for (std::size_t k = 0; k <= static_cast<std::size_t>(n); ++k)
      residual = std::max(residual, (end(k, -1) - Vector3d(static_cast<double>(k), 0, 0)).norm());
    for (std::size_t k = 0; k < static_cast<std::size_t>(n); ++k) {
      const std::size_t coupler = static_cast<std::size_t>(n) + 1 + k;
      residual = std::max({residual, (end(coupler, -1) - end(k, 1)).norm(),
                           (end(coupler, 1) - end(k + 1, 1)).norm()});
      slant = std::max(slant, std::abs((end(coupler, 1) - end(coupler, -1)).z()));
    }
  }
  const double scale = run.frames.front().kinetic_energy + kG * (0.5 * (n + 1) + n);
  findings.at_most(name + ": energy", energy_drift(run, scale), 1e-6, "",
                   "RK4 at 1 ms, over the energy of the fall");
  findings.at_most(name + ": place of B0 over 400 samples", place, 1e-3, "m",
                   "the benchmark's limit for high precision; truth: one angle, parallel cranks");
  findings.at_most(name + ": couplers stay level", slant, 1e-3, "m",
                   "at the horizontal the mechanism could fold: no switch of branch");
  findings.at_most(name + ": joints", residual, 1e-9, "m", "projected at every step's end");
  plot.curves.push_back(std::move(curve));
}

void closed_loop(const Given& given, Findings& findings) {
  report::Plot plot{"N four-bars through the singular posture: place of B0",
                    {"time", "s"},
                    {"error", "m", report::Scale::kLog},
                    {},
                    {{1e-3, "limit for high precision"}},
                    "Twice in every turn all links lie along one line, where N + 1 motions are "
                    "possible instead of one."};
  findings.part("2 loops",
                [&] { loop_of(given, findings, 2, given.is_long ? 20.0 : 3.0, 1e-3, plot); });
  if (given.is_long)
    findings.part("40 loops", [&] { loop_of(given, findings, 40, 20.0, 1e-3, plot); });
  findings.plot(std::move(plot));
  findings.part("without stabilisation", [&] {
    scene::Scene scene = four_bars(2);
    scene.stabilisation->kind = scene::StabilisationKind::kNone;
    const Trajectory run = run_by_steps(scene, with_method(given.laws, "RK4", rk4), 3.0, 0.01, 100);
    double residual = 0.0;
    for (const Frame& frame : run.frames)
      residual = std::max(residual, (frame.poses[0].com_world +
                                     frame.poses[0].world_from_body * Vector3d(-0.5, 0, 0))
                                        .norm());
    findings.must_fail("2 loops without stabilisation, h = 0.01 s: joint A0", residual, 1e-9, "m",
                       "accelerations alone keep no place: errors of the method add up");
  });
}

// ---- Row 6 --------------------------------------------------------------------------------------

void redundant(const Given& given, Findings& findings) {
  const scene::Scene once = chain({1.0, 0.5, 2.0, 1.0}, 0.5, Vector3d(0.8, 0, -0.6));
  scene::Scene twice = once;
  std::vector<effects::RodSpec>& rods = twice.effects.of<effects::RodSpec>();
  rods.push_back(effects::RodSpec(rods[1]));
  rods.back().name = "the same again";
  const double duration = given.is_long ? 10.0 : 2.0;
  const Trajectory single = run_by_steps(once, given.laws, duration, 1e-3, 200),
                   doubled = run_by_steps(twice, given.laws, duration, 1e-3, 200);
  double places = 0.0, forces = 0.0;
  report::Curve a{"place of the last bob", {}, {}}, b{"sum of the two rods' forces", {}, {}};
  for (std::size_t i = 0; i < single.frames.size(); ++i) {
    const Frame &s = single.frames[i], &d = doubled.frames[i];
    const double place = (s.poses.back().com_world - d.poses.back().com_world).norm(),
                 force = std::abs(d.rod_tensions[1] + d.rod_tensions[4] - s.rod_tensions[1]) /
                         std::abs(s.rod_tensions[0]);
    places = std::max(places, place);
    forces = std::max(forces, force);
    a.x.push_back(s.time), a.y.push_back(std::max(place, 1e-17));
    b.x.push_back(s.time), b.y.push_back(std::max(force, 1e-17));
  }
  const std::string name = fmt::format("chain of 4, one rod entered twice, {:g} s", duration);
  findings.at_most(name + ": places against the single one", places, 1e-9, "m",
                   "a chain of 4 multiplies errors by less than 1e4 in that time");
  findings.at_most(
      name + ": sum of the two forces against the single one", forces, 1e-9, "",
      "which of the two carries how much is not determined; what they carry together is");
  findings.plot({"One rod of a chain entered twice: difference from the single one",
                 {"time", "s"},
                 {"m, and of the top's force", "", report::Scale::kLog},
                 {a, b},
                 {{1e-9, "threshold"}},
                 "The matrix of the constraints is singular; the motion is not."});
  findings.part("sweeps", [&] {
    const Trajectory swept = run_by_steps(twice, with_gauss_seidel(given.laws, 10), 0.1, 1e-3, 20),
                     right = run_by_steps(once, given.laws, 0.1, 1e-3, 20);
    double worst = 0.0;
    for (std::size_t i = 0; i < swept.frames.size(); ++i)
      worst = std::max(worst,
                       std::abs(swept.frames[i].rod_tensions[1] + swept.frames[i].rod_tensions[4] -
                                right.frames[i].rod_tensions[1]) /
                           std::abs(right.frames[i].rod_tensions[0]));
    findings.must_fail("the same by 10 sweeps of Gauss-Seidel: sum of the forces", worst, 1e-9, "",
                       "sweeps share a load among equal rows, but do not get to the end of it");
  });
  if (!given.laws.collision_impulse)
    return findings.not_run("table on four legs",
                            "needs the laws of a1, which nobody provides here");
  findings.part("table on four legs", [&] {
    const scene::Scene table = with_contact(
        "table", {rough(box("table", Vector3d(0.5, 0.5, 0.05), 8.0, Vector3d(0, 0, 0.05)), 0.5),
                  floor_of(0.5)});
    const Trajectory run = run_by_steps(table, given.laws, 1.0, 1.0 / 60, 60);
    double worst = 0.0;
    for (std::size_t i = 1; i < run.frames.size(); ++i)
      worst = std::max(worst, std::abs(push_up(run.frames[i], 0, 1) / (8 * kG) - 1));
    findings.at_most("table on four legs: their sum against the weight", worst, 1e-9, "",
                     "four legs, three equations: the single forces are not unique, their sum is");
  });
}

}  // namespace

void add_loops(std::vector<Case>& cases) {
  cases.push_back({5, "closed loop",
                   "Cranks and couplers in a row (IFToMM benchmark A02). Where all links lie along "
                   "one line the constraints lose their rank and the mechanism could fold: "
                   "codes that expect independent rows stop or switch branch there. In space its "
                   "hinges are redundant everywhere.",
                   "a3", closed_loop});
  cases.push_back(
      {6, "redundant constraints",
       "The same rod twice, or a table on four legs. The matrix of the constraints is singular, so "
       "that single forces are not determined, but the motion and the sums are. "
       "A solver that expects independent rows divides by rounding; one that sweeps does not "
       "arrive.",
       "a3", redundant});
}

}  // namespace tumble::battery
