// What a run notes of itself that must not be kept silent: what is kept of each kind of fault, and
// what energy is compared with.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "framework/effects/build_world.h"
#include "framework/effects/spring/spring.h"
#include "framework/engines/base/run_watch.h"
#include "framework/engines/judging/judge.h"
#include "framework/engines/stepping/energy_watch.h"
#include "tests/engines/reference_laws.h"
#include "tests/engines/scenes.h"
#include "tests/engines/watched_runs.h"

namespace tumble::testing {
namespace {

using engines::RunWatch;

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
  return told_of(scene_of(bodies, 1.0, kEarthGravity), speed, then, lift);
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
  const scene::Scene scene = scene_of(
      {ball("ball", 0.5, 1e4, Vector3d::Zero(), Vector3d::Zero()), floor}, 1.0, kEarthGravity);
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
                                1.0, kEarthGravity);
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

}  // namespace
}  // namespace tumble::testing
