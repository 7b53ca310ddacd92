// Energy that is lost beside dampers, drag, water, forces and bodies that are moved: what these take
// and bring in is no loss, and hides none.
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "framework/core/random.h"
#include "framework/effects/build_world.h"
#include "framework/effects/drag/drag.h"
#include "framework/effects/joint/joint.h"
#include "framework/effects/motor/motor.h"
#include "framework/effects/point_force/point_force.h"
#include "framework/effects/rod/rod.h"
#include "framework/effects/spring/spring.h"
#include "framework/effects/water/water.h"
#include "tests/engines/energy_losses.h"
#include "tests/engines/scenes.h"
#include "tests/engines/watched_runs.h"

namespace tumble::testing::energy_loss_beside_test {
namespace {

// Of a swing that a damper of 1e-6 N s/m takes 1e-9 of in the run, w h = 1.2 takes nearly all; with
// drag of a heavy ball elsewhere, too. Engines that look at frames say so as `rd` does, by what the
// damper takes in each step, and the event engines all the same.
TEST(EnergyLost, IsNotHiddenByDampersInAnyEngine) {
  scene::Scene scene = swing(1.0, 82944.0, 0.1, 1.0 / 240, 0.5);
  scene.effects.of<effects::SpringSpec>()[0].damping_n_s_m = 1e-6;
  scene.bodies.push_back(ball("dragged", 0.1, 100.0, {0, 5, 0}, {1, 0, 0}));
  scene.effects.of<effects::DragSpec>().push_back({"dragged", 300.0, 0.0});
  std::optional<double> of_events;
  for (const std::string engine : {"rd", "ordered", "ca", "tw"}) {
    const Trajectory run = run_by(engine, scene);
    const auto fault = lost_in(run);
    ASSERT_TRUE(fault) << engine << said(run);
    EXPECT_EQ(fault->subject, "'bob'") << engine;
    EXPECT_GT(fault->worst, 0.5) << engine;
    if (engine == "rd") continue;
    EXPECT_EQ(fault->worst, of_events.value_or(fault->worst)) << engine;
    of_events = fault->worst;
  }
}

// The same swing, which the drag of a medium takes as little of, or that of the water round it.
TEST(EnergyLost, IsNotHiddenByDragOrWaterInAnyEngine) {
  for (const bool in_water : {false, true}) {
    scene::Scene scene = swing(1.0, 82944.0, 0.1, 1.0 / 240, 0.5);
    if (in_water) {
      effects::set_gravity(scene, kDown);
      effects::WaterSpec water;
      water.surface_m = {0, 0, 10};
      water.drag_1_s = 1e-4;  // times 4 g of water, on 1 kg
      scene.effects.of<effects::WaterSpec>().push_back(water);
    } else {
      scene.effects.of<effects::DragSpec>().push_back({"bob", 1e-6, 0.0});
    }
    std::optional<double> of_events;
    for (const std::string engine : {"rd", "ordered", "ca", "tw"}) {
      const Trajectory run = run_by(engine, scene);
      const auto fault = lost_in(run);
      ASSERT_TRUE(fault) << engine << in_water << said(run);
      EXPECT_GT(fault->worst, 0.5) << engine;
      if (engine == "rd") continue;
      EXPECT_EQ(fault->worst, of_events.value_or(fault->worst)) << engine;
      of_events = fault->worst;
    }
  }
}

// The same swing, which a force draws aside: from the start, or for a while that begins and ends
// between frames, where event engines see it before and after.
TEST(EnergyLost, IsNotHiddenByForcesInAnyEngine) {
  for (const double start : {0.0, 0.1234}) {
    scene::Scene scene = swing(1.0, 82944.0, 0.1, 1.0 / 240, 0.5);
    scene.effects.of<effects::PointForceSpec>().push_back(
        {"bob", {0, 0.5, 0.2}, scene.bodies[0].position_m, start, start > 0 ? 0.0567 : 1.0});
    for (const std::string engine : {"rd", "ordered", "ca", "tw"}) {
      const Trajectory run = run_by(engine, scene);
      const auto fault = lost_in(run);
      ASSERT_TRUE(fault) << engine << start << said(run);
      EXPECT_GT(fault->worst, 0.5) << engine;
    }
  }
}

// Forces on bodies that turn and swing, and that begin and end anywhere, are work, not a loss nor a
// rise.
TEST(EnergyLost, IsNotWhatForcesDo) {
  const Laws laws = reference_laws();
  Random random(17);
  for (int trial = 0; trial < 24; ++trial) {
    const double mass = random.between(0.5, 5.0), frequency = random.between(1.0, 20.0);
    scene::Scene scene = swing(mass, mass * frequency * frequency, 0.2, 1.0 / 480, 0.6);
    scene.bodies[0].shape = scene::BoxSpec{{0.3, 0.2, 0.2}};
    scene.bodies[0].omega_world_rad_s = {random.between(-5.0, 5.0), 3, random.between(-5.0, 5.0)};
    for (int force = 0; force < 3; ++force) {
      const auto any = [&](double most) {
        return Vector3d(random.between(-most, most), random.between(-most, most),
                        random.between(-most, most));
      };
      const double start = force == 0 ? 0.0 : random.between(0.0, 0.4);
      scene.effects.of<effects::PointForceSpec>().push_back({scene.bodies[0].name, any(10.0 * mass),
                                                             scene.bodies[0].position_m + any(0.1),
                                                             start, random.between(0.01, 0.5)});
    }
    for (const std::string engine : {"rd", "ordered", "tw"}) {
      const Trajectory run = run_by(engine, scene, laws);
      EXPECT_FALSE(lost_in(run)) << engine << trial << said(run);
      EXPECT_FALSE(has_fault(run, "energy_rises")) << engine << trial << said(run);
    }
  }
}

// What drag and water take between two frames, over which bodies swing, sink and rise many times,
// is looked at where steps begin: right runs are told nothing of.
TEST(EnergyLost, IsNotWhatDragAndWaterTakeBetweenFrames) {
  const Laws laws = reference_laws();
  Random random(11);
  for (int trial = 0; trial < 24; ++trial) {
    const double mass = random.between(2.0, 11.0), frequency = random.between(1.0, 200.0);
    scene::Scene scene = swing(mass, mass * frequency * frequency, 0.2, 0.1 / frequency / 2, 0.6);
    scene.step_s = std::min(scene.step_s, 1.0 / 240);
    scene.bodies[0].shape = scene::BoxSpec{{0.3, 0.2, 0.2}};
    scene.bodies[0].velocity_m_s = {0, random.between(-3.0, 3.0), random.between(-3.0, 3.0)};
    scene.bodies[0].omega_world_rad_s = {5, random.between(-5.0, 5.0), 1};
    const bool in_water = trial % 2 == 0;
    if (in_water) {
      effects::set_gravity(scene, kDown);
      effects::WaterSpec water;
      water.surface_m = {0, 0, random.between(-0.2, 0.2)};
      water.drag_1_s = 0.1 * std::pow(1000.0, random.unit());
      scene.effects.of<effects::WaterSpec>().push_back(water);
    } else {
      scene.effects.of<effects::DragSpec>().push_back(
          {"bob", mass * 0.1 * std::pow(1000.0, random.unit()), random.between(0.0, 1e-2)});
    }
    const std::string engine = trial % 3 == 0 ? "tw" : trial % 3 == 1 ? "ordered" : "ca";
    const Trajectory run = run_by(engine, scene, laws);
    EXPECT_TRUE(run.counters.faults.empty()) << trial << ' ' << engine << said(run);
  }
}

// The same swing from an anchor that moves evenly, in gravity that the spring holds: by Galileo's
// principle it loses, or wins, what it does from one at rest, and all of it is the step's. Damped
// rightly it is not told; nor where a second spring leads to what stands still, which does work.
TEST(EnergyLost, FromAnchorsThatMoveEvenlyAsFromThoseAtRest) {
  const auto hung = [](const Vector3d& velocity, double damping, bool is_held_twice = false) {
    scene::Scene scene = scene_of({ball("anchor", 0.01, 1.0, {0, 0, 0}, Vector3d::Zero()),
                                   ball("bob", 0.01, 1.0, {0, 0.3, -1.1}, velocity)},
                                  2.0, kDown);
    scene.bodies[0].immovable = true;
    scene.bodies[0].mass_kg.reset();
    scene.bodies[0].collides = false;
    scene.bodies[0].motion.emplace();
    scene.bodies[0].motion->velocity_m_s = velocity;
    scene.effects.of<effects::SpringSpec>().push_back(
        spring_between("anchor", Vector3d::Zero(), "bob", 3600.0, 1.0, damping));
    if (is_held_twice)
      scene.effects.of<effects::SpringSpec>().push_back(
          spring_between("", Vector3d::UnitX(), "bob", 1.0, 0.5));
    scene.step_s = 1.0 / 60;
    return scene;
  };
  const Vector3d V(0.5, -1.0, 2.0);
  for (const char* engine : {"rd", "ordered"}) {
    SCOPED_TRACE(engine);
    const Trajectory rest = run_by(engine, hung(Vector3d::Zero(), 0.0)),
                     moves = run_by(engine, hung(V, 0.0));
    ASSERT_TRUE(lost_in(rest) && lost_in(moves));
    EXPECT_GT(lost_in(rest)->worst, 0.5) << "(w h)^6 / 72 = 1.4 % a step of w h = 1";
    EXPECT_NEAR(lost_in(moves)->worst, lost_in(rest)->worst, 1e-9) << "rounding, of m v^2 = 5 J";
    EXPECT_FALSE(lost_in(run_by(engine, hung(V, 0.0, true))));
  }
  EXPECT_FALSE(lost_in(run_by("rd", hung(V, 20.0))));
}

/// Shaken by lot: a bob on a spring, a rod or a joint of an anchor, at its own frequency or another.
scene::Scene shaken_swing(Random& random, double radians_a_step) {
  const double step = 1.0 / 240, frequency = radians_a_step / step;
  scene::Scene scene = scene_of({ball("anchor", 0.01, 1.0, {0, 0, 0}, Vector3d::Zero()),
                                 box("bob", {0.05, 0.1, 0.08}, 1.0, {0.6, 0, -0.8},
                                     {0, random.between(-0.5, 0.5), random.between(-0.5, 0.5)})},
                                2.0, kDown);
  scene::BodySpec& anchor = scene.bodies[0];
  anchor.immovable = true;
  anchor.mass_kg.reset();
  anchor.collides = false;
  anchor.motion.emplace();
  anchor.motion->velocity_m_s = {random.between(-1, 1), 0, 0};
  anchor.motion->angular_frequency_rad_s =
      std::min(frequency * random.between(0.5, 1.5), 0.3 / step);
  // up to twice gravity
  anchor.motion->amplitude_m = Vector3d(random.between(-1, 1), 0, random.between(-1, 1)) * 20 /
                               std::pow(anchor.motion->angular_frequency_rad_s, 2);
  scene.step_s = step;
  const double stiffness = frequency * frequency;
  switch (random.below(3)) {
    case 0:
      scene.effects.of<effects::RodSpec>().push_back(
          {"rod", {"anchor", Vector3d::Zero()}, {"bob", Vector3d::Zero()}, 1.0});
      break;
    case 1:
      scene.effects.of<effects::JointSpec>().push_back(
          {"joint", effects::JointKind::kBall, "anchor", "bob", {0, 0, 0}, Vector3d::UnitZ()});
      break;
    default:
      scene.effects.of<effects::SpringSpec>().push_back(
          spring_between("anchor", Vector3d::Zero(), "bob", stiffness, 0.9));
  }
  return scene;
}

// What shaking brings and takes is no fault, at resonance neither, where the step follows; where a
// spring is too stiff for it, what the step takes is told as from an anchor at rest.
TEST(EnergyLost, FromAnchorsThatAreShakenIsTheStepsAlone) {
  Random random(77);
  for (int trial = 0; trial < 40; ++trial) {
    const scene::Scene scene = shaken_swing(random, random.between(0.01, 0.15));
    for (const char* engine : {"rd", "ordered"}) {
      const Trajectory run = run_by(engine, scene);
      EXPECT_TRUE(run.counters.faults.empty()) << trial << " " << engine << said(run);
    }
  }
  for (const double shaken : {0.0, 3.0}) {
    scene::Scene scene = swing(1.0, 5000.0, 0.2, 1.0 / 60, 2.0);
    scene.bodies.push_back(ball("anchor", 0.01, 1.0, Vector3d::Zero(), Vector3d::Zero()));
    scene.bodies[1].immovable = true;
    scene.bodies[1].mass_kg.reset();
    scene.bodies[1].motion.emplace();
    scene.bodies[1].motion->amplitude_m = {0.01, 0, 0};
    scene.bodies[1].motion->angular_frequency_rad_s = shaken;
    scene.effects.of<effects::SpringSpec>()[0].a.body = "anchor";
    const auto fault = lost_in(run_by("rd", scene));
    ASSERT_TRUE(fault) << shaken;
    EXPECT_GT(fault->worst, 0.9) << "4.2 % a step of w h = 1.2, in 120";
  }
}

// A wall that moves far away gives a swing nothing, and Euler's method lengthens it all the same:
// by 1 + (w h)^2 a step.
TEST(EnergyRises, AreToldBesideDrivenBodies) {
  scene::Scene scene = swing(1.0, 4.0, 0.2, 1.0 / 60, 2.0);
  scene.bodies.push_back(box("wall", {0.1, 0.1, 0.1}, 1.0, {9, 9, 9}, Vector3d::Zero()));
  scene.bodies[1].immovable = true;
  scene.bodies[1].mass_kg.reset();
  Laws euler = reference_laws();
  euler.integrate_step = [](const OdeFunction& f, double t, const VectorXd& y, double h) {
    return VectorXd(y + h * f(t, y));
  };
  const auto rise_by = [&](const Laws& laws) {
    for (const RunFault& fault : run_by("rd", scene, laws).counters.faults)
      if (fault.kind == "energy_rises") return fault.worst;
    return 0.0;
  };
  EXPECT_GT(rise_by(euler), 0.05);
  scene.bodies[1].motion.emplace();
  scene.bodies[1].motion->velocity_m_s = {0.1, 0, 0};
  const double grown = std::pow(1 + 4.0 / 3600, 120);
  EXPECT_NEAR(rise_by(euler), (grown - 1) / grown, 1e-9) << "of all that it has at the end";
  EXPECT_EQ(rise_by(reference_laws()), 0.0);
}

// ---- Runs that lose rightly ---------------------------------------------------------------------

// Damped springs, drag and gravity by lot, from a tenth to three times critical.
TEST(EnergyLost, IsNotWhatDampersAndDragTake) {
  const Laws laws = reference_laws();
  Random random(7);
  for (int trial = 0; trial < 20; ++trial) {
    const double step = 1.0 / 240, mass = random.between(0.1, 10.0),
                 frequency = random.between(1.0, 60.0);
    scene::Scene scene = swing(mass, mass * frequency * frequency, 0.3, step, 1.0);
    scene.effects.of<effects::SpringSpec>()[0].damping_n_s_m =
        mass * frequency * 2.0 * 0.1 * std::pow(30.0, random.unit());
    if (trial % 2 == 0)
      scene.effects.of<effects::DragSpec>().push_back(
          {"bob", mass * random.between(0.1, 100.0), random.between(0.0, 1e-3)});
    if (trial % 3 == 0) effects::set_gravity(scene, Vector3d(0, 0, -9.81));
    for (double& velocity : scene.bodies[0].velocity_m_s) velocity = random.between(-3.0, 3.0);
    scene.bodies[0].omega_world_rad_s = {5, random.between(-5.0, 5.0), 1};
    const std::string& engine = kEngines[static_cast<std::size_t>(trial) % 3];
    const Trajectory run = run_by(engine, scene, laws);
    EXPECT_TRUE(run.counters.faults.empty()) << trial << ' ' << engine << said(run);
  }
}

// A motor that stops a wheel, a force against its flight, and water: what they take is metered.
TEST(EnergyLost, IsNotWhatBrakesForcesAndWaterTake) {
  const Laws laws = reference_laws();
  scene::Scene wheel =
      scene_of({box("wheel", {0.3, 0.3, 0.05}, 2.0, Vector3d::Zero(), Vector3d::Zero())}, 1.0);
  wheel.bodies[0].omega_world_rad_s = {0, 0, 6};
  wheel.stabilisation.emplace();
  effects::JointSpec hinge;
  hinge.name = "axle";
  hinge.kind = effects::JointKind::kHinge;
  hinge.body_a = "wheel";
  wheel.effects.of<effects::JointSpec>().push_back(hinge);
  effects::MotorSpec brake;
  brake.joint = "axle";
  brake.damping_n_m_s_rad = 0.5;
  wheel.effects.of<effects::MotorSpec>().push_back(brake);

  scene::Scene pushed = scene_of({ball("pushed", 0.1, 1.0, Vector3d::Zero(), {3, 0, 0})}, 1.0);
  effects::PointForceSpec push;
  push.body = "pushed";
  push.force_n = {-3, 0, 0};
  push.point_m = Vector3d::Zero();
  push.duration_s = 0.9;
  pushed.effects.of<effects::PointForceSpec>().push_back(push);

  scene::Scene floating =
      scene_of({box("floating", {0.3, 0.2, 0.1}, 12.0, {0, 0, 0.3}, {1, 0, 0})}, 2.0, kDown);
  floating.bodies[0].omega_world_rad_s = {1, 0.5, 2};
  effects::WaterSpec water;
  water.drag_1_s = 2.0;
  floating.effects.of<effects::WaterSpec>().push_back(water);
  scene::Scene carried = floating;
  carried.effects.of<effects::WaterSpec>()[0].stream_m_s = {-1, 0, 0};

  for (scene::Scene* scene : {&wheel, &pushed, &floating, &carried})
    for (const std::string& engine : {std::string("rd"), std::string("ordered")}) {
      scene->step_s = 1.0 / 240;
      const Trajectory run = run_by(engine, *scene, laws);
      EXPECT_TRUE(run.counters.faults.empty()) << engine << said(run);
      EXPECT_LT(run.frames.back().kinetic_energy, 0.9 * run.frames.front().kinetic_energy + 5.0);
    }
}

// Bodies that fall on each other, rebound, slide and come to rest, some of them on springs and rods
// by lot: restitution and friction take what they take, in every engine.
TEST(EnergyLost, IsNotWhatImpactsAndContactsTake) {
  const Laws laws = reference_laws();
  for (unsigned seed = 1; seed <= 6; ++seed) {
    Random random(seed);
    scene::Scene scene =
        scene_of({plane("floor", Vector3d::Zero(), Vector3d::UnitZ())}, 1.0, kDown);
    for (int i = 0; i < 4; ++i) {
      const std::string name = fmt::format("b{}", i);
      const Vector3d place(0.4 * i + random.between(-0.05, 0.05), random.between(-0.2, 0.2),
                           random.between(0.3, 1.0));
      scene.bodies.push_back(random.unit() < 0.5
                                 ? ball(name, 0.12, random.between(0.5, 2.0), place, {0, 0, 0})
                                 : box(name, Vector3d::Constant(0.1), random.between(0.5, 2.0),
                                       place, {random.between(-2.0, 2.0), 0, 0}));
    }
    for (scene::BodySpec& body : scene.bodies) {
      body.restitution = random.between(0.0, 1.0);
      body.friction = random.between(0.0, 0.8);
    }
    scene.step_s = 1.0 / 240;
    if (seed % 3 != 0) scene.contact.emplace();
    if (seed % 2 == 0)
      scene.effects.of<effects::SpringSpec>().push_back(
          spring_between("b0", Vector3d::Zero(), "b1", 100.0, 0.4));
    if (seed % 4 < 2) {
      scene.stabilisation.emplace();
      const double length = (scene.bodies[3].position_m - scene.bodies[4].position_m).norm();
      scene.effects.of<effects::RodSpec>().push_back(
          {"rod", {"b2", Vector3d::Zero()}, {"b3", Vector3d::Zero()}, length});
    }
    for (const std::string& engine : kEngines) {
      if (!scene.contact && engine != "rd" && seed % 2 == 0) continue;
      const Trajectory run = run_by(engine, scene, laws);
      EXPECT_FALSE(lost_in(run)) << seed << ' ' << engine << said(run);
    }
  }
}

}  // namespace
}  // namespace tumble::testing::energy_loss_beside_test
