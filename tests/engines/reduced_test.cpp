// Rods and joints in joint coordinates: the same motion as in six coordinates a body, without rows.
#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "tests/support/places.h"
#include "assignments/a1_impulse/a1_binding.h"
#include "assignments/a2_integration/a2_binding.h"
#include "assignments/a3_constraints/a3_binding.h"
#include "framework/core/error.h"
#include "framework/dynamics/methods.h"
#include "framework/engines/run.h"
#include "framework/effects/gravity/gravity.h"
#include "framework/effects/joint/joint.h"
#include "framework/effects/rod/rod.h"
#include "framework/truths/memory_scene.h"
#include "framework/modules/load.h"
#include "framework/modules/registry.h"
#include "framework/scene/load_scene.h"

namespace tumble::testing::reduced_test {
namespace {

using scene::Coordinates;

Laws laws() {
  modules::Registry registry;
  register_assignments(registry);
  const std::filesystem::path built = std::filesystem::path(test::binary_dir()) / "modules";
  Laws laws = library_laws();
  a1::bind(*std::static_pointer_cast<const a1::Module>(
               modules::load_module(registry.find("a1"), built / "a1_reference.so")),
           laws);
  a2::bind(*std::static_pointer_cast<const a2::Module>(
               modules::load_module(registry.find("a2"), built / "a2_reference.so")),
           laws);
  a3::bind(*std::static_pointer_cast<const a3::Module>(
               modules::load_module(registry.find("a3"), built / "a3_reference.so")),
           laws);
  return laws;
}

scene::Scene of_course(const std::string& name, double duration) {
  scene::Scene scene = scene::load_scene(std::filesystem::path(test::source_dir()) /
                                         "assignments/a3_constraints/scenes" / (name + ".json"));
  scene.duration_s = duration;
  return scene;
}

Trajectory run_by(const Laws& by, scene::Scene scene, Coordinates coordinates, double step,
                  const std::string& engine, double frame_rate_hz = 10.0) {
  scene.coordinates = coordinates;
  engines::RunOptions options;
  options.engine = engine;
  options.step_s = step;
  options.frame_rate_hz = frame_rate_hz;
  TrajectoryRecorder recorder;
  engines::run_scene(scene, by, options, recorder);
  EXPECT_EQ(recorder.trajectory().stopped_by, "");
  return recorder.trajectory();
}
Trajectory run(const scene::Scene& scene, Coordinates coordinates, double step,
               const std::string& engine = "rd", double frame_rate_hz = 10.0) {
  return run_by(laws(), scene, coordinates, step, engine, frame_rate_hz);
}

/// Largest distance of centres, and of turnings in parts of 1 m. [m]
double distance(const Trajectory& a, const Trajectory& b) {
  double worst = a.frames.size() == b.frames.size() ? 0.0 : 1.0;
  for (std::size_t k = 0; k < std::min(a.frames.size(), b.frames.size()); ++k)
    for (std::size_t i = 0; i < a.frames[k].poses.size(); ++i) {
      const BodyPose &p = a.frames[k].poses[i], &q = b.frames[k].poses[i];
      worst = std::max({worst, (p.com_world - q.com_world).norm(),
                        p.world_from_body.angularDistance(q.world_from_body)});
    }
  return worst;
}

std::uint64_t solves(const Trajectory& run) { return run.counters.counts.at("constraint_solves"); }

TEST(JointCoordinates, MoveScenesOfTheCourseAsSixCoordinatesABodyDo) {
  // Both are of order 4 with errors of their own: half the step brings them 16 times nearer. Half
  // of that is asked for, and to be near enough that another motion shows: a wrong bias term or
  // torque is off by centimetres in a second.
  for (const auto& [name, step] : {std::pair{"double_pendulum", 1.0 / 120},
                                   {"chain_8", 1.0 / 240},
                                   {"four_bar", 1.0 / 60},
                                   {"robot_arm", 1.0 / 200}}) {
    const scene::Scene scene = of_course(name, 0.8);
    const auto apart = [&](double h) {
      return distance(run(scene, Coordinates::kReduced, h), run(scene, Coordinates::kMaximal, h));
    };
    const double coarse = apart(step), fine = apart(0.5 * step);
    EXPECT_LT(coarse, 1e-3) << name;
    EXPECT_LT(fine, std::max(coarse / 8, 1e-11)) << name;
  }
}

TEST(JointCoordinates, OfATreeAskForNoRowsInAStep) {
  const Trajectory tree = run(of_course("double_pendulum", 0.8), Coordinates::kReduced, 1.0 / 480);
  EXPECT_EQ(solves(tree), 0u) << "nor what frames record of its rods";
  const Trajectory loop = run(of_course("four_bar", 0.8), Coordinates::kReduced, 1.0 / 480);
  EXPECT_GT(solves(loop), loop.frames.size() + 1) << "a loop is closed by rows";
}

TEST(JointCoordinates, AreAskedForAccelerationsOnceASymplecticStep) {
  Laws symplectic = laws();
  symplectic.integrate_step = step_of(method_named("symplectic"), kUnset);
  const scene::Scene scene = of_course("double_pendulum", 0.1);
  for (const Coordinates coordinates : {Coordinates::kReduced, Coordinates::kMaximal}) {
    const auto counts = run_by(symplectic, scene, coordinates, 1e-3, "rd").counters.counts;
    EXPECT_EQ(counts.at("steps"), 100u);
    EXPECT_EQ(counts.at("derivative_evaluations"), 100u)
        << (coordinates == Coordinates::kReduced ? "reduced" : "maximal");
  }
}

TEST(JointCoordinates, KeepTheirEnergyToTheOrderOfTheMethod) {
  const auto lost = [&](double step) {
    const Trajectory of = run(of_course("double_pendulum", 1.0), Coordinates::kReduced, step);
    double worst = 0.0;
    for (const Frame& frame : of.frames)
      worst = std::max(
          worst, std::abs(frame.kinetic_energy + frame.potential_energy -
                          of.frames.front().kinetic_energy - of.frames.front().potential_energy));
    return worst;
  };
  // RK4 loses energy by order 4 or 5 a unit of time: 16 or 32 times, less what the next terms add
  EXPECT_GT(lost(1.0 / 60) / lost(1.0 / 120), 12.0);
}

TEST(JointCoordinates, AreTheSameInProcesses) {
  const scene::Scene scene = of_course("double_pendulum", 0.8);
  EXPECT_LT(distance(run(scene, Coordinates::kReduced, 1.0 / 480, "ordered"),
                     run(scene, Coordinates::kReduced, 1.0 / 480)),
            1e-12)
      << "one island, the same steps: rounding alone";
}

TEST(JointCoordinates, GiveWayToSixCoordinatesInContact) {
  // A ball drops on a block that hangs on rods, bounces and stays: the block leaves joint
  // coordinates and goes on from the same state. Both are at their step's truncation, which is the
  // same where nothing turns; rounding, through some fifteen impacts, is 1e-12.
  const scene::Scene scene = of_course("dropped_on_a_block_on_rods", 0.8);
  const Trajectory reduced = run(scene, Coordinates::kReduced, scene.step_s),
                   maximal = run(scene, Coordinates::kMaximal, scene.step_s);
  EXPECT_GT(reduced.events.size(), 1u);
  EXPECT_LT(distance(reduced, maximal), 1e-10);
}

/// A dumbbell that slides off a table and tips over its edge: a contact that begins, turns and ends.
scene::Scene dumbbell() {
  scene::Scene scene = truths::empty_scene("dumbbell", 1.0, 1e-9);
  effects::set_gravity(scene, {0, 0, -9.81});
  scene.stabilisation = scene::StabilisationSpec{};
  scene.contact.emplace();
  for (const auto& [name, mass, x, z] :
       {std::tuple{"a", 1.0, 0.0, 0.15}, std::tuple{"b", 2.0, 0.5, 0.2}}) {
    scene::BodySpec ball;
    ball.name = name;
    ball.shape = scene::SphereSpec{0.1};
    ball.mass_kg = mass;
    ball.position_m = {x, 0, z};
    ball.velocity_m_s = {1.5, 0.1, 0};
    ball.restitution = 0.0;
    scene.bodies.push_back(ball);
  }
  scene::BodySpec table = scene.bodies.back();
  table.name = "table";
  table.shape = scene::BoxSpec{{0.6, 1.0, 0.1}};
  table.immovable = true;
  table.mass_kg.reset();
  table.position_m = {0.3, 0, -0.1};
  table.velocity_m_s.setZero();
  scene.bodies.push_back(table);
  effects::RodSpec rod;
  rod.name = "rod";
  rod.a = {"a", Vector3d::Zero()};
  rod.b = {"b", Vector3d::Zero()};
  rod.length_m = (scene.bodies[1].position_m - scene.bodies[0].position_m).norm();
  scene.effects.of<effects::RodSpec>().push_back(rod);
  return scene;
}

TEST(JointCoordinates, JumpNowhereWhereAContactEnds) {
  // What a tree takes over fits its rods, at the end of every step in contact: what did not would be
  // projected where the contact ends, 3e-4 m/s here. Rounding of the rod's direction is 1e-15.
  for (const char* engine : {"rd", "ordered"}) {
    const scene::Scene scene = dumbbell();
    const Trajectory of = run(scene, Coordinates::kReduced, 1.0 / 500, engine, 500.0);
    const auto ends = std::count_if(of.events.begin(), of.events.end(), [](const Event& event) {
      return event.kind == EventKind::kBreak;
    });
    EXPECT_GE(ends, 1) << engine;
    for (const Frame& frame : of.frames) {
      const Vector3d along = frame.poses[1].com_world - frame.poses[0].com_world;
      EXPECT_NEAR(
          along.normalized().dot(frame.poses[1].velocity_world - frame.poses[0].velocity_world),
          0.0, 1e-12)
          << engine << ", t = " << frame.time;
    }
  }
}

TEST(JointCoordinates, RecordWhatRowsWouldPullWith) {
  // Forces at the same states: at the start, where both stand alike. Rows are solved with a
  // condition number of at most 1e4 here; a sign, or an arm left out, is off by the force.
  for (const char* name : {"double_pendulum", "chain_8", "robot_arm", "heavy_bob"}) {
    const scene::Scene scene = of_course(name, 0.1);
    const Frame tree = run(scene, Coordinates::kReduced, 1.0 / 2000).frames.front(),
                rows = run(scene, Coordinates::kMaximal, 1.0 / 2000).frames.front();
    ASSERT_EQ(tree.rod_tensions.size(), rows.rod_tensions.size());
    ASSERT_EQ(tree.joint_forces.size(), rows.joint_forces.size());
    ASSERT_GT(tree.rod_tensions.size() + tree.joint_forces.size(), 0u);
    double largest = 1.0;
    for (const auto* forces : {&rows.rod_tensions, &rows.joint_forces})
      for (const double force : *forces) largest = std::max(largest, std::abs(force));
    for (std::size_t k = 0; k < rows.rod_tensions.size(); ++k)
      EXPECT_NEAR(tree.rod_tensions[k], rows.rod_tensions[k], 1e-10 * largest) << name << ' ' << k;
    for (std::size_t k = 0; k < rows.joint_forces.size(); ++k)
      EXPECT_NEAR(tree.joint_forces[k], rows.joint_forces[k], 1e-10 * largest) << name << ' ' << k;
  }
}

TEST(JointCoordinates, OfATreeNeedNoLawOfRows) {
  // The library's laws know nothing of rods: the same method, so the same motion but for rounding,
  // which a chain that whips multiplies by a thousand.
  for (const char* name : {"double_pendulum", "chain_8", "robot_arm"})
    for (const char* engine : {"rd", "ordered"}) {
      const scene::Scene scene = of_course(name, 0.5);
      const Trajectory alone =
          run_by(library_laws(), scene, Coordinates::kReduced, 1.0 / 960, engine);
      EXPECT_EQ(alone.stopped_by, "") << name;
      EXPECT_LT(distance(alone, run(scene, Coordinates::kReduced, 1.0 / 960, engine)), 1e-11)
          << name << ", " << engine;
    }
}

TEST(JointCoordinates, DoNotBlameRowsThatATreeAsksForNone) {
  // a bob of ten kilograms on links of a gram: their swings are too fast for this step
  scene::Scene scene = of_course("heavy_bob", 1.0);
  for (const auto coordinates : {Coordinates::kReduced, Coordinates::kMaximal}) {
    scene.coordinates = coordinates;
    engines::RunOptions options;
    options.step_s = 1.0 / 240;
    TrajectoryRecorder recorder;
    engines::run_scene(scene, laws(), options, recorder);
    const std::string& said = recorder.trajectory().stopped_by;
    EXPECT_NE(said.find("comes from rod"), std::string::npos) << said;
    EXPECT_EQ(said.find("(in joint coordinates; ") != std::string::npos,
              coordinates == Coordinates::kReduced)
        << said;
  }
}

TEST(JointCoordinates, OfALoopAskForTheModuleThatHasRows) {
  const scene::Scene scene = of_course("four_bar", 0.1);
  try {
    run_by(library_laws(), scene, Coordinates::kReduced, 1.0 / 480, "rd");
    FAIL() << "a loop has rows";
  } catch (const UserError& error) {
    EXPECT_NE(error.remedy().find("a3"), std::string::npos) << error.what();
  }
}

TEST(JointCoordinates, CarryALinkTwiceAsOnce) {
  // A rod beside a rod, a hinge in a hinge: the second closes a loop by rows that say what the tree
  // says already, and of whose response rounding is all that is left. The same motion but for
  // rounding, which a chain that whips multiplies by a thousand.
  for (const char* name : {"double_pendulum", "chain_8", "robot_arm"}) {
    const scene::Scene once = of_course(name, 0.8);
    scene::Scene twice = once;
    const auto double_all = [](auto& links) {
      const std::size_t count = links.size();
      for (std::size_t k = 0; k < count; ++k) {
        links.push_back(links[k]);
        links.back().name += " again";
      }
    };
    double_all(twice.effects.of<effects::RodSpec>());
    double_all(twice.effects.of<effects::JointSpec>());
    const Trajectory doubled = run(twice, Coordinates::kReduced, 1.0 / 480);
    EXPECT_GT(solves(doubled), 0u) << name << ": a loop";
    EXPECT_LT(distance(doubled, run(once, Coordinates::kReduced, 1.0 / 480)), 1e-11) << name;
  }
}

// ---- A loop, and its singular posture -----------------------------------------------------------

/// Two cranks of length a hold a coupler of the length of the ground: it moves along a circle and
/// never turns. Where the cranks lie along the ground all bars are on one line, two motions are
/// possible (the other folds the bars to an antiparallelogram), and the rows that close the loop
/// lose a rank. Angles are from the ground up.
struct Parallelogram {
  double a = 0.4, ground = 1.0, crank = 1.0, coupler = 2.0, g = 9.81;

  /// Let go with the cranks at this angle: I phi'' = -m g a cos(phi), a pendulum.
  double mass() const { return crank + coupler; }  // both cranks' halves and the coupler
  double inertia() const { return 2 * crank * a * a / 3 + coupler * a * a; }
  double acceleration(double phi) const { return -mass() * g * a * std::cos(phi) / inertia(); }
  /// By RK4 in steps of 2e-5 s, whose error is 1e-13.
  Eigen::Vector2d after(double phi, double t) const {
    const auto slope = [&](const Eigen::Vector2d& y) {
      return Eigen::Vector2d(y[1], acceleration(y[0]));
    };
    const long steps = std::lround(std::ceil(t / 2e-5));
    const double h = steps == 0 ? 0.0 : t / static_cast<double>(steps);
    Eigen::Vector2d y(phi, 0.0);
    for (long k = 0; k < steps; ++k) {
      const Eigen::Vector2d k1 = slope(y), k2 = slope(y + 0.5 * h * k1),
                            k3 = slope(y + 0.5 * h * k2), k4 = slope(y + h * k3);
      y += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    }
    return y;
  }
  scene::Scene scene(double phi, double duration) const {
    scene::Scene scene = truths::empty_scene("parallelogram", duration, 1e-9);
    effects::set_gravity(scene, {0, 0, -g});
    scene.stabilisation = scene::StabilisationSpec{};
    const Vector3d along(std::cos(phi), 0, std::sin(phi)), right(ground, 0, 0);
    const auto bar = [&](const std::string& name, double mass, double length, const Vector3d& at) {
      scene::BodySpec body = truths::point_mass(name, mass, at, Vector3d::Zero());
      const double across = mass * length * length / 12;  // thin, but for rounding
      body.inertia_body_kg_m2 = Vector3d(1e-3, across, across).asDiagonal();
      scene.bodies.push_back(body);
    };
    bar("left", crank, a, 0.5 * a * along);
    bar("right", crank, a, right + 0.5 * a * along);
    for (scene::BodySpec& body : scene.bodies)
      body.world_from_body = Quaterniond(Eigen::AngleAxisd(-phi, Vector3d::UnitY()));
    bar("coupler", coupler, ground, a * along + 0.5 * right);
    scene.effects.of<effects::JointSpec>() = {
        {"left end", effects::JointKind::kHinge, "left", "", Vector3d::Zero(), Vector3d::UnitY()},
        {"left top", effects::JointKind::kHinge, "left", "coupler", a * along, Vector3d::UnitY()},
        {"right top", effects::JointKind::kHinge, "coupler", "right", right + a * along,
         Vector3d::UnitY()},
        {"right end", effects::JointKind::kHinge, "right", "", right, Vector3d::UnitY()}};
    return scene;
  }
};

TEST(JointCoordinates, OfALoopGoThroughItsSingularPosture) {
  const Parallelogram bars;
  constexpr double kStart = 1.2;  // rad: it swings down through 0 and -pi, and back
  const scene::Scene scene = bars.scene(kStart, 2.0);
  const auto worst_of = [&](double step, Coordinates coordinates) {
    const Trajectory of = run(scene, coordinates, step);
    double worst = 0.0, turned = 0.0;
    bool passed = false;
    for (const Frame& frame : of.frames) {
      const Eigen::Vector2d exact = bars.after(kStart, frame.time);
      const Vector3d along(std::cos(exact[0]), 0, std::sin(exact[0]));
      worst = std::max(
          worst,
          (frame.poses[2].com_world - bars.a * along - Vector3d(0.5 * bars.ground, 0, 0)).norm());
      turned = std::max(turned, frame.poses[2].world_from_body.vec().norm());
      passed = passed || exact[0] < -M_PI;
    }
    EXPECT_TRUE(passed) << "both singular postures are in the run";
    EXPECT_LT(turned, 1e-7) << "the coupler of the other motion turns by half a turn";
    return worst;
  };
  const double coarse = worst_of(1.0 / 500, Coordinates::kReduced),
               fine = worst_of(1.0 / 1000, Coordinates::kReduced);
  EXPECT_LT(coarse, 1e-5);
  EXPECT_LT(fine, coarse / 4) << "the posture costs RK4 an order or two, and no more";
}

// ---- What falls freely --------------------------------------------------------------------------

/// A hub with an arm on a hinge, a bob of next to no size on a rod and a needle in a ball joint at
/// its end, thrown and turning; nothing holds it. @param closed  a rod from the bob to the arm too
scene::Scene thrown(bool closed, double g) {
  scene::Scene scene = truths::empty_scene("thrown", 0.5, 1e-9);
  if (g > 0.0) effects::set_gravity(scene, {0, 0, -g});
  scene.stabilisation = scene::StabilisationSpec{};
  const auto body = [&](const std::string& name, double mass, const Vector3d& at,
                        const Vector3d& velocity, const Vector3d& moments, const Vector3d& omega) {
    scene::BodySpec spec = truths::point_mass(name, mass, at, velocity);
    spec.inertia_body_kg_m2 = moments.asDiagonal();
    spec.omega_world_rad_s = omega;
    scene.bodies.push_back(spec);
  };
  body("hub", 2.0, {0.3, -0.2, 0.5}, {0.4, 0.1, 2.0}, {0.03, 0.04, 0.05}, {0.5, 2.0, 1.0});
  body("arm", 1.0, {0.8, -0.2, 0.5}, {0.2, 0.9, 1.5}, {0.002, 0.02, 0.021}, {0.5, 2.0, 5.0});
  body("bob", 0.5, {0.3, 0.4, 0.7}, {-1.0, 0.1, 2.0}, {1e-7, 1e-7, 1e-7}, {0.0, 0.0, 0.0});
  body("needle", 0.3, {0.0, -0.2, 0.2}, {0.4, -0.7, 2.0}, {2e-3, 2e-3, 1e-9}, {1.0, 3.0, 0.0});
  scene.effects.of<effects::JointSpec>() = {
      {"elbow", effects::JointKind::kHinge, "hub", "arm", {0.55, -0.2, 0.5}, Vector3d::UnitZ()},
      {"socket", effects::JointKind::kBall, "needle", "hub", {0.0, -0.2, 0.4}, Vector3d::UnitZ()}};
  const auto rod = [&](const std::string& a, const Vector3d& point_a) {
    effects::RodSpec spec;
    spec.name = a + " and bob";
    spec.a = {a, point_a};
    spec.b = {"bob", Vector3d::Zero()};
    for (const scene::BodySpec& body : scene.bodies)
      if (body.name == a)
        spec.length_m = (body.position_m + point_a - scene.bodies[2].position_m).norm();
    scene.effects.of<effects::RodSpec>().push_back(spec);
  };
  rod("hub", {0.0, 0.1, 0.0});
  if (closed) rod("arm", {0.2, 0.0, 0.0});
  return scene;
}

/// How far momentum, in parts of the largest, and angular momentum about the world's origin are
/// from what gravity makes of the first frame's.
double momentum_off(const scene::Scene& scene, const Trajectory& run, double g) {
  const Vector3d down(0, 0, -g);
  const Frame& first = run.frames.front();
  double mass = 0.0, worst = 0.0;
  Vector3d moments = Vector3d::Zero();  // M C
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    mass += *scene.bodies[i].mass_kg;
    moments += *scene.bodies[i].mass_kg * first.poses[i].com_world;
  }
  for (const Frame& frame : run.frames) {
    // P = P_0 + M g t, L' = M C x g
    const double t = frame.time;
    const Vector3d momentum = first.momentum_world + mass * t * down,
                   angular = first.angular_momentum_world +
                             Vector3d(moments * t + 0.5 * t * t * first.momentum_world).cross(down);
    worst = std::max(
        {worst, (frame.momentum_world - momentum).norm() / first.momentum_world.norm(),
         (frame.angular_momentum_world - angular).norm() / first.angular_momentum_world.norm()});
  }
  return worst;
}

TEST(JointCoordinates, OfWhatFallsFreelyKeepMomentumByEveryMethod) {
  // Nothing acts on the whole but gravity, so neither momentum nor angular momentum has an error
  // of truncation: rounding of 100 steps of some 30 numbers is 1e-13. Without what gives back a
  // step's rest Euler's are off by 1e-2 and RK4's by 1e-9, and without the centre's path the
  // angular momentum about the world's origin alone. A method of first order has an error in a
  // parabola, and so in the centre's path.
  for (const bool closed : {false, true})
    for (const double g : {0.0, 9.81})
      for (const Method& method : methods()) {
        if (g > 0.0 && method.order == 1.0) continue;
        Laws by = laws();
        by.integrate_step = step_of(method, method.controlled ? 1e-4 : kUnset);
        by.steps_in_units = needs_units(method);
        const scene::Scene scene = thrown(closed, g);
        EXPECT_LT(momentum_off(scene, run_by(by, scene, Coordinates::kReduced, 1.0 / 200, "rd"), g),
                  1e-12)
            << method.word << (closed ? ", a loop" : ", a tree") << ", g = " << g;
      }
}

TEST(JointCoordinates, OfWhatFallsFreelyKeepMomentumInEveryEngine) {
  for (const char* engine : {"rd", "ca", "ordered"})
    for (const bool closed : {false, true}) {
      const scene::Scene scene = thrown(closed, 9.81);
      EXPECT_LT(momentum_off(scene, run(scene, Coordinates::kReduced, 1.0 / 200, engine), 9.81),
                1e-12)
          << engine;
    }
}

TEST(JointCoordinates, OfWhatFallsFreelyAreAsAccurateAsTheMethod) {
  // What is given back is of the step's truncation: half the step brings the motion, and its
  // energy, 16 times nearer; half of that is asked for.
  for (const bool closed : {false, true}) {
    const scene::Scene scene = thrown(closed, 9.81);
    Laws precise = laws();  // RK4 turns a needle in six coordinates by 1e-2 rad even at 1/4000 s
    precise.integrate_step = step_of(method_named("fehlberg78"), 1e-13);
    precise.steps_in_units = true;
    const Trajectory fine = run_by(precise, scene, Coordinates::kMaximal, 1.0 / 400, "rd");
    const auto errors = [&](double step) {
      const Trajectory of = run(scene, Coordinates::kReduced, step);
      double energy = 0.0;
      for (const Frame& frame : of.frames)
        energy = std::max(energy, std::abs(frame.kinetic_energy + frame.potential_energy -
                                           of.frames.front().kinetic_energy -
                                           of.frames.front().potential_energy));
      return std::pair(distance(of, fine), energy);
    };
    const auto [far, lost] = errors(1.0 / 100);
    const auto [near, kept] = errors(1.0 / 200);
    // what is precise has an error of its own, of the needle's turning: 2e-9
    EXPECT_LT(far, 1e-7);
    EXPECT_LT(near, far / 8 + 1e-8);
    EXPECT_LT(kept, lost / 8);
  }
}

TEST(JointCoordinates, LeaveRodsAutomaticallyToTheModuleThatIsShown) {
  const scene::Scene scene = of_course("double_pendulum", 0.2);
  const Trajectory rows = run(scene, Coordinates::kMaximal, 1.0 / 480),
                   tree = run(scene, Coordinates::kReduced, 1.0 / 480);
  // the module's rows are what this run shows
  EXPECT_EQ(distance(run(scene, Coordinates::kAutomatic, 1.0 / 480), rows), 0.0);
  // rows of the reference, or none: not what is looked at
  Laws given = laws();
  given.rows_are_given = true;
  EXPECT_EQ(distance(run_by(given, scene, Coordinates::kAutomatic, 1.0 / 480, "rd"), tree), 0.0);
  EXPECT_GT(distance(rows, tree), 0.0) << "the two are told apart by their rounding";
  EXPECT_EQ(run_by(library_laws(), scene, Coordinates::kAutomatic, 1.0 / 480, "rd").stopped_by, "");
}

}  // namespace
}  // namespace tumble::testing::reduced_test
