// Runs that cannot be trusted say so: links that come apart, energy from nothing, bodies that turn
// too far; and right runs are left in peace.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "framework/effects/build_world.h"
#include "framework/effects/joint/joint.h"
#include "framework/effects/motor/motor.h"
#include "framework/effects/point_force/point_force.h"
#include "framework/effects/rod/rod.h"
#include "framework/effects/spring/spring.h"
#include "framework/engines/base/run_watch.h"
#include "framework/engines/stepping/stability.h"
#include "tests/engines/reference_laws.h"
#include "tests/engines/scenes.h"
#include "tests/engines/watched_runs.h"

namespace tumble::testing {
namespace {

/// By how much of 1 m the rods of a scene are off at worst, in frames.
double worst_rod(const scene::Scene& scene, const Trajectory& run) {
  double worst = 0.0;
  for (const Frame& frame : run.frames)
    for (const effects::RodSpec& rod : scene.effects.of<effects::RodSpec>()) {
      const auto at = [&](const scene::AnchorSpec& end) -> Vector3d {
        for (std::size_t i = 0; i < run.bodies.size(); ++i)
          if (run.bodies[i].name == end.body)
            return frame.poses[i].com_world + frame.poses[i].world_from_body * end.point_m;
        return end.point_m;
      };
      worst =
          std::max(worst, std::abs((at(rod.a) - at(rod.b)).norm() - rod.length_m) / rod.length_m);
    }
  return worst;
}

/// A light bob on a rod above one `ratio` times as heavy, held out sideways. Rods of 1 m. The seed
/// draws the angles.
scene::Scene light_above_heavy(double ratio, unsigned seed) {
  const double upper = 0.6 + 0.05 * (seed % 9), lower = 1.1 + 0.04 * (seed % 7);
  const Vector3d first(std::sin(upper), 0, -std::cos(upper)),
      second = first + Vector3d(std::sin(lower), 0, -std::cos(lower));
  scene::Scene scene = scene_of({ball("light", 0.0, 1.0, first, Vector3d::Zero()),
                                 ball("heavy", 0.0, ratio, second, Vector3d::Zero())},
                                1.0, kEarthGravity);
  for (scene::BodySpec& body : scene.bodies) body.collides = false;
  scene.step_s = 1.0 / 60;
  scene.stabilisation.emplace();
  scene.effects.of<effects::RodSpec>().push_back(
      {"upper", {"light", Vector3d::Zero()}, {"", Vector3d::Zero()}, 1.0});
  scene.effects.of<effects::RodSpec>().push_back(
      {"lower", {"light", Vector3d::Zero()}, {"heavy", Vector3d::Zero()}, 1.0});
  return scene;
}

// A rod that is 1 % off is no rod. At the default step such runs go wrong; they say so, and name a
// step at which they do not.
TEST(RunWatch, RodsThatComeApartAreNeverKeptSilent) {
  for (const double ratio : {1e3, 1e5, 1e6})
    for (const unsigned seed : {1u, 5u}) {
      const scene::Scene scene = light_above_heavy(ratio, seed);
      for (const std::string& engine : {std::string("rd"), std::string("ca")}) {
        const Trajectory run = run_by(engine, scene);
        if (worst_rod(scene, run) > 1e-2) {
          EXPECT_TRUE(!run.stopped_by.empty() || has_fault(run, "link_open"))
              << engine << ' ' << ratio << ' ' << seed << said(run);
        }
      }
    }
}

// Explicit Euler puts energy into every swing: a pendulum of 1 m at 0.01 s gains a tenth within
// seconds.
TEST(RunWatch, EnergyThatAMethodMakesIsAFault) {
  scene::Scene scene =
      scene_of({ball("bob", 0.0, 1.0, {1, 0, 0}, Vector3d::Zero())}, 2.0, kEarthGravity);
  scene.bodies[0].collides = false;
  scene.step_s = 0.01;
  scene.stabilisation.emplace();
  scene.effects.of<effects::RodSpec>().push_back(
      {"wire", {"", Vector3d::Zero()}, {"bob", Vector3d::Zero()}, 1.0});
  Laws laws = reference_laws();
  laws.integrator_source = "explicit Euler";
  laws.integrate_step = [](const OdeFunction& f, double t, const VectorXd& y,
                           double h) -> VectorXd { return y + h * f(t, y); };
  for (const std::string& engine : kEngines)
    EXPECT_TRUE(has_fault(run_by(engine, scene, laws), "energy_rises")) << engine;
  for (const std::string& engine : kEngines) EXPECT_EQ(said(run_by(engine, scene)), "") << engine;
}

// A ball on a spring, pushed by a constant force: what the force brings in is no fault, what the
// method makes beside it is, by any engine, also where the force acts for a while between two
// frames of the event engines. The first step counts.
TEST(RunWatch, WhatAForceBringsInIsNoFault) {
  scene::Scene scene =
      scene_of({ball("ball", 0.1, 1.0, {1, 0, 0}, Vector3d::Zero())}, 1.0, Vector3d::Zero());
  effects::SpringSpec spring;
  spring.a.body = "ball";
  spring.b.point_m = Vector3d(-1, 0, 0);
  spring.stiffness_n_m = 100.0;
  spring.rest_length_m = 1.5;
  scene.effects.of<effects::SpringSpec>().push_back(spring);
  scene.step_s = 0.01;
  Laws laws = reference_laws();
  laws.integrate_step = [](const OdeFunction& f, double t, const VectorXd& y,
                           double h) -> VectorXd { return y + h * f(t, y); };
  std::vector<effects::PointForceSpec>& forces = scene.effects.of<effects::PointForceSpec>();
  for (const auto& [start, lasts] : {std::pair(0.0, 0.5), std::pair(0.123, 0.002)}) {
    forces = {{"ball", {-50, 0, 0}, {1, 0, 0}, start, lasts}};
    for (const std::string& engine : kEngines) {
      EXPECT_FALSE(has_fault(run_by(engine, scene), "energy_rises")) << engine << start;
      // (w h)^2 / 2 = 0.5 % of the swing a step
      EXPECT_TRUE(has_fault(run_by(engine, scene, laws), "energy_rises")) << engine << start;
    }
  }
  laws.integrate_step = [](const OdeFunction& f, double t, const VectorXd& y,
                           double h) -> VectorXd {
    const Laws right = reference_laws();
    const VectorXd next = right.integrate_step(f, t, y, h);
    return t == 0.0 ? VectorXd(next + 2.0 * (next - y)) : next;
  };
  forces.clear();
  EXPECT_TRUE(has_fault(run_by("rd", scene, laws), "energy_rises"));
}

// A ball on a spring beside a box that lies on the floor, by a method that goes twice as far as it
// should: contacts take that back, and 1 + 4 (1 - cos w h) = 1.02 of the swing's energy is left a
// step. The step that is named is that of a method of order 4, of which the box's contacts say
// nothing.
TEST(RunWatch, WhatRestsElsewhereSaysNothingOfASwing) {
  scene::Scene scene = scene_of({plane("floor", Vector3d::Zero(), Vector3d::UnitZ()),
                                 box("box", {0.1, 0.1, 0.1}, 1.0, {5, 0, 0.1}, Vector3d::Zero()),
                                 ball("ball", 0.1, 1.0, {1, 0, 5}, Vector3d::Zero())},
                                1.0, kEarthGravity);
  for (scene::BodySpec& body : scene.bodies) body.restitution = 0.0;
  scene.bodies[2].collides = false;
  scene.contact.emplace();
  scene.step_s = 0.01;
  effects::SpringSpec spring;
  spring.a.body = "ball";
  spring.b.point_m = Vector3d(0, 0, 5);
  spring.stiffness_n_m = 100.0;
  spring.rest_length_m = 0.5;
  scene.effects.of<effects::SpringSpec>().push_back(spring);
  Laws laws = reference_laws();
  laws.integrate_step = [right = laws.integrate_step](const OdeFunction& f, double t,
                                                      const VectorXd& y, double h) -> VectorXd {
    return 2.0 * right(f, t, y, h) - y;
  };
  for (const std::string& engine : {std::string("rd"), std::string("ordered")}) {
    const Trajectory run = run_by(engine, scene, laws);
    ASSERT_TRUE(has_fault(run, "energy_rises")) << engine << said(run);
    EXPECT_GT(run.counters.counts.at("contact_solves"), 0u) << engine;
    for (const RunFault& fault : run.counters.faults)
      EXPECT_EQ(fault.remedy.find("contacts"), std::string::npos) << engine << fault.remedy;
  }
}

/// A bob of 1 kg on a wire of 1 m, let go from the side, and far from it an arm that a motor turns
/// to and fro.
scene::Scene pendulum_beside_a_motor(double amplitude, double largest_torque) {
  scene::Scene scene =
      scene_of({ball("bob", 0.0, 1.0, {1, 0, 0}, Vector3d::Zero()),
                box("arm", {0.5, 0.05, 0.05}, 3.0, {10.5, 0, 0}, Vector3d::Zero())},
               2.0, kEarthGravity);
  for (scene::BodySpec& body : scene.bodies) body.collides = false;
  scene.step_s = 0.01;
  scene.stabilisation.emplace();
  scene.effects.of<effects::RodSpec>().push_back(
      {"wire", {"", Vector3d::Zero()}, {"bob", Vector3d::Zero()}, 1.0});
  scene.effects.of<effects::JointSpec>().push_back(
      {"hinge", effects::JointKind::kHinge, "arm", "", {10, 0, 0}, Vector3d::UnitZ()});
  effects::MotorSpec motor;
  motor.joint = "hinge";
  motor.amplitude_rad = amplitude;
  motor.frequency_hz = 0.5;
  motor.stiffness_n_m_rad = 20.0;
  motor.damping_n_m_s_rad = 9.0;
  motor.largest_torque_n_m = largest_torque;
  scene.effects.of<effects::MotorSpec>().push_back(motor);
  return scene;
}

// A motor does torque times turn, however large its torque may become: it is no reason to look
// away. Explicit Euler makes more than a tenth of the swing's 10 J besides; what passes through the
// motor in these two seconds is some 30 J, of which the watch grants a hundredth.
TEST(RunWatch, AMotorWithoutALargestTorqueHidesNothing) {
  Laws wrong = reference_laws();
  wrong.integrator_source = "explicit Euler";
  wrong.integrate_step = [](const OdeFunction& f, double t, const VectorXd& y,
                            double h) -> VectorXd { return y + h * f(t, y); };
  for (const double largest : {std::numeric_limits<double>::infinity(), 10.0}) {
    const scene::Scene scene = pendulum_beside_a_motor(2.0, largest);
    EXPECT_EQ(said(run_by("rd", scene)), "") << largest << " N m";
    EXPECT_TRUE(has_fault(run_by("rd", scene, wrong), "energy_rises")) << largest << " N m";
  }
}

// An arm that its motor turns by more than a turn and back: 110 J at most.
TEST(RunWatch, WhatAMotorBringsInIsNoFault) {
  for (const double step : {1.0 / 60, 1.0 / 240}) {
    scene::Scene scene = pendulum_beside_a_motor(7.0, std::numeric_limits<double>::infinity());
    scene.bodies.erase(scene.bodies.begin());
    scene.effects.of<effects::RodSpec>().clear();
    scene.step_s = step;
    const Trajectory run = run_by("rd", scene);
    EXPECT_EQ(said(run), "") << step << " s";
    double most = 0.0;
    for (const Frame& frame : run.frames) most = std::max(most, frame.kinetic_energy);
    EXPECT_GT(most, 10.0) << "J: the motor does work";
  }
}

// A hinge's motor that overshoots spins a light body as fast as numbers go. No search for impacts
// follows that.
TEST(RunWatch, WhatTurnsTooFarInAStepIsStoppedInTime) {
  for (const std::string& engine : {std::string("rd"), std::string("ordered")}) {
    const std::string why = run_by(engine, broken_scene("min_135_crash")).stopped_by;
    EXPECT_NE(why.find("turns"), std::string::npos) << engine << ": " << why;
  }
}

// Eight boxes of 1 cm on ball joints, held out level: where they hang they swing too fast for 1/60
// s.
TEST(RunWatch, AChainOfSmallBoxesIsReportedWithTheStepItNeeds) {
  const Trajectory run = run_by("rd", broken_scene("chain_0.01_1"));
  EXPECT_NE(said(run).find("between its joints"), std::string::npos) << said(run);
  EXPECT_TRUE(!run.stopped_by.empty() || !run.counters.faults.empty()) << said(run);
}

/// A heavy ball on light links, drawn back by an angle: a wrecking ball.
scene::Scene heavy_on_light_links(double ratio, int links, double angle) {
  const Vector3d along(std::sin(angle), 0, -std::cos(angle));
  scene::Scene scene = scene_of({}, 1.5, kEarthGravity);
  for (int k = 1; k <= links + 1; ++k) {
    scene.bodies.push_back(ball(k > links ? "ball" : fmt::format("link_{}", k), 0.0,
                                k > links ? ratio : 1.0, 0.5 * k * along, Vector3d::Zero()));
    scene.bodies.back().collides = false;
    scene.effects.of<effects::RodSpec>().push_back(
        {fmt::format("rod {}", k),
         {k == 1 ? "" : fmt::format("link_{}", k - 1), Vector3d::Zero()},
         {scene.bodies.back().name, Vector3d::Zero()},
         0.5});
  }
  scene.stabilisation.emplace();
  return scene;
}

// A step that is named is one at which it runs right: rods hold, energy stays.
// A plank that turns about its middle, which is the world's origin, and is hit: all its coordinates
// are 0, and so is what could be compared with its errors but for its own size.
TEST(RunWatch, AHingeInTheOriginIsAsGoodAsElsewhere) {
  for (const double height : {0.0, 1.0})
    for (const std::string& engine : kEngines) {
      scene::Scene scene =
          scene_of({box("plank", {1, 0.15, 0.05}, 4.0, {0, 0, height}, Vector3d::Zero()),
                    ball("ball", 0.1, 1.0, {0.7, 0, height + 0.8}, Vector3d::Zero())},
                   0.6, kEarthGravity);
      scene.effects.of<effects::JointSpec>().push_back(
          {"hinge", effects::JointKind::kHinge, "plank", "", {0, 0, height}, Vector3d::UnitY()});
      const Trajectory run = run_by(engine, scene);
      EXPECT_TRUE(run.counters.faults.empty()) << engine << ", " << height << " m:" << said(run);
    }
}

// A motor counts whole turns: k (target - angle) - d rate comes to rest at its target, wherever
// that is. k, d and the moment 1 kg m^2 make it critically damped within 1 %; after 6 s the rest is
// 3.3 (1 + 27) e^-27.
TEST(Motors, TurnToTargetsBeyondHalfATurn) {
  for (const double target : {3.3, -7.0})
    for (const std::string& engine : {std::string("rd"), std::string("tw")}) {
      scene::Scene scene =
          scene_of({box("arm", {0.5, 0.05, 0.05}, 3.0, {0.5, 0, 0}, Vector3d::Zero())}, 6.0);
      scene.step_s = 0.005;
      scene.bodies[0].collides = false;
      scene.effects.of<effects::JointSpec>().push_back(
          {"hinge", effects::JointKind::kHinge, "arm", "", {0, 0, 0}, Vector3d::UnitZ()});
      effects::MotorSpec motor;
      motor.joint = "hinge";
      motor.offset_rad = target;
      motor.stiffness_n_m_rad = 20.0;
      motor.damping_n_m_s_rad = 9.0;
      scene.effects.of<effects::MotorSpec>().push_back(motor);
      const Trajectory run = run_by(engine, scene);
      EXPECT_EQ(run.stopped_by, "") << engine;
      double turned = 0.0;  // of the arm, whole turns counted
      for (std::size_t k = 1; k < run.frames.size(); ++k)
        turned +=
            run.frames[k].poses[0].omega_world.z() * (run.frames[k].time - run.frames[k - 1].time);
      // The world is the hinge's second body: its angle against the arm is minus the arm's. 0.1: a
      // sum over frames of a motion that begins at once.
      EXPECT_NEAR(turned, -target, 0.1 * std::abs(target)) << engine;
      const Vector3d ahead = run.frames.back().poses[0].world_from_body * Vector3d::UnitX();
      EXPECT_NEAR(std::atan2(ahead.y(), ahead.x()), std::remainder(-target, 2 * std::numbers::pi),
                  1e-5)
          << engine;
      EXPECT_NEAR(run.frames.back().kinetic_energy, 0.0, 1e-9) << engine;
    }
}

TEST(NamedSteps, AreStepsAtWhichItRunsRight) {
  const Laws laws = reference_laws();
  const std::vector<scene::Scene> scenes = {heavy_on_light_links(1e3, 4, 0.87),
                                            heavy_on_light_links(1e4, 2, 0.5),
                                            light_above_heavy(1e3, 1), light_above_heavy(1e4, 5)};
  for (scene::Scene scene : scenes) {
    std::vector<std::string> notices;
    scene.step_s = 1.0 / 30;
    const World world = build_world(scene);
    const auto step = engines::report_unstable_links(world, engines::LinkForces(world), laws,
                                                     {scene.step_s, scene.duration_s}, notices);
    ASSERT_TRUE(step) << scene.bodies.back().mass_kg.value_or(0.0);
    ASSERT_EQ(notices.size(), 1u);
    scene.step_s = *step;
    const Trajectory run = run_by("rd", scene, laws);
    EXPECT_EQ(said(run), "") << scene.bodies.size() << " bodies at " << *step << " s";
    EXPECT_LT(worst_rod(scene, run), 1e-6);
  }
}

}  // namespace
}  // namespace tumble::testing
