// Rows 15, 19 and 32: infinitely many bounces in finite time, impacts at one instant, chaos.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "framework/effects/gravity/gravity.h"
#include "tests/stability/cases.h"
#include "tests/stability/support.h"

namespace tumble::battery {
namespace {

// ---- Row 15 -------------------------------------------------------------------------------------

scene::Scene dropped(double e, double restitution_threshold) {
  scene::Scene scene = truths::empty_scene("zeno", 1.0, restitution_threshold);
  effects::set_gravity(scene, kDown);
  scene.bodies = {truths::ball("ball", 1.0, 0.1, Vector3d(0, 0, 1.1), Vector3d::Zero(), e),
                  truths::wall("floor", Vector3d::Zero(), Vector3d::UnitZ(), 1.0)};
  return scene;
}

/// Time of the tenth bounce of a method that looks at the ends of its steps only.
double tenth_bounce_at_steps(double e, double h) {
  double z = 1.0, v = 0.0;
  int bounces = 0;
  for (long i = 1; i < 100000; ++i) {
    v -= kG * h;
    z += v * h;
    if (z >= 0 || v >= 0) continue;
    v = -e * v;
    z = 0.0;
    if (++bounces == 10) return static_cast<double>(i) * h;
  }
  return kUnset;
}

void zeno(const Given& given, Findings& findings) {
  constexpr double v_rest = 5e-4;
  const double t1 = std::sqrt(2 / kG);
  report::Plot plot{
      "Bounces of a ball, dropped from 1 m",
      {"time", "s"},
      {"height", "m", report::Scale::kLog},
      {},
      {},
      "Infinitely many bounces in finite time: what is below the cut-off speed is rest."};
  for (const double e : {0.8, 0.5}) {
    for (const bool lasting : {false, true}) {
      if (lasting && !given.laws.contact_forces) continue;
      // the engine's cut-off is of the speed after an impact
      scene::Scene scene = dropped(e, e * v_rest);
      if (lasting) scene.contact.emplace();
      const double t_inf = t1 * (1 + e) / (1 - e);
      const Trajectory run = run_by_steps(scene, given.laws, t_inf + 1.0, 1.0 / 60, 2000);
      double rest = kUnset;
      std::size_t impacts = 0;
      for (const Event& event : run.events) {
        impacts += event.kind == EventKind::kCollision ? 1 : 0;
        if (std::isnan(rest) &&
            (event.kind == EventKind::kRest || event.kind == EventKind::kContact))
          rest = event.time;
      }
      const std::string name = fmt::format("e = {:g}{}", e, lasting ? ", persistent contact" : "");
      findings.at_most(name + ": time of rest against t_inf", std::abs(rest - t_inf),
                       2 * v_rest * e / (kG * (1 - e)), "s",
                       "what the bounces below the cut-off speed would still have taken, twice");
      findings.at_most(name + ": impacts", static_cast<double>(impacts),
                       std::ceil(std::log(v_rest / (kG * t1)) / std::log(e)) + 3, "",
                       "each takes off a factor e of the speed, down to the cut-off");
      findings.at_most(name + ": height after rest",
                       std::abs(run.frames.back().poses[0].com_world.z() - 0.1), 1e-9, "m",
                       "rests on the floor, no deeper and no higher");
      if (!lasting)
        plot.curves.push_back(curve_of(name, run, [](const Frame& frame) {
          return std::max(frame.poses[0].com_world.z() - 0.1, 1e-9);
        }));
    }
    double tenth = t1;
    for (int i = 1; i < 10; ++i) tenth += 2 * t1 * std::pow(e, i);
    if (e > 0.6)
      findings.must_fail("bounces taken at the ends of steps of 1/60 s: time of the tenth",
                         std::abs(tenth_bounce_at_steps(e, 1.0 / 60) - tenth), 1e-9, "s",
                         "each is late by up to a step");
  }
  findings.plot(std::move(plot));
  for (const char* id : {"bouncing_ball/e0.5", "bouncing_ball/e0.8", "bouncing_ball/e1"})
    compare_with_truth(given, findings, id);
}

// ---- Row 19 -------------------------------------------------------------------------------------

scene::Scene row_of_balls(bool simultaneous) {
  scene::Scene scene = truths::empty_scene("cradle", 1.0, 1e-9);
  for (int i = 0; i < 5; ++i)
    scene.bodies.push_back(truths::ball("ball" + std::to_string(i), 1.0, 0.5,
                                        Vector3d(i == 0 ? -0.25 : i, 0, 0),
                                        Vector3d(i == 0 ? 1 : 0, 0, 0), 1.0));
  if (simultaneous) {
    scene.contact.emplace();
    scene.contact->impact_law = scene::ImpactLaw::kSimultaneous;
  }
  return scene;
}

scene::Scene break_shot() {
  scene::Scene scene = truths::empty_scene("break shot", 1.0, 1e-9);
  constexpr double r = 0.5;
  scene.bodies.push_back(
      truths::ball("cue", 1.0, r, Vector3d(-2, 0.05, 0), Vector3d(5, 0, 0), 1.0));
  for (int row = 0; row < 5; ++row)
    for (int i = 0; i <= row; ++i)  // a hair apart, so that nothing overlaps by rounding
      scene.bodies.push_back(truths::ball(fmt::format("ball{}{}", row, i), 1.0, r * (1 - 1e-12),
                                          Vector3d(row * r * std::sqrt(3.0), (2 * i - row) * r, 0),
                                          Vector3d::Zero(), 1.0));
  return scene;
}

void simultaneous_impacts(const Given& given, Findings& findings) {
  for (const char* id : {"newtons_cradle/5balls_1moving_e1", "newtons_cradle/5balls_2moving_e1",
                         "newtons_cradle/5balls_3moving_e1", "newtons_cradle/5balls_1moving_e0.9"})
    compare_with_truth(given, findings, id);
  const double cue_energy = 0.5 * 25;
  const Trajectory shot = run_by_steps(break_shot(), given.laws, 1.0, 1.0 / 60, 60);
  findings.at_most("break shot of 15: momentum",
                   (shot.frames.back().momentum_world - Vector3d(5, 0, 0)).norm() / 5,
                   1e-14 * std::sqrt(100.0), "", "1e-14 an impact, some hundred of them");
  findings.at_most("break shot of 15: energy over the start's - 1",
                   shot.frames.back().kinetic_energy / cue_energy - 1, 1e-13, "",
                   "impulses with restitution 1 keep it, and never add");
  if (!given.laws.contact_forces)
    return findings.not_run("simultaneous law", "needs the laws of a3, which nobody provides here");
  const Trajectory one = run_by_steps(row_of_balls(true), given.laws, 0.6, 1.0 / 60, 36),
                   pairs = run_by_steps(row_of_balls(false), given.laws, 0.6, 1.0 / 60, 36);
  report::Curve by_pairs{"one after the other", {}, {}, true},
      together{"all at once (LCP)", {}, {}, true};
  double error = 0.0;
  for (std::size_t i = 0; i < 5; ++i) {
    const double v = one.frames.back().poses[i].velocity_world.x();
    error = std::max(error, std::abs(v - (i == 0 ? -0.6 : 0.4)));
    by_pairs.x.push_back(static_cast<double>(i + 1)),
        by_pairs.y.push_back(pairs.frames.back().poses[i].velocity_world.x());
    together.x.push_back(static_cast<double>(i + 1)), together.y.push_back(v);
  }
  findings.at_most("simultaneous law, 1 into 4: against (-0.6, 0.4, 0.4, 0.4, 0.4)", error, 1e-10,
                   "m/s",
                   "closed form of Newton's law with all impacts at once; the solver's tolerance");
  findings.at_most("simultaneous law, 1 into 4: momentum",
                   (one.frames.back().momentum_world - Vector3d(1, 0, 0)).norm(), 1e-14, "",
                   "1e-14 of the 1 N s there was: the same impulse is added to one ball and taken "
                   "from the other");
  findings.at_most("simultaneous law, 1 into 4: energy over the start's - 1",
                   one.frames.back().kinetic_energy / 0.5 - 1, 1e-13, "",
                   "restitution 1 at every contact keeps it, here by solving 4 equations to "
                   "rounding, and never adds");
  findings.must_fail("simultaneous law as a cradle: speed of the last ball against 1",
                     std::abs(one.frames.back().poses[4].velocity_world.x() - 1), 1e-12, "m/s",
                     "it breaks the cradle: a scene says which law it wants");
  findings.plot({"One ball into four at 1 m/s: speeds afterwards",
                 {"ball"},
                 {"speed", "m/s"},
                 {by_pairs, together},
                 {},
                 "Both keep momentum and energy. Newton's cradle is the first."});
}

// ---- Row 32 -------------------------------------------------------------------------------------

constexpr double kFoldsBeyond = 1e-3;  // floors from which on only invariants are compared

scene::Scene spheres(const truths::Case& truth, double disturbance) {
  scene::Scene scene = truths::empty_scene("spheres", 70.0, 1e-9);
  const VectorXd masses = truth.input("masses").vector();
  for (Eigen::Index i = 0; i < masses.size(); ++i) {
    const auto at = static_cast<std::size_t>(i);
    scene.bodies.push_back(
        truths::ball("ball" + std::to_string(i), masses[i], truth.input("radii").at(at).number(),
                     truth.input("x0").at(at).vector3(),
                     truth.input("v0").at(at).vector3() * (1 + disturbance), 1.0));
  }
  const Vector3d size = truth.input("box").vector3();
  for (int axis = 0; axis < 3; ++axis) {
    scene.bodies.push_back(truths::wall("low", Vector3d::Zero(), Vector3d::Unit(axis), 1.0));
    scene.bodies.push_back(
        truths::wall("high", size[axis] * Vector3d::Unit(axis), -Vector3d::Unit(axis), 1.0));
  }
  return scene;
}

void chaos_of(const Given& given, Findings& findings, const std::string& id) {
  const truths::Case truth = given.truth(id);
  const auto& rows = truth.output("collisions").list();
  const int balls = static_cast<int>(truth.input("masses").list().size());
  report::Plot plot{
      "Hard spheres: error of the time of each collision (" + id.substr(id.find('/') + 1) + ")",
      {"collision of two spheres"},
      {"error", "s", report::Scale::kLog},
      {},
      {},
      "Errors grow by a factor of 3 to 5 at every collision, whoever computes. A part in 10^9 more "
      "speed is another future after fifteen."};
  report::Curve floor{"100 floors of double precision", {}, {}};
  const auto within_reach = std::count_if(rows.begin(), rows.end(), [](const truths::Value& row) {
    return row.at("tolerance_floor").number() <= kFoldsBeyond;
  });
  double worst = 0.0, disturbed = 0.0;
  for (const double disturbance : {0.0, 1e-9}) {
    const Trajectory run = truths::run_in_memory(spheres(truth, disturbance), given.laws, 1.0);
    report::Curve curve{
        disturbance == 0.0 ? "this project" : "all speeds 1e-9 higher", {}, {}, true};
    std::size_t row = 0;
    for (const Event& event : run.events) {
      if (event.kind != EventKind::kCollision || event.body_b >= balls || row >= rows.size())
        continue;
      const truths::Value& expected = rows[row];
      const double limit = 100 * expected.at("tolerance_floor").number();
      if (limit > 100 * kFoldsBeyond) break;
      const bool same = event.body_a == expected.at("pair").at(0).integer() &&
                        event.body_b == expected.at("pair").at(1).integer();
      const double error = same ? std::abs(event.time - expected.at("t").number()) : 1.0;
      double& largest = disturbance == 0.0 ? worst : disturbed;
      largest = std::max(largest, error / limit);
      ++row;
      curve.x.push_back(static_cast<double>(row)), curve.y.push_back(std::max(error, 1e-17));
      if (disturbance == 0.0) floor.x.push_back(static_cast<double>(row)), floor.y.push_back(limit);
    }
    if (disturbance == 0.0) {
      findings.is_true(
          fmt::format("{}: the first {} collisions of two spheres are all there", id, within_reach),
          static_cast<long>(row) == within_reach,
          "all of the 30 whose floor in double precision is below 1e-3");
      double energy = 0.0;
      for (const Frame& frame : run.frames)
        energy = std::max(energy,
                          std::abs(frame.kinetic_energy / run.frames.front().kinetic_energy - 1));
      findings.at_most(id + ": energy over 70 s", energy, 1e-12, "",
                       "the only thing, with the box, that can be asked after the horizon");
      findings.at_least(id + ": smallest gap", smallest_gap(run), 0.0, "m",
                        "nothing interpenetrates, ever");
    }
    plot.curves.push_back(std::move(curve));
  }
  findings.at_most(id + ": times of the collisions, over 100 floors", worst, 1.0, "",
                   "floor k: what rounding the inputs alone does to collision k");
  findings.must_fail(id + ": the same with all speeds 1e-9 higher", disturbed, 1.0, "",
                     "another world: it must be told from this one");
  plot.curves.push_back(std::move(floor));
  findings.plot(std::move(plot));
}

void chaos(const Given& given, Findings& findings) {
  for (const char* id : {"hard_spheres/three_a", "hard_spheres/three_equal"})
    findings.part(id, [&] { chaos_of(given, findings, id); });
}

}  // namespace

void add_impacts(std::vector<Case>& cases) {
  cases.push_back(
      {15, "Zeno",
       "A bouncing ball makes infinitely many bounces in four seconds. Who locates each of them "
       "never gets past that instant; who looks only at the ends of steps gains or loses energy. "
       "Below a cut-off speed a bounce is rest.",
       "a1", zeno});
  cases.push_back(
      {19, "simultaneous impacts",
       "Newton's cradle: impacts at one instant have no single right answer. One after the other "
       "the cradle works; all at once (a linear complementarity problem) "
       "the balls move off together. The scene says which law it uses; both keep the invariants.",
       "a1", simultaneous_impacts});
  cases.push_back({32, "chaos",
                   "Three hard spheres in a box. Each collision multiplies an error by about four, "
                   "so that after thirty even exact arithmetic on rounded inputs says nothing. "
                   "Up to there the order and times of collisions must be right; after that energy "
                   "and the box.",
                   "a1", chaos});
}

}  // namespace tumble::battery
