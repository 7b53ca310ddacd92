// Rows 14, 28, 29 and 31: Painleve's rod, the friction angle, cones instead of pyramids,
// turntables.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "framework/effects/joint/joint.h"
#include "framework/effects/point_force/point_force.h"
#include "tests/stability/cases.h"
#include "tests/stability/support.h"

namespace tumble::battery {
namespace {

// ---- Row 14 -------------------------------------------------------------------------------------

constexpr double kRodHalf = 1.0, kRodThin = 1e-3;  // m: half length, half thickness

/// A rod, inclined at tan(theta) = 2, its lower end sliding against the side it leans to.
scene::Scene sliding_rod(double mu) {
  const double theta = std::atan(2.0);
  // x of the rod up and to the right
  const Quaterniond q(Eigen::AngleAxisd(-theta, Vector3d::UnitY()));
  const Vector3d lowest = q * Vector3d(-kRodHalf, 0, -kRodThin);
  scene::BodySpec rod =
      rough(box("rod", Vector3d(kRodHalf, 0.1, kRodThin), 1.0, Vector3d(0, 0, -lowest.z())), mu);
  rod.world_from_body = q;
  rod.velocity_m_s = Vector3d(-3.0, 0, 0);
  return with_contact("painleve", {rod, floor_of(mu)});
}

/// a_n = A N - g of the sliding end: A = 1/m + l_x (l_x - mu l_z) / I, (l_x, l_z) from the end to
/// the centre.
double compliance(double mu) {
  const Vector3d l = Quaterniond(Eigen::AngleAxisd(-std::atan(2.0), Vector3d::UnitY())) *
                     Vector3d(kRodHalf, 0, kRodThin);
  const double inertia = (kRodHalf * kRodHalf + kRodThin * kRodThin) / 3;
  return 1.0 + l.x() * (l.x() - mu * l.z()) / inertia;
}

void painleve(const Given& given, Findings& findings) {
  report::Plot plot{
      "Painleve's rod: normal force that sliding needs, per weight",
      {"friction coefficient"},
      {"N / (m g)"},
      {},
      {{0.0, "below: it would pull"}},
      "Near 4/3 the force grows without bound; beyond there is none, and only an impulse helps."};
  report::Curve needed{"1 / A", {}, {}}, found{"in the engine's first step", {}, {}, true};
  for (double mu = 0.0; mu <= 1.30; mu += 0.02)
    needed.x.push_back(mu), needed.y.push_back(1 / compliance(mu));
  for (const double mu : {0.0, 0.5, 1.0, 1.2, 1.3}) {
    const Trajectory run = truths::run_in_steps(sliding_rod(mu), given.laws, 1e-6, 1, 1);
    const double force = push_up(run.frames.back(), 0, 1), expected = kG / compliance(mu);
    found.x.push_back(mu), found.y.push_back(force / kG);
    if (mu == 1.3)
      findings.at_most("mu = 1.3: normal force against m g / A", std::abs(force / expected - 1),
                       1e-2, "",
                       "below 4/3 acceleration-level forces exist and are used; it turns by 1e-3 "
                       "rad/s in the first microsecond, which A = 0.04 sees 25 times");
  }
  findings.must_fail(
      "forces alone, mu = 1.4: pull that sliding would need", -kG / compliance(1.4), 0.0, "N",
      "A < 0: no force keeps it from sinking in; acceleration-level methods have no answer");
  // Forces change velocities by what a step is long, an impulse by what it must, however short the
  // step.
  for (const double mu : {1.3, 1.4}) {
    const auto jump = [&](double h) {
      const Trajectory run = truths::run_in_steps(sliding_rod(mu), given.laws, h, 1, 1);
      return std::abs(run.frames.back().poses[0].velocity_world.x() -
                      run.frames.front().poses[0].velocity_world.x());
    };
    const std::string name = fmt::format("mu = {:g}: speed lost in a step of 1e-8 s", mu);
    if (mu < 4.0 / 3)
      findings.at_most(name, jump(1e-8), 2e-8 * mu * kG / compliance(mu), "m/s",
                       "mu N h / m, twice: forces do");
    else
      findings.at_least(name, jump(1e-8), 0.1, "m/s",
                        "of the 3 m/s it slides with: no force is large enough, and an impulse "
                        "without a collision stops the end's sliding");
    if (mu > 4.0 / 3)
      findings.at_most(name + " over that of 1e-6 s, - 1", std::abs(jump(1e-8) / jump(1e-6) - 1),
                       1e-3, "", "it does not go with the step: an impulse");
  }
  for (const double mu : {1.3, 1.4, 2.0}) {
    const std::string name = fmt::format("mu = {:g}, 1 s", mu);
    findings.part(name, [&] {
      const Trajectory run = run_by_steps(sliding_rod(mu), given.laws, 1.0, 1.0 / 240, 240);
      double gain = 0.0;
      for (const Frame& frame : run.frames)
        gain = std::max(gain, energy_of(frame) / energy_of(run.frames.front()) - 1);
      findings.at_most(
          name + ": energy over the start's - 1", gain, 1e-9, "",
          "an impulse without a collision takes from the momentum that is there, and adds none");
      const double rise = energy_rise(run),
                   finer =
                       energy_rise(run_by_steps(sliding_rod(mu), given.laws, 1.0, 1.0 / 960, 240));
      findings.at_most(name + ": rise of the energy above an earlier value", rise, 7e-5, "",
                       "contact and friction only take; a step's error is of second order, (w h)^2 "
                       "= 7e-5 at 2 rad/s and 1/240 s");
      findings.at_least(name + ": that rise over the one at a quarter of the step",
                        rise / std::max(finer, 1e-9), 8.0, "", "16 for second order, 4 for first");
      findings.at_least(name + ": smallest gap", smallest_gap(run), 0.0, "m", "nothing sinks in");
      findings.at_most(name + ": steps", static_cast<double>(run.counters.counts.at("steps")),
                       1000.0, "", "240 and those of events: no loop without end");
    });
  }
  plot.curves = {needed, found};
  findings.plot(std::move(plot));
}

// ---- Row 28 -------------------------------------------------------------------------------------

scene::Scene block_on_incline(double angle, double mu) {
  const Vector3d normal(std::sin(angle), 0, std::cos(angle));
  return with_contact("incline",
                      {turned(rough(box("block", Vector3d(0.1, 0.1, 0.05), 1.0, 0.05 * normal), mu),
                              angle, Vector3d::UnitY()),
                       turned(floor_of(mu), angle, Vector3d::UnitY())});
}

/// Way in ten seconds of a block that is held by mu N tanh(v / v_eps) instead of by Coulomb's law.
double creep_of_smoothed_friction(double angle, double mu, double v_eps) {
  constexpr double h = 1e-5;
  double x = 0.0, v = 0.0;
  for (int i = 0; i < 1000000; ++i) {
    v += h * kG * (std::sin(angle) - mu * std::cos(angle) * std::tanh(v / v_eps));
    x += h * v;
  }
  return x;
}

void friction_threshold(const Given& given, Findings& findings) {
  const double angle = std::atan(0.5), duration = given.is_long ? 10.0 : 3.0;
  report::Plot plot{"Block on an incline of tan(a) = 0.5",
                    {"time", "s"},
                    {"way", "m", report::Scale::kLog},
                    {},
                    {{1e-6, "threshold of creep"}},
                    "One part in fifty of friction decides between sliding and not moving at all."};
  for (const double mu : {0.49, 0.5, 0.51}) {
    const Trajectory run =
        run_by_steps(block_on_incline(angle, mu), given.laws, duration, 1.0 / 60, 200);
    const double way = drift_of(run, 0), t = run.frames.back().time;
    const std::string name = fmt::format("mu = {:g}, {:g} s", mu, duration);
    if (mu < 0.5)
      findings.at_most(name + ": way against g (sin a - mu cos a) t^2 / 2",
                       std::abs(way - 0.5 * kG * (std::sin(angle) - mu * std::cos(angle)) * t * t),
                       1e-6, "m", "constant forces are followed exactly");
    else
      findings.at_most(name + ": creep", way, 1e-6, "m",
                       "a hard contact that sticks does not creep");
    plot.curves.push_back(curve_of(fmt::format("mu = {:g}", mu), run, [&](const Frame& f) {
      return std::max(1e-15, (f.poses[0].com_world - run.frames.front().poses[0].com_world).norm());
    }));
  }
  findings.must_fail("friction smoothed over 1 mm/s, mu = 0.51, 10 s: creep",
                     creep_of_smoothed_friction(angle, 0.51, 1e-3), 1e-6, "m",
                     "a smoothed law holds only what moves");
  findings.plot(std::move(plot));
  for (const char* id : {"friction_incline/flat_mu0.3", "friction_incline/v3_20deg_mu0.5",
                         "friction_incline/marginal_30deg_mu0.5774"})
    compare_with_truth(given, findings, id);
}

// ---- Row 29 -------------------------------------------------------------------------------------

scene::Scene pushed_box(double direction, double force, double mu) {
  scene::Scene scene = with_contact(
      "pushed",
      {rough(box("box", Vector3d(0.5, 0.5, 0.1), 10.0, Vector3d(0, 0, 0.1)), mu), floor_of(mu)});
  scene.effects.of<effects::PointForceSpec>() = {
      {"box", force * Vector3d(std::cos(direction), std::sin(direction), 0), Vector3d(0, 0, 0.1),
       0.0, 100.0}};
  return scene;
}

/// SimBenchmark's rolling: friction 0.8 of floor and balls, 0.4 of balls and box (a pair has the
/// smaller of its bodies' two). A box of 10 kg on balls of 1 kg, pushed along the diagonal where
/// friction on the balls leaves no moment about its centre. Three balls carry a third of it each;
/// how 25 share it statics does not say, and with it which of them roll.
scene::Scene box_on_balls(int count, double mu_box, double force, double depth) {
  std::vector<scene::BodySpec> bodies{
      rough(box("box", Vector3d(1.0, 1.0, 0.1), 10.0, Vector3d(0, 0, 0.3)), mu_box)};
  for (int i = 0; i < count; ++i) {
    const double third = 2 * std::numbers::pi * i / 3 + 0.3;
    const Vector3d place = count == 3 ? Vector3d(0.5 * std::cos(third), 0.5 * std::sin(third), 0.1)
                                      : Vector3d(0.4 * (i % 5 - 2), 0.4 * (i / 5 - 2), 0.1);
    bodies.push_back(rough(
        truths::ball("ball" + std::to_string(i), 1.0, 0.1, place, Vector3d::Zero(), 0.0), 1.0));
  }
  bodies.push_back(floor_of(0.8));
  scene::Scene scene = with_contact("box on balls", std::move(bodies));
  scene.effects.of<effects::PointForceSpec>() = {
      {"box", force * Vector3d(std::sqrt(0.5), std::sqrt(0.5), 0), Vector3d(0, 0, 0.3 - depth), 0.0,
       100.0}};
  return scene;
}

void box_rolls(const Given& given, Findings& findings, int count, bool rolls) {
  // On three: rolling takes friction 0.7 m a_c on a ball's top, a_box = 2 a_c, 150 = 20 a_c + 3 *
  // 0.7 a_c; slipping takes mu times the weight.
  constexpr double push = 150.0;
  const double mu = rolls ? 0.4 : 0.1,
               friction = count == 3 ? (rolls ? 2.1 * push / 22.1 : mu * 10 * kG) : 0.0,
               expected = (push - friction) / 10;
  const std::string name = fmt::format("box on {} balls, mu = {:g}: ", count, mu);
  const Trajectory run =
      run_by_steps(box_on_balls(count, mu, push, 0.1 * friction / push), given.laws, 0.1, 1e-3, 20);
  const Vector3d v = run.frames.back().poses[0].velocity_world;
  findings.at_most(name + "direction of the motion",
                   std::abs(std::atan2(v.y(), v.x()) - std::numbers::pi / 4), 1e-6, "rad",
                   "nothing prefers one side");
  if (count == 3)
    findings.at_most(name + fmt::format("speed after 0.1 s against {:.4g} m/s",
                                        expected * run.frames.back().time),
                     std::abs(v.norm() / (expected * run.frames.back().time) - 1), 1e-3, "",
                     rolls ? "closed form of rolling without slipping; of order h"
                           : "closed form of slipping; of order h");
}

void friction_cone(const Given& given, Findings& findings) {
  constexpr double mu = 0.8, duration = 0.5;
  report::Plot plot{"Box of 10 kg pushed with 100 N, mu = 0.8",
                    {"direction of the push", "deg"},
                    {"acceleration", "m/s^2"},
                    {},
                    {},
                    "A cone is round. A pyramid of four sides holds up to 111 N along the "
                    "diagonal, and does not let the box go."};
  report::Curve found{"this project", {}, {}, true}, pyramid{"pyramid of four sides", {}, {}};
  double direction_error = 0.0, way_error = 0.0;
  for (int degrees = 0; degrees <= 90; degrees += 15) {
    const double direction = degrees * std::numbers::pi / 180;
    const Trajectory run =
        run_by_steps(pushed_box(direction, 100.0, mu), given.laws, duration, 1e-3, 10);
    const Vector3d way =
        run.frames.back().poses[0].com_world - run.frames.front().poses[0].com_world;
    const double t = run.frames.back().time, expected = 0.5 * (100.0 / 10 - mu * kG) * t * t;
    direction_error = std::max(direction_error, std::abs(std::atan2(way.y(), way.x()) - direction));
    way_error = std::max(way_error, std::abs(way.norm() - expected));
    found.x.push_back(degrees), found.y.push_back(2 * way.norm() / (t * t));
    const double along = std::max(0.0, 10.0 * std::cos(direction) - mu * kG),
                 across = std::max(0.0, 10.0 * std::sin(direction) - mu * kG);
    pyramid.x.push_back(degrees), pyramid.y.push_back(std::hypot(along, across));
    if (degrees == 45)
      findings.must_fail("pyramid of four sides, along the diagonal: error of the acceleration",
                         std::abs(std::hypot(along, across) - (10.0 - mu * kG)), 1e-3, "m/s^2",
                         "it holds sqrt(2) times too much there: the box does not move");
  }
  plot.curves = {found, pyramid};
  findings.plot(std::move(plot));
  findings.at_most("box pushed in 7 directions: error of the direction", direction_error, 1e-6,
                   "rad", "Coulomb's cone is round");
  findings.at_most("box pushed in 7 directions: error of the way", way_error, 1e-6, "m",
                   "constant forces");
  const Trajectory held = run_by_steps(pushed_box(std::numbers::pi / 4, 0.99 * mu * 10 * kG, mu),
                                       given.laws, duration, 1e-3, 10);
  findings.at_most("pushed with 0.99 of mu m g along the diagonal: creep", drift_of(held, 0), 1e-6,
                   "m", "inside the cone nothing moves");
  for (const bool rolls : {true, false})
    findings.part(rolls ? "box that rolls" : "box that slips",
                  [&] { box_rolls(given, findings, 3, rolls); });
  findings.part("box on 25 balls", [&] { box_rolls(given, findings, 25, true); });
}

// ---- Row 31 -------------------------------------------------------------------------------------

/// A block on a table that turns at 2 rad/s: it slips from r = mu g / w^2 on.
scene::Scene turntable(double part, double mu) {
  constexpr double omega = 2.0;
  const double r = part * mu * kG / (omega * omega);
  scene::BodySpec table =
      rough(box("table", Vector3d(3.0, 3.0, 0.1), 1e7, Vector3d(0, 0, -0.1)), mu);
  table.omega_world_rad_s = Vector3d(0, 0, omega);
  scene::BodySpec block =
      rough(box("block", Vector3d(0.05, 0.05, 0.01), 1.0, Vector3d(r, 0, 0.01)), mu);
  block.velocity_m_s = Vector3d(0, omega * r, 0);
  block.omega_world_rad_s = Vector3d(0, 0, omega);
  scene::Scene scene = with_contact("turntable", {block, table});
  scene.stabilisation = scene::StabilisationSpec{};
  scene.effects.of<effects::JointSpec>() = {
      {"axle", effects::JointKind::kHinge, "table", "", Vector3d(0, 0, -0.1), Vector3d::UnitZ()}};
  return scene;
}

void turntables(const Given& given, Findings& findings) {
  report::Plot plot{"Block on a turntable: how far it has come off its circle",
                    {"time", "s"},
                    {"radius - radius at the start", "m", report::Scale::kLog},
                    {},
                    {},
                    "The radius at which it slips is mu g / w^2."};
  for (const double mu : {0.1, 0.5, 1.0}) {
    for (const double part : {0.99, 1.01}) {
      const std::string name =
          fmt::format("turntable, mu = {:g}, radius {:g} of mu g / w^2", mu, part);
      findings.part(name, [&] {
        const Trajectory run =
            run_by_steps(turntable(part, mu), given.laws, given.is_long ? 4.0 : 2.0, 1e-3, 200);
        const double r0 = run.frames.front().poses[0].com_world.head<2>().norm();
        const auto off = [&](const Frame& frame) {
          return std::abs(frame.poses[0].com_world.head<2>().norm() - r0);
        };
        double way = 0.0;
        for (const Frame& frame : run.frames) way = std::max(way, off(frame));
        if (part < 1)
          findings.at_most(name + ": off its circle", way, 1e-3 * r0, "m",
                           "1 % inside the limit it is carried along");
        else
          findings.must_fail(name + ": stays on its circle", way, 1e-2 * r0, "m",
                             "1 % outside it goes");
        if (mu == 0.5)
          plot.curves.push_back(curve_of(fmt::format("{:g} of the radius", part), run,
                                         [&](const Frame& f) { return std::max(1e-14, off(f)); }));
      });
    }
  }
  findings.part("frictionless turntable", [&] {
    scene::Scene scene = turntable(1.0, 0.1);
    for (scene::BodySpec& body : scene.bodies) body.friction = 0.0;
    const Trajectory run = run_by_steps(scene, given.laws, 1.0, 1e-3, 100);
    const BodyPose &start = run.frames.front().poses[0], &end = run.frames.back().poses[0];
    findings.at_most(
        "turntable, mu = 0: off a straight line",
        (end.com_world - start.com_world - start.velocity_world * run.frames.back().time).norm(),
        1e-9, "m", "nothing pushes it sideways");
  });
  findings.plot(std::move(plot));
  findings.part("coin", [&] {
    scene::BodySpec coin =
        rough(box("coin", Vector3d(0.1, 0.1, 0.005), 0.5, Vector3d(0, 0, 0.11)), 0.3);
    coin.world_from_body = Quaterniond(Eigen::AngleAxisd(1.2, Vector3d(1, 0.05, 0).normalized()));
    coin.omega_world_rad_s = Vector3d(0, 0, 15.0);
    const Trajectory run = run_by_steps(with_contact("coin", {coin, floor_of(0.3)}), given.laws,
                                        given.is_long ? 3.0 : 1.5, 1.0 / 1000, 300);
    findings.at_most("square coin, spun and falling over: rise of the energy", energy_rise(run),
                     1e-9, "", "contact and friction only take");
    findings.at_least("square coin: smallest gap", smallest_gap(run), 0.0, "m",
                      "nothing interpenetrates");
    findings.plot({"Energy of a coin that is spun and falls over",
                   {"time", "s"},
                   {"energy", "J"},
                   {curve_of("energy", run, energy_of),
                    curve_of("kinetic", run, [](const Frame& f) { return f.kinetic_energy; })},
                   {},
                   "It must never rise."});
  });
  rattleback(given, findings);
}

}  // namespace

void add_friction(std::vector<Case>& cases) {
  cases.push_back(
      {14, "Painleve's paradox",
       "A rod that slides on one end. From a friction of 4/3 on there is no finite force that "
       "keeps the end from sinking in: pushing harder makes it sink more. "
       "Only an impulse without any collision helps; it may use only the momentum there is.",
       "a1 a3", painleve});
  cases.push_back({28, "friction threshold",
                   "A block on an incline slips below the friction that equals its slope and "
                   "sticks from there on. Smoothed friction creeps, whatever the coefficient.",
                   "a1 a3", friction_threshold});
  cases.push_back(
      {29, "friction cone",
       "A box pushed sideways in any direction must move in that direction. Friction linearised to "
       "a pyramid holds more along the diagonal: some engines do not move it at all. "
       "On balls it rolls or slips, as the coefficient says.",
       "a1 a3", friction_cone});
  cases.push_back({31, "turntable, coin, rattleback",
                   "A block is carried along by a turning table up to the radius mu g / w^2 and "
                   "slips beyond. A coin spun on its edge falls over and must not gain energy on "
                   "its many contacts. A rattleback "
                   "spun against its sense turns back, with nothing but a table under it.",
                   "a1 a3", turntables});
}

}  // namespace tumble::battery
