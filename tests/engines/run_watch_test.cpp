// What a run must not keep to itself: links that come apart, energy from nothing, bodies that turn
// too far; and that right runs are left in peace.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/support/places.h"
#include "framework/core/random.h"
#include "framework/effects/build_world.h"
#include "framework/effects/drag/drag.h"
#include "framework/effects/joint/joint.h"
#include "framework/effects/motor/motor.h"
#include "framework/effects/point_force/point_force.h"
#include "framework/effects/rod/rod.h"
#include "framework/effects/spring/spring.h"
#include "framework/engines/base/run_watch.h"
#include "framework/engines/contact/impact_detection.h"
#include "framework/engines/events/process_world.h"
#include "framework/engines/judging/judge.h"
#include "framework/engines/stepping/energy_watch.h"
#include "framework/engines/stepping/stability.h"
#include "framework/engines/timewarp/fast_timewarp.h"
#include "framework/scene/load_scene.h"
#include "tests/engines/reference_laws.h"
#include "tests/engines/scenes.h"
#include "tests/engines/watched_runs.h"

namespace tumble::testing {
namespace {

using engines::RunWatch;

const Vector3d kGravity(0, 0, -9.81);

scene::Scene broken_scene(const std::string& name) {
  return scene::load_scene(std::filesystem::path(test::source_dir()) /
                           "tests/engines/broken_scenes" / (name + ".json"));
}

double energy(const Frame& frame) { return frame.kinetic_energy + frame.potential_energy; }

/// Largest rise of energy above the least so far, in frames. [J]
double energy_rise(const Trajectory& run) {
  double least = energy(run.frames.front()), rise = 0.0;
  for (const Frame& frame : run.frames) {
    rise = std::isfinite(energy(frame)) ? std::max(rise, energy(frame) - least)
                                        : std::numeric_limits<double>::infinity();
    least = std::min(least, energy(frame));
  }
  return rise;
}

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

// ---- The ledger --------------------------------------------------------------------------------

TEST(RunWatch, KeepsTheFirstTheWorstAndTheirNumber) {
  RunWatch watch;
  watch.note(RunWatch::Kind::kLinkOpen, "'a'", {1e-7, 1e-6, 0.1, 0.01});  // within what is allowed
  EXPECT_TRUE(watch.empty());
  watch.note(RunWatch::Kind::kLinkOpen, "'a'", {2e-6, 1e-6, 0.2, 0.01});
  RunWatch other;  // a thread's
  other.note(RunWatch::Kind::kLinkOpen, "'b'", {5e-6, 1e-6, 0.15, 0.01});
  watch.add(other);
  const auto faults = watch.faults();
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_EQ(faults[0].kind, "link_open");
  EXPECT_EQ(faults[0].count, 2u);
  EXPECT_EQ(faults[0].first_s, 0.15);
  EXPECT_EQ(faults[0].worst_s, 0.15);
  EXPECT_EQ(faults[0].worst, 5e-6);
  EXPECT_EQ(faults[0].subject, "'b' (and 1 more)");
  // half of 0.01 s
  EXPECT_NE(faults[0].remedy.find("0.005 s"), std::string::npos) << faults[0].remedy;
}

// Two driven plates that close on a box leave steps of a rounding: no step mends that.
TEST(RunWatch, NamesNoStepThatNobodyRuns) {
  const auto remedy = [](double step) {
    RunWatch watch;
    watch.note(RunWatch::Kind::kOverlapLeft, "'a' and 'b'", {2e-3, 1e-3, 0.1, step});
    return watch.faults().at(0).remedy;
  };
  EXPECT_NE(remedy(1e-4).find("a step of at most 5e-05 s"), std::string::npos) << remedy(1e-4);
  EXPECT_EQ(remedy(1e-16).find("step"), std::string::npos) << remedy(1e-16);
  EXPECT_NE(remedy(1e-16).find("more room"), std::string::npos) << remedy(1e-16);
}

// 16 times what is allowed: half of the step by the fourth root, a sixteenth where contacts make it
// go with the step itself; four fifths of that to be safe.
TEST(RunWatch, TheStepThatItNamesGoesByTheOrderOfTheError) {
  const auto remedy = [](double order) {
    RunWatch watch;
    watch.note(RunWatch::Kind::kEnergyRises, "'a'", {0.16, 0.01, 0.1, 0.01, order});
    return watch.faults().at(0).remedy;
  };
  const std::string in_flight = remedy(engines::kOrderOfMethods),
                    at_contacts = remedy(engines::kOrderAtContacts);
  EXPECT_NE(in_flight.find("0.004 s"), std::string::npos) << in_flight;
  EXPECT_EQ(in_flight.find("contacts"), std::string::npos) << in_flight;
  EXPECT_NE(at_contacts.find("0.0005 s"), std::string::npos) << at_contacts;
  EXPECT_NE(at_contacts.find("whatever the method"), std::string::npos) << at_contacts;
}

TEST(RunWatch, WhatIsNoNumberIsWorst) {
  RunWatch watch;
  watch.note(RunWatch::Kind::kContactUnsolved, "'a'", {1.0, 1e-3, 0.1, 0.01});
  watch.note(RunWatch::Kind::kContactUnsolved, "'b'", {kUnset, 1e-3, 0.2, 0.01});
  watch.note(RunWatch::Kind::kContactUnsolved, "'c'", {2.0, 1e-3, 0.3, 0.01});
  EXPECT_TRUE(std::isnan(watch.faults().at(0).worst));
}

// Threads add theirs in any order. Of two that are as bad the earlier one is named, and of one
// subject at one time the one whose step is shorter.
TEST(RunWatch, TheSumDoesNotDependOnItsOrder) {
  std::vector<RunWatch> parts(6);
  parts[0].note(RunWatch::Kind::kLinkOpen, "'b'", {2e-6, 1e-6, 0.2, 0.01});
  parts[1].note(RunWatch::Kind::kLinkOpen, "'c'", {2e-6, 1e-6, 0.1, 0.02});
  parts[2].note(RunWatch::Kind::kLinkOpen, "'a'", {2e-6, 1e-6, 0.2, 0.01});
  parts[3].note(RunWatch::Kind::kLinkOpen, "'d'", {1.5e-6, 1e-6, 0.05, 0.01});
  parts[4].note(RunWatch::Kind::kLinkOpen, "'c'", {2e-6, 1e-6, 0.1, 0.01});
  parts[5].note(RunWatch::Kind::kLinkOpen, "'c'", {2e-6, 1e-6, 0.1, 0.01, 1.0});
  std::vector<std::size_t> order{0, 1, 2, 3, 4, 5};
  do {
    RunWatch sum;
    for (const std::size_t k : order) sum.add(parts[k]);
    const RunFault fault = sum.faults().at(0);
    EXPECT_EQ(fault.subject, "'c' (and 3 more)");
    EXPECT_EQ(fault.worst_s, 0.1);
    EXPECT_EQ(fault.first_s, 0.05);
    EXPECT_EQ(fault.count, 6u);
    EXPECT_NE(fault.remedy.find("0.005 s"), std::string::npos) << fault.remedy;
  } while (std::next_permutation(order.begin(), order.end()));
}

TEST(RunWatch, DropsWhatIsNotedLater) {
  RunWatch watch;
  watch.note(RunWatch::Kind::kTurnUnresolved, "'a'", {4.0, 3.0, 0.1, 0.01});
  watch.note(RunWatch::Kind::kLinkOpen, "'a'", {2e-6, 1e-6, 0.11, 0.01});
  watch.drop_after(0.105);
  const auto faults = watch.faults();
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_EQ(faults[0].kind, "turn_unresolved");
}

// Of each subject what was said first, in any order of adding; none of it is a fault.
TEST(RunWatch, SaysOnceWhatIsNoFault) {
  RunWatch early, late;
  early.say("'a'", 0.2, "a at 0.2 s");
  early.say("'a'", 0.3, "a at 0.3 s");
  late.say("'a'", 0.4, "a at 0.4 s");
  late.say("'b'", 0.1, "b at 0.1 s");
  const std::vector<std::string> expected{"b at 0.1 s", "a at 0.2 s"};
  for (const bool is_late_first : {false, true}) {
    RunWatch sum = is_late_first ? late : early;
    EXPECT_FALSE(sum.empty());
    sum.add(is_late_first ? early : late);
    EXPECT_EQ(sum.notices(), expected);
    EXPECT_TRUE(sum.faults().empty());
    sum.drop_after(0.15);
    EXPECT_EQ(sum.notices(), std::vector<std::string>{"b at 0.1 s"});
  }
}

TEST(RunWatch, KnowsOfLargeIslandsOnlyWhereTheirStepsStand) {
  RunWatch watch, other;
  other.note_large_island(0.2);
  EXPECT_FALSE(other.empty());
  watch.add(other);
  EXPECT_TRUE(watch.has_large_islands());
  watch.drop_after(0.2);
  EXPECT_TRUE(watch.has_large_islands());
  watch.drop_after(0.1);
  EXPECT_FALSE(watch.has_large_islands());
  EXPECT_TRUE(watch.empty());
}

TEST(RunWatch, AFaultIsACheckThatFailed) {
  scene::Scene scene = scene_of({ball("ball", 0.1, 1.0, Vector3d::Zero(), Vector3d::Zero())}, 0.1);
  Trajectory run = run_by("rd", scene);
  EXPECT_TRUE(engines::judge_run(scene, run).empty());
  run.counters.faults.push_back(
      {"link_open", "'wire'", 0.5, 1e-6, "", 0.1, 0.2, 3, "meaning", "remedy"});
  const auto checks = engines::judge_run(scene, run);
  ASSERT_EQ(checks.size(), 1u);
  EXPECT_FALSE(checks[0].passed);
  EXPECT_NE(checks[0].detail.find("first at t = 0.1 s, 3 times in all"), std::string::npos)
      << checks[0].detail;
}

// ---- What energy is compared with --------------------------------------------------------------

/// What is told of a scene whose first body moves sideways first at one speed, then at another, and
/// has gone `lift` up between two looks 1/60 s apart. @param contacts  at each of them
std::vector<RunFault> told_of(const scene::Scene& scene, double speed, double then, double lift,
                              const std::vector<ContactPoint>& contacts = {}) {
  const World world = build_world(scene);
  const auto states = [&](double up, double v) {
    std::vector<RigidBodyState> all;
    for (const WorldBody& body : world.bodies) all.push_back(body.state);
    all[0].com_world.z() += up;
    all[0].momentum_world.x() = world.bodies[0].inertia.mass * v;
    return all;
  };
  engines::EnergyWatch watch(1e-5, 1.0 / 60, true);  // a rest speed far below what moves here
  EXPECT_FALSE(watch.look(0.0, world, states(0.0, speed), contacts));
  EXPECT_FALSE(watch.look(1.0 / 60, world, states(0.0, speed), contacts));
  EXPECT_FALSE(watch.look(2.0 / 60, world, states(lift, then), contacts));
  engines::RunCounters counters;
  watch.tell(world, reference_laws(), counters);
  return counters.watch.faults();
}

/// The same of a ball at a height.
std::vector<RunFault> told_of_ball(double radius, double mass, double height, double speed,
                                   double then, double lift,
                                   const std::vector<scene::BodySpec>& others = {}) {
  std::vector<scene::BodySpec> bodies{ball("ball", radius, mass, {0, 0, height}, Vector3d::Zero())};
  bodies.insert(bodies.end(), others.begin(), others.end());
  return told_of(scene_of(bodies, 1.0, kGravity), speed, then, lift);
}

// 10 t that move with 50 J and then with 60: a thousandth of their weight over their size would be
// 31 J.
TEST(EnergyRises, IsComparedWithWhatMovesNotWithWeight) {
  EXPECT_EQ(told_of_ball(0.5, 1e4, 0.0, 0.1, 0.1, 0.0).size(), 0u);
  ASSERT_EQ(told_of_ball(0.5, 1e4, 0.0, 0.1, 0.11, 0.0).size(), 1u);
  EXPECT_EQ(told_of_ball(0.5, 1e4, 0.0, 0.1, 0.11, 0.0)[0].kind, "energy_rises");
}

// The same wherever its heights are counted from, up to where they are rounded to more than it
// moves by: a million kilometres up to 1.2e-7 m.
TEST(EnergyRises, IsNotHiddenByAFarOriginNorMadeByItsRounding) {
  EXPECT_EQ(told_of_ball(0.5, 1e4, 1e4, 0.1, 0.11, 0.0).size(), 1u);
  EXPECT_EQ(told_of_ball(1e-3, 1e-3, 1e9, 1e-3, 1e-3, std::nextafter(1e9, 2e9) - 1e9).size(), 0u);
}

ContactPoint contact_of(int a, int b) {
  return {a, b, Vector3d::Zero(), Vector3d::UnitZ(), Vector3d(0, 0, 9.81)};
}

// What is driven gives energy to what it touches, and to nothing else; a law of its own that moves
// nothing drives nothing: an amplitude without a frequency.
TEST(EnergyRises, IsToldBesideADrivenBodyThatTouchesNothing) {
  scene::BodySpec floor = ball("floor", 1.0, 1.0, {0, 0, -9}, Vector3d::Zero());
  floor.mass_kg.reset();
  floor.immovable = true;
  floor.motion.emplace();
  floor.motion->amplitude_m = {0, 0, 0.1};
  for (const double frequency : {0.0, 5.0}) {
    floor.motion->angular_frequency_rad_s = frequency;
    EXPECT_EQ(told_of_ball(0.5, 1e4, 0.0, 0.1, 0.11, 0.0, {floor}).size(), 1u) << frequency;
  }
  const scene::Scene scene =
      scene_of({ball("ball", 0.5, 1e4, Vector3d::Zero(), Vector3d::Zero()), floor}, 1.0, kGravity);
  EXPECT_EQ(told_of(scene, 0.1, 0.11, 0.0, {contact_of(0, 1)}).size(), 0u);
}

bool speaks_of_contacts(const std::vector<RunFault>& faults) {
  return faults.at(0).remedy.find("contacts") != std::string::npos;
}

// A rise goes with the step itself where contacts act on the body that has it: contacts of others
// say nothing of it, but for those of what it is linked with.
TEST(EnergyRises, GoWithTheStepItselfOnlyOfBodiesAtContacts) {
  constexpr int kBall = 0, kBox = 1, kFloor = 2;
  scene::Scene scene = scene_of({ball("ball", 0.5, 1e4, {0, 0, 2}, Vector3d::Zero()),
                                 box("box", {0.1, 0.1, 0.1}, 1.0, {3, 0, 0.1}, Vector3d::Zero()),
                                 plane("floor", Vector3d::Zero(), Vector3d::UnitZ())},
                                1.0, kGravity);
  const auto told = [&](const std::vector<ContactPoint>& contacts) {
    return told_of(scene, 0.1, 0.11, 0.0, contacts);
  };
  ASSERT_EQ(told({}).size(), 1u);
  EXPECT_FALSE(speaks_of_contacts(told({})));
  EXPECT_FALSE(speaks_of_contacts(told({contact_of(kBox, kFloor)})));
  EXPECT_TRUE(speaks_of_contacts(told({contact_of(kBox, kFloor), contact_of(kBall, kFloor)})));
  effects::SpringSpec spring;
  spring.name = "spring";
  spring.a.body = "ball";
  spring.b.body = "box";
  spring.stiffness_n_m = 1.0;
  spring.rest_length_m = 3.0;
  scene.effects.of<effects::SpringSpec>().push_back(spring);
  EXPECT_TRUE(speaks_of_contacts(told({contact_of(kBox, kFloor)})));
}

// ---- Runs that cannot be trusted ---------------------------------------------------------------

/// A light bob on a rod above one `ratio` times as heavy, held out sideways. Rods of 1 m. The seed
/// draws the angles.
scene::Scene light_above_heavy(double ratio, unsigned seed) {
  const double upper = 0.6 + 0.05 * (seed % 9), lower = 1.1 + 0.04 * (seed % 7);
  const Vector3d first(std::sin(upper), 0, -std::cos(upper)),
      second = first + Vector3d(std::sin(lower), 0, -std::cos(lower));
  scene::Scene scene = scene_of({ball("light", 0.0, 1.0, first, Vector3d::Zero()),
                                 ball("heavy", 0.0, ratio, second, Vector3d::Zero())},
                                1.0, kGravity);
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
      scene_of({ball("bob", 0.0, 1.0, {1, 0, 0}, Vector3d::Zero())}, 2.0, kGravity);
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
// method makes beside it is. The first step counts.
TEST(RunWatch, WhatAForceBringsInIsNoFault) {
  scene::Scene scene =
      scene_of({ball("ball", 0.1, 1.0, {1, 0, 0}, Vector3d::Zero())}, 1.0, Vector3d::Zero());
  effects::SpringSpec spring;
  spring.a.body = "ball";
  spring.b.point_m = Vector3d(0, 0, 0);
  spring.stiffness_n_m = 100.0;
  spring.rest_length_m = 0.5;
  scene.effects.of<effects::SpringSpec>().push_back(spring);
  scene.effects.of<effects::PointForceSpec>().push_back({"ball", {50, 0, 0}, {1, 0, 0}, 0.0, 0.5});
  scene.step_s = 0.01;
  EXPECT_FALSE(has_fault(run_by("rd", scene), "energy_rises"));
  Laws laws = reference_laws();
  laws.integrate_step = [](const OdeFunction& f, double t, const VectorXd& y,
                           double h) -> VectorXd { return y + h * f(t, y); };
  // (w h)^2 / 2 = 0.5 % of the swing a step
  EXPECT_TRUE(has_fault(run_by("rd", scene, laws), "energy_rises"));
  laws.integrate_step = [](const OdeFunction& f, double t, const VectorXd& y,
                           double h) -> VectorXd {
    const Laws right = reference_laws();
    const VectorXd next = right.integrate_step(f, t, y, h);
    return t == 0.0 ? VectorXd(next + 2.0 * (next - y)) : next;
  };
  scene.effects.of<effects::PointForceSpec>().clear();
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
                                1.0, kGravity);
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
               2.0, kGravity);
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
  scene::Scene scene = scene_of({}, 1.5, kGravity);
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
                   0.6, kGravity);
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

// ---- Contacts dealt with in the step give no energy --------------------------------------------

// Boxes that touch along edges, one of which a medium slows: what draws them apart is no velocity.
TEST(InStep, NoEnergyComesOfPositionCorrections) {
  for (const char* name :
       {"in_step_exit0", "in_step_explodes", "min_471_runaway", "min_195_energy"}) {
    const scene::Scene scene = broken_scene(name);
    for (const std::string& engine : {std::string("rd"), std::string("ordered")}) {
      const Trajectory run = run_by(engine, scene);
      double scale = run.frames.front().kinetic_energy,
             lowest = run.frames.front().potential_energy;
      for (const Frame& frame : run.frames) lowest = std::min(lowest, frame.potential_energy);
      scale += run.frames.front().potential_energy - lowest;
      // A tenth is what steps of 1/60 s leave of a tipping box; more is told.
      EXPECT_TRUE(energy_rise(run) < 0.1 * scale || has_fault(run, "energy_rises") ||
                  !run.stopped_by.empty())
          << name << ' ' << engine << ": " << energy_rise(run) << " J" << said(run);
      EXPECT_LT(energy_rise(run), 0.1 * scale) << name << ' ' << engine << said(run);
    }
  }
}

/// Boxes of 1 m that touch along faces and edges, where a lattice drawn by lot has them, one of
/// them slowed by a medium, one with a velocity.
scene::Scene touching_boxes(unsigned seed) {
  Random random(seed);
  scene::Scene scene =
      scene_of({plane("floor", Vector3d::Zero(), Vector3d::UnitZ())}, 1.0, kGravity);
  scene.bodies[0].friction = 0.5 * (seed % 2);
  for (int x = 0; x < 2; ++x)
    for (int y = 0; y < 2; ++y)
      for (int z = 0; z < 2; ++z) {
        if (random.between(0.0, 1.0) < 0.4 && !(x == 0 && y == 1 && z == 0)) continue;
        scene::BodySpec body =
            box(fmt::format("b{}{}{}", x, y, z), Vector3d::Constant(0.5), random.between(0.5, 2.0),
                Vector3d(x, y, z + 0.5) * (1 + 1e-12), Vector3d::Zero());
        body.restitution = 0.0;
        body.friction = random.between(0.0, 1.0);
        scene.bodies.push_back(body);
      }
  for (double& velocity : scene.bodies.back().velocity_m_s) velocity = random.between(-0.5, 0.3);
  scene.contact.emplace();
  scene.contact->plastic_impacts = scene::PlasticImpacts::kInStep;
  scene.effects.of<effects::DragSpec>().push_back(
      {scene.bodies[1].name, random.between(0.0, 0.2), 0.0});
  scene.step_s = seed % 3 == 0 ? 1.0 / 1000 : 1.0 / 60;
  return scene;
}

TEST(InStep, BoxesThatTouchByLotGainNothing) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const scene::Scene scene = touching_boxes(seed);
    const Trajectory run = run_by("rd", scene);
    double lowest = run.frames.front().potential_energy;
    for (const Frame& frame : run.frames) lowest = std::min(lowest, frame.potential_energy);
    // J: they may settle a centimetre
    const double scale =
        run.frames.front().kinetic_energy + run.frames.front().potential_energy - lowest + 0.1;
    EXPECT_LT(energy_rise(run), 0.1 * scale) << seed << said(run);
  }
}

// A lid that comes down on a ball on the floor farther than the ball is high: no place is left for
// it.
TEST(RunWatch, ABodyThatIsLeftInAnotherIsNeverKeptSilent) {
  for (const double restitution : {0.0, 0.5}) {
    scene::Scene scene = scene_of({plane("floor", Vector3d::Zero(), Vector3d::UnitZ()),
                                   plane("lid", {0, 0, 0.25}, -Vector3d::UnitZ()),
                                   ball("ball", 0.1, 1.0, {0, 0, 0.1}, Vector3d::Zero())},
                                  1.0, kGravity);
    for (scene::BodySpec& body : scene.bodies) body.restitution = restitution;
    scene.bodies[1].motion.emplace();
    scene.bodies[1].motion->velocity_m_s = {0, 0, -0.1};
    scene.contact.emplace();
    const Trajectory run = run_by("rd", scene);
    double deepest = 0.0;
    for (const Frame& frame : run.frames) deepest = std::min(deepest, frame.smallest_gap);
    EXPECT_TRUE(deepest > -1e-3 * 0.1 || !run.stopped_by.empty() || !run.counters.faults.empty())
        << restitution << ": " << deepest << " m";
  }
}

/// What is told of a ball of 0.1 m that touches the floor where a lid hangs this high, after places
/// were corrected; of another one beside it, that far above the floor.
std::vector<RunFault> told_under_a_lid(double lid_m, double other_m) {
  const Laws laws = reference_laws();
  engines::RunCounters counters;
  engines::MovingWorld moving(
      build_world(scene_of({plane("floor", Vector3d::Zero(), Vector3d::UnitZ()),
                            plane("lid", {0, 0, lid_m}, -Vector3d::UnitZ()),
                            ball("ball", 0.1, 1.0, {0, 0, 0.1}, Vector3d::Zero()),
                            ball("other", 0.1, 1.0, {5, 0, other_m}, Vector3d::Zero())},
                           1.0)),
      laws, counters);
  engines::ImpactDetection detection(moving, laws, counters);
  detection.separate({{0, 2}, {0, 3}, {1, 2}, {2, 3}});
  return counters.watch.faults();
}

// Room for three quarters of its diameter: the last round leaves it off the lid, and half a radius
// deep in the floor. The other ball is in nothing.
TEST(RunWatch, ABallBetweenPlanesNearerThanItsDiameterIsAnOverlapLeft) {
  const std::vector<RunFault> faults = told_under_a_lid(0.15, 0.3);
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_EQ(faults[0].kind, "overlap_left");
  EXPECT_EQ(faults[0].subject, "'floor' and 'ball'");
  EXPECT_EQ(faults[0].count, 1u);
  EXPECT_NEAR(faults[0].worst, 0.5, 1e-9);  // spacings of a coordinate, a few a round
  EXPECT_TRUE(told_under_a_lid(0.2001, 0.3).empty());
  EXPECT_TRUE(told_under_a_lid(0.2001, 0.05).empty());  // it has room to be moved to
}

// The same ball as a process that meets the floor: a run counts the note where it commits that.
TEST(RunWatch, WhatAnImpactOfAProcessNotesIsPartOfItsResult) {
  scene::Scene scene = scene_of({plane("floor", Vector3d::Zero(), Vector3d::UnitZ()),
                                 plane("lid", {0, 0, 0.15}, -Vector3d::UnitZ()),
                                 ball("ball", 0.1, 1.0, {0, 0, 0.1}, Vector3d::Zero())},
                                1.0);
  scene.contact.emplace();
  const World world = build_world(scene);
  std::vector<collision::CollisionShape> shapes;
  for (const WorldBody& body : world.bodies) shapes.emplace_back(body.shape);
  const Laws laws = reference_laws();
  const engines::EntriesByBody entries(world);
  engines::RunCounters counters;
  constexpr int kFloor = 0, kLid = 1, kBall = 2;
  engines::ProcessWorld process(
      world, entries, [&](int body) { return &shapes[static_cast<std::size_t>(body)]; }, laws,
      {scene.step_s, scene.rest_speed_m_s}, counters, {kBall}, {kFloor, kLid});
  engines::ProcessState state;
  state.members = {kBall};
  state.states = {world.bodies[kBall].state};
  for (int again = 0; again < 2; ++again) {  // as after a rollback
    const engines::ProcessWorld::Change change = process.collide({kFloor, kBall}, state);
    ASSERT_TRUE(change.noted);
    EXPECT_EQ(change.noted->faults().at(0).kind, "overlap_left");
    EXPECT_EQ(change.noted->faults().at(0).count, 1u);
  }
  EXPECT_TRUE(counters.watch.empty());
}

TEST(RunWatch, AnOverlapThatNoPictureShowsIsNotNoted) {
  constexpr double kShown = engines::kApart * 0.1;  // m, of this ball
  EXPECT_TRUE(told_under_a_lid(0.2 - 0.5 * kShown, 0.3).empty());
  EXPECT_EQ(told_under_a_lid(0.2 - 2.0 * kShown, 0.3).size(), 1u);
}

TEST(RunWatch, AnOverlapThatIsLeftIsNamedWithoutAStep) {
  RunWatch watch;  // no step would part them
  watch.note(RunWatch::Kind::kOverlapLeft, "'lid' and 'ball'", {0.5, engines::kApart, 0.1, 0.0});
  const auto faults = watch.faults();
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_EQ(faults[0].kind, "overlap_left");
  EXPECT_EQ(faults[0].remedy.find("step_s"), std::string::npos) << faults[0].remedy;
  EXPECT_NE(faults[0].remedy.find("room"), std::string::npos) << faults[0].remedy;
}

// ---- What is shown does not overlap ------------------------------------------------------------

/// Two small boxes that fall on a plate and on each other, turned by lot.
scene::Scene falling_boxes(unsigned seed) {
  Random random(seed);
  scene::Scene scene = scene_of(
      {box("plate", {0.3, 0.3, 0.005}, 1.0, {0, 0, -0.005}, Vector3d::Zero())}, 0.5, kGravity);
  scene.bodies[0].immovable = true;
  for (int k = 0; k < 3; ++k) {
    const double aside = random.between(-0.005, 0.005);
    scene::BodySpec body =
        box(fmt::format("b{}", k), Vector3d::Constant(0.008), 0.01,
            {aside, random.between(-0.005, 0.005), 0.03 + 0.03 * k}, Vector3d::Zero());
    body.restitution = k == 0 ? 0.3 : 0.0;
    for (double& part : body.world_from_body.coeffs()) part = random.between(-1.0, 1.0);
    body.world_from_body.normalize();
    scene.bodies.push_back(body);
  }
  scene.contact.emplace();
  if (seed % 2 == 0) scene.contact->plastic_impacts = scene::PlasticImpacts::kInStep;
  scene.step_s = 1.0 / 30;  // every second picture lies within a step
  return scene;
}

TEST(ShownWithinAStep, NothingOverlaps) {
  for (unsigned seed = 1; seed <= 4; ++seed)
    for (const std::string& engine : {std::string("ca"), std::string("ordered")}) {
      const Trajectory run = run_by(engine, falling_boxes(seed));
      for (const Frame& frame : run.frames)
        ASSERT_GE(frame.smallest_gap, 0.0) << engine << " seed " << seed << " at " << frame.time;
    }
}

// ---- What lies on a body weighs on its links ---------------------------------------------------

scene::BodySpec slab(const std::string& name, const Vector3d& half, double mass, const Vector3d& at,
                     double friction = 0.0) {
  scene::BodySpec body = box(name, half, mass, at, Vector3d::Zero());
  body.restitution = 0.0;
  body.friction = friction;
  return body;
}

scene::Scene at_rest(std::vector<scene::BodySpec> bodies) {
  scene::Scene scene = scene_of(std::move(bodies), 0.3, kGravity);
  scene.contact.emplace();
  scene.stabilisation.emplace();
  scene.step_s = 0.005;
  return scene;
}

/// Of one newton: contacts at rest are solved to the last digits, and bodies settle over shells of
/// 1e-10 m.
constexpr double kForce = 1e-5;

TEST(LinkForces, ARodHoldsWhatLiesOnItsBlock) {
  scene::Scene scene = at_rest({slab("block", {0.3, 0.3, 0.05}, 4.0, {0, 0, 1}),
                                slab("box", {0.1, 0.1, 0.1}, 1.0, {0, 0, 1.15}),
                                slab("second", {0.05, 0.05, 0.05}, 2.0, {0, 0, 1.30})});
  scene.effects.of<effects::RodSpec>().push_back(
      {"rod", {"", Vector3d(0, 0, 2)}, {"block", Vector3d(0, 0, 0.05)}, 0.95});
  for (const std::string& engine : kEngines)
    EXPECT_NEAR(run_by(engine, scene).frames.back().rod_tensions.at(0), 7.0 * 9.81, kForce)
        << engine;
  scene.bodies.pop_back();
  for (const std::string& engine : kEngines)
    EXPECT_NEAR(run_by(engine, scene).frames.back().rod_tensions.at(0), 5.0 * 9.81, kForce)
        << engine;
}

TEST(LinkForces, AWeldHoldsABoxThatStandsOnASlope) {
  const double angle = 20 * std::numbers::pi / 180;
  const Vector3d normal(std::sin(angle), 0, std::cos(angle));
  scene::Scene scene = at_rest({slab("shelf", {0.4, 0.4, 0.05}, 3.0, Vector3d::Zero(), 0.8),
                                slab("box", {0.1, 0.1, 0.1}, 1.5, 0.15 * normal, 0.8)});
  for (scene::BodySpec& body : scene.bodies)
    body.world_from_body = Quaterniond(Eigen::AngleAxisd(angle, Vector3d::UnitY()));
  scene.effects.of<effects::JointSpec>().push_back(
      {"weld", effects::JointKind::kWeld, "shelf", "", Vector3d::Zero(), Vector3d::UnitZ()});
  // Friction and the normal force add up to the box's weight.
  for (const std::string& engine : kEngines)
    EXPECT_NEAR(run_by(engine, scene).frames.back().joint_forces.at(0), 4.5 * 9.81, kForce)
        << engine;
}

// Moments about the hinge: the rod at the far end holds half of the beam and its share of the box.
TEST(LinkForces, AHingeAndARodShareABoxByItsLever) {
  const double half = 0.5, lever = 0.8;
  scene::Scene scene = at_rest({slab("beam", {half, 0.1, 0.02}, 2.0, {half, 0, 0}),
                                slab("box", {0.05, 0.05, 0.05}, 1.0, {lever, 0, 0.07})});
  scene.effects.of<effects::JointSpec>().push_back(
      {"hinge", effects::JointKind::kHinge, "beam", "", Vector3d::Zero(), Vector3d::UnitY()});
  scene.effects.of<effects::RodSpec>().push_back(
      {"rod", {"", Vector3d(2 * half, 0, 1)}, {"beam", Vector3d(half, 0, 0)}, 1.0});
  for (const std::string& engine : kEngines) {
    const Frame frame = run_by(engine, scene).frames.back();
    const double rod = 9.81 * (2.0 * half + 1.0 * lever) / (2 * half);
    EXPECT_NEAR(frame.rod_tensions.at(0), rod, kForce) << engine;
    EXPECT_NEAR(frame.joint_forces.at(0), 3.0 * 9.81 - rod, kForce) << engine;
  }
}

// ---- By what a contact was solved --------------------------------------------------------------

scene::Scene box_on_a_floor(double friction) {
  scene::BodySpec floor = plane("floor", Vector3d::Zero(), Vector3d::UnitZ());
  floor.friction = friction;
  return at_rest({floor, slab("box", {0.1, 0.1, 0.1}, 1.0, {0, 0, 0.1}, friction)});
}

// Neither what rubs nor what a rod holds is a matter of contact_forces. The rod lies level, so that
// the floor bears the box.
TEST(ContactPoints, SayWhetherContactForcesFoundThem) {
  scene::Scene on_a_rod = box_on_a_floor(0.0);
  on_a_rod.effects.of<effects::RodSpec>().push_back(
      {"rod", {"", Vector3d(1, 0, 0.1)}, {"box", Vector3d::Zero()}, 1.0});
  for (const auto& [scene, expected] :
       {std::pair{box_on_a_floor(0.0), true}, {box_on_a_floor(0.5), false}, {on_a_rod, false}})
    for (const std::string& engine : kEngines) {
      const Trajectory run = run_by(engine, scene);
      ASSERT_FALSE(run.frames.back().contacts.empty()) << engine << said(run);
      for (const ContactPoint& contact : run.frames.back().contacts)
        EXPECT_EQ(contact.by_contact_forces, expected) << engine;
    }
}

// What is said of a box whose energy has run away, with one contact that pushes it.
std::string said_of_runaway(bool by_contact_forces, const Laws& laws) {
  const World world = build_world(box_on_a_floor(0.0));
  const std::vector<RigidBodyState> states{world.bodies[0].state, world.bodies[1].state};
  const std::vector<ContactPoint> contacts{
      {1, 0, Vector3d::Zero(), Vector3d::UnitZ(), Vector3d(0, 0, 9.81), by_contact_forces}};
  const engines::LinkForces links(world);
  return engines::runaway_message(0.1, world, {1, 100.0, 1.0, 0.0}, {states, links, contacts},
                                  laws);
}

TEST(Runaway, NamesContactForcesOnlyWhereTheyWereAsked) {
  Laws laws = reference_laws();
  laws.constraint_source = "a3 student";
  const std::string theirs = said_of_runaway(true, laws), ours = said_of_runaway(false, laws);
  EXPECT_NE(theirs.find("'floor' (contact_forces of a3 student)"), std::string::npos) << theirs;
  EXPECT_NE(ours.find("'floor' (impulses of the framework)"), std::string::npos) << ours;
  EXPECT_EQ(ours.find("a3 student"), std::string::npos) << ours;
}

}  // namespace
}  // namespace tumble::testing
