// Bodies that lie, slide, roll, tip, are stacked and hit each other with friction: against closed
// forms, statics and conservation.
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "framework/core/random.h"
#include "framework/core/error.h"
#include "framework/effects/rod/rod.h"
#include "framework/effects/spring/spring.h"
#include "tests/engines/reference_laws.h"
#include "tests/engines/scenes.h"

namespace tumble::testing {
namespace {

constexpr double kG = 9.81;
const Vector3d kGravity(0, 0, -kG);

scene::BodySpec rough(scene::BodySpec body, double friction, double restitution = 0.0) {
  body.friction = friction;
  body.restitution = restitution;
  return body;
}

scene::Scene with_contact(std::vector<scene::BodySpec> bodies, double duration,
                          std::optional<Vector3d> gravity = kGravity) {
  scene::Scene scene = scene_of(std::move(bodies), duration, gravity);
  scene.contact.emplace();
  return scene;
}

Trajectory run_it(const scene::Scene& scene) {
  const Trajectory result = run(scene, reference_laws());
  EXPECT_EQ(result.stopped_by, "");
  for (const Frame& frame : result.frames)
    EXPECT_GE(frame.smallest_gap, 0.0) << "t = " << frame.time;
  return result;
}

double energy(const Frame& frame) { return frame.kinetic_energy + frame.potential_energy; }
scene::BodySpec floor_of(double friction) {
  return rough(plane("floor", Vector3d::Zero(), Vector3d::UnitZ()), friction);
}

/// A board that stands on an edge, 0.3 rad out of the vertical, and tips over it.
scene::Scene tipping_board(double step) {
  const Vector3d half(0.02, 0.1, 0.2);
  auto board = rough(box("board", half, 0.5, Vector3d::Zero(), Vector3d::Zero()), 0.8);
  board.world_from_body = Quaterniond(Eigen::AngleAxisd(0.3, Vector3d::UnitY()));
  board.position_m.z() = half.x() * std::sin(0.3) + half.z() * std::cos(0.3);
  scene::Scene scene = with_contact({board, floor_of(0.8)}, 1.0);
  scene.step_s = step;
  return scene;
}

/// A block that slides down a slope at 3 m/s.
scene::Scene slope(double angle, double friction) {
  const Vector3d normal(std::sin(angle), 0, std::cos(angle)),
      down(std::cos(angle), 0, -std::sin(angle));
  auto block = rough(box("block", {0.1, 0.1, 0.05}, 1.0, 0.05 * normal, 3.0 * down), friction);
  auto ramp = rough(plane("ramp", Vector3d::Zero(), normal), friction);
  block.world_from_body = ramp.world_from_body =
      Quaterniond(Eigen::AngleAxisd(angle, Vector3d::UnitY()));
  return with_contact({block, ramp}, 4.0);
}

TEST(PersistentContacts, ABlockSlidesStopsAndStays) {
  const double angle = 20 * std::numbers::pi / 180, friction = 0.5,
               deceleration = kG * (friction * std::cos(angle) - std::sin(angle));
  const scene::Scene scene = slope(angle, friction);
  const Trajectory result = run_it(scene);
  // Constant forces are followed exactly and the end of sliding is located: 1e3 roundings of 3.6 m.
  EXPECT_NEAR((result.frames.back().poses[0].com_world - scene.bodies[0].position_m).norm(),
              9.0 / (2 * deceleration), 1e-12);
  // the solver's tolerance, 1e-12, of g h = 0.16 m/s, with room
  EXPECT_LT(result.frames.back().poses[0].velocity_world.norm(), 1e-12);
  double push = 0.0;
  for (const ContactPoint& contact : result.frames.back().contacts)
    push += contact.force_on_a_world.z();
  // what holds it is its weight; tolerance of the solver 1e-12, times ten forces
  EXPECT_NEAR(push, kG, 1e-10);
}

TEST(PersistentContacts, ABlockTooSteepKeepsSliding) {
  const double angle = 30 * std::numbers::pi / 180, friction = 0.2,
               acceleration = kG * (std::sin(angle) - friction * std::cos(angle));
  const scene::Scene scene = slope(angle, friction);
  const Trajectory result = run_it(scene);
  EXPECT_NEAR((result.frames.back().poses[0].com_world - scene.bodies[0].position_m).norm(),
              3.0 * 4 + 0.5 * acceleration * 16, 1e-10);
}

// Decimals of a file leave gaps of a part of 1e-6 of a body between what is meant to lie on each
// other. The path is that of bodies that touch, but for as much: a first step to a straight line
// would be off by a h^2 / 2 = 2e-4 m.
TEST(PersistentContacts, AGapOfRoundingAtTheStartChangesAMotionByNoMoreThanItself) {
  const double angle = 25 * std::numbers::pi / 180, friction = 0.3,
               acceleration = kG * (std::sin(angle) - friction * std::cos(angle));
  for (const double gap : {3e-10, 1e-9, 1e-8, 3e-8, 1e-7}) {
    scene::Scene scene = slope(angle, friction);
    scene.duration_s = 1.0;
    const Vector3d normal = scene.bodies[1].world_from_body * Vector3d::UnitZ();
    const Vector3d resting = scene.bodies[0].position_m;
    scene.bodies[0].position_m += gap * normal;
    scene.bodies[0].velocity_m_s = Vector3d::Zero();
    scene.bodies[0].friction = 1.0;           // the ramp's counts, and the rider sticks
    scene.bodies.push_back(scene.bodies[0]);  // on top, as far from it
    scene.bodies.back().name = "rider";
    scene.bodies.back().position_m += (0.1 + gap) * normal;
    const Trajectory result = run_it(scene);
    const double rider_rests = 0.1;  // m, above the block
    for (const auto& [body, height] : {std::pair{0, 0.0}, std::pair{2, rider_rests}}) {
      const Vector3d way = result.frames.back().poses[body].com_world - resting - height * normal;
      EXPECT_NEAR(way.dot(normal), 0.0, 1e-10) << gap;
      // two gaps close, one after the other in two steps or three; the path's rounding
      EXPECT_NEAR(way.norm(), 0.5 * acceleration, 4 * gap + 1e-11) << gap << ' ' << body;
    }
  }
}

TEST(PersistentContacts, ASlidingBallRollsWithFiveSeventhsOfItsSpeed) {
  const Trajectory result = run_it(with_contact(
      {rough(ball("ball", 0.2, 1.0, {0, 0, 0.2}, {7, 0, 0}), 0.3), floor_of(0.3)}, 2.0));
  EXPECT_NEAR(result.frames.back().poses[0].velocity_world.x(), 5.0, 1e-12);
  EXPECT_NEAR(result.frames.back().poses[0].omega_world.y(), 25.0, 1e-11);
  const double rolls_at = 2.0 / (0.3 * kG);  // (7 - 5) / (mu g)
  EXPECT_NEAR(result.frames.back().poses[0].com_world.x(), 6.0 * rolls_at + 5.0 * (2.0 - rolls_at),
              1e-11);
}

TEST(PersistentContacts, AStackOfTenStaysAndItsFloorCarriesIt) {
  std::vector<scene::BodySpec> bodies;
  for (int i = 0; i < 10; ++i)
    bodies.push_back(rough(
        box("box " + std::to_string(i), {0.5, 0.5, 0.5}, 1.0, {0, 0, 0.5 + i}, Vector3d::Zero()),
        0.5));
  bodies.push_back(floor_of(0.5));
  const Trajectory result = run_it(with_contact(bodies, 10.0));
  const BodyPose& top = result.frames.back().poses[9];
  // GOALS: 1e-6 m at 1/60 s; ten shells of 1e-10 are 1e-9
  EXPECT_LT((top.com_world - Vector3d(0, 0, 9.5)).norm(), 1e-6);
  double carried = 0.0;
  for (const ContactPoint& contact : result.frames.back().contacts)
    if (contact.body_b == 10) carried += contact.force_on_a_world.z();
  EXPECT_NEAR(carried, 10 * kG, 1e-6 * 10 * kG);
  EXPECT_LT(result.frames.back().kinetic_energy / 10, 1e-8);
}

// Nothing holds these boxes sideways: a normal of a contact that is off by 1e-3 rad for one step
// moves them by millimetres.
TEST(PersistentContacts, AFrictionlessStackStaysHoweverTheWorldLies) {
  Random random(31);
  for (int k = 0; k < 12; ++k) {
    const Vector3d axis(random.unit() - 0.5, random.unit() - 0.5, random.unit() - 0.5);
    const Quaterniond turn(Eigen::AngleAxisd(3.0 * random.unit(), axis.normalized()));
    const Vector3d up = turn * Vector3d::UnitZ();
    std::vector<scene::BodySpec> bodies{rough(plane("floor", Vector3d::Zero(), up), 0.0)};
    for (int i = 0; i < 2 + k % 4; ++i)
      bodies.push_back(rough(box("box " + std::to_string(i), Vector3d::Constant(0.2), 1.0,
                                 (0.2 + 0.4 * i) * up, Vector3d::Zero()),
                             0.0));
    for (scene::BodySpec& body : bodies) body.world_from_body = turn;
    scene::Scene scene = with_contact(bodies, 4.0, -kG * up);
    scene.step_s = 1.0 / 64;
    const Trajectory result = run_it(scene);
    for (std::size_t i = 1; i < bodies.size(); ++i)
      // six shells of 1e-10 m, and what rounding of the normals makes of 4 s: 9.81 * 16 / 2 * 1e-15
      EXPECT_LT((result.frames.back().poses[i].com_world - bodies[i].position_m).norm(), 1e-9)
          << "draw " << k << ", box " << i;
  }
}

// A board that tips over its edge keeps its energy until its face comes down: friction that sticks
// does no work. What is read of 1000000.1 is 2e-11 less: boxes that were written to touch do not
// begin in each other.
TEST(PersistentContacts, ATowerWrittenAThousandKilometresAwayStandsAsItWasWritten) {
  struct Place {
    double ground, middles[3];
  };
  for (const Place& z : {Place{0, {0.1, 0.3, 0.5}}, Place{1e6, {1000000.1, 1000000.3, 1000000.5}},
                         Place{-1e6, {-999999.9, -999999.7, -999999.5}}}) {
    const double x = 2 * z.ground;
    scene::Scene scene =
        with_contact({rough(plane("floor", {x, 0, z.ground}, Vector3d::UnitZ()), 0.5)}, 1.0);
    for (int k = 0; k < 3; ++k)
      scene.bodies.push_back(rough(box("box " + std::to_string(k), Vector3d::Constant(0.1), 1.0,
                                       {x, 0.3, z.middles[k]}, Vector3d::Zero()),
                                   0.5));
    const Trajectory result = run_it(scene);
    for (const Frame& frame : result.frames)
      // 2e-10 m: a rounding of each coordinate when it is recorded
      for (std::size_t k = 1; k < 4; ++k)
        ASSERT_LT((frame.poses[k].com_world - scene.bodies[k].position_m).norm(), 2e-10)
            << z.ground;
  }
}

TEST(PersistentContacts, ABoardTippingOverItsEdgeKeepsItsEnergy) {
  const auto lost = [](double step) {
    auto board =
        rough(box("board", {0.02, 0.1, 0.2}, 0.5, Vector3d::Zero(), Vector3d::Zero()), 5.0);
    board.world_from_body = Quaterniond(Eigen::AngleAxisd(0.3, Vector3d::UnitY()));
    double low = 0.0;
    for (const int x : {-1, 1})
      low = std::min(low, (board.world_from_body * Vector3d(0.02 * x, 0, -0.2)).z());
    board.position_m = {0, 0, -low};
    scene::Scene scene = with_contact({board, floor_of(5.0)}, 0.25);
    scene.step_s = step;
    const Trajectory result = run_it(scene);
    return std::abs(energy(result.frames.back()) - energy(result.frames.front()));
  };
  // 0.97 J turn while it falls by 0.6 rad. A thousandth is what hops of less than the restitution
  // threshold take; contacts that push the whole step where they were at its beginning take or give
  // some hundredths.
  EXPECT_LT(lost(1.0 / 60), 5e-3);
  EXPECT_LT(lost(1.0 / 240), 3e-3);
}

TEST(PersistentContacts, ADroppedBoxComesToRestWithoutGainingEnergy) {
  auto falling = rough(box("box", {0.2, 0.2, 0.1}, 1.0, {0, 0, 0.5}, {0.5, 0, 0}), 0.4, 0.3);
  falling.omega_world_rad_s = {1, 2, 3};
  const Trajectory result = run_it(with_contact({falling, floor_of(0.4)}, 4.0));
  for (const Frame& frame : result.frames)
    EXPECT_LE(energy(frame), energy(result.frames.front()) * (1 + 1e-12)) << frame.time;
  EXPECT_NEAR(result.frames.back().poses[0].com_world.z(), 0.1, 1e-9);
  EXPECT_LT(result.frames.back().kinetic_energy, 1e-20);
}

// Off the floor at an angle: Coulomb's law for the impulse. p_n = (1 + e) m v_n, p_t = mu p_n as
// long as that does not stop the slip.
// A puck on a frictionless floor on a rod from 0.5 m above its height goes round a circle of 1 m at
// 2 m/s: the floor carries part of its weight, the rod the rest and the way round.
TEST(LinkedContacts, APuckOnATetherGoesRoundToSecondOrder) {
  const auto off = [](double step) {
    auto puck = rough(ball("puck", 0.05, 1.0, {1, 0, 0.05}, {0, 2, 0}), 0.0);
    scene::Scene scene = with_contact({puck, floor_of(0.0)}, 2.0);
    scene.step_s = step;
    scene.effects.of<effects::RodSpec>().push_back(
        {"tether", {"", {0, 0, 0.55}}, {"puck", Vector3d::Zero()}, std::sqrt(1.25)});
    const Frame end = run_it(scene).frames.back();
    EXPECT_NEAR(end.kinetic_energy, 2.0, 0.01) << step;
    return (end.poses[0].com_world - Vector3d(std::cos(4.0), std::sin(4.0), 0.05)).norm();
  };
  const double coarse = off(1.0 / 120), fine = off(1.0 / 240), finer = off(1.0 / 480);
  EXPECT_LT(coarse, 5e-3);
  // 4 for order 2; where links react along the directions of a step's start it is 2
  EXPECT_GT(coarse / fine, 3.3);
  EXPECT_GT(fine / finer, 3.3);
}

// A cart that slides without friction below the pendulum that hangs from it: energy.
TEST(LinkedContacts, ACartKeepsTheEnergyOfItsPendulumToSecondOrder) {
  const auto gained = [](double step) {
    auto cart = rough(box("cart", {0.5, 0.2, 1.1}, 2.0, {0, 0, 1.1}, Vector3d::Zero()), 0.0);
    cart.inertia_body_kg_m2 = 50 * Matrix3d::Identity();  // it does not tip
    auto bob = ball("bob", 0.05, 1.0, {0.48, 0, 0.74}, Vector3d::Zero());
    bob.collides = false;
    scene::Scene scene = with_contact({cart, bob, floor_of(0.0)}, 1.0);
    scene.step_s = step;
    scene.effects.of<effects::RodSpec>().push_back(
        {"arm", {"cart", Vector3d::Zero()}, {"bob", Vector3d::Zero()}, 0.6});
    double worst = 0.0;
    const Trajectory result = run_it(scene);
    for (const Frame& frame : result.frames)
      worst = std::max(worst, std::abs(energy(frame) - energy(result.frames.front())));
    return worst;
  };
  const double coarse = gained(1.0 / 240), fine = gained(1.0 / 480);
  EXPECT_LT(coarse, 0.05);
  EXPECT_GT(coarse / fine, 3.0);  // 4 for order 2, 2 for order 1
}

TEST(ImpactsWithFriction, ABallSlowsAndSpinsByFrictionTimesTheNormalImpulse) {
  const double e = 0.6, mu = 0.1, radius = 0.1;
  const Trajectory result =
      run_it(with_contact({rough(ball("ball", radius, 2.0, {0, 0, 1.0}, {4, 0, -3}), mu, e),
                           rough(plane("wall", Vector3d::Zero(), Vector3d::UnitZ()), mu, 1.0)},
                          0.5, std::nullopt));
  const BodyPose& after = result.frames.back().poses[0];
  EXPECT_NEAR(after.velocity_world.z(), e * 3, 1e-12);
  const double slowed = mu * (1 + e) * 3;
  EXPECT_NEAR(after.velocity_world.x(), 4 - slowed, 1e-12);
  EXPECT_NEAR(after.omega_world.y(), slowed / (0.4 * radius), 1e-10);
}

TEST(SimultaneousImpacts, OneBallIntoFourGivesTheLcpsAnswer) {
  std::vector<scene::BodySpec> bodies{ball("cue", 0.1, 1.0, {-0.5, 0, 0}, {1, 0, 0})};
  for (int i = 0; i < 4; ++i)
    bodies.push_back(
        ball("ball " + std::to_string(i), 0.1, 1.0, {0.2 * i, 0, 0}, Vector3d::Zero()));
  scene::Scene scene = with_contact(bodies, 0.5, std::nullopt);
  scene.contact->impact_law = scene::ImpactLaw::kSimultaneous;
  const Trajectory result = run_it(scene);
  EXPECT_NEAR(result.frames.back().poses[0].velocity_world.x(), -0.6, 1e-10);
  for (int i = 1; i <= 4; ++i)
    EXPECT_NEAR(result.frames.back().poses[i].velocity_world.x(), 0.4, 1e-10) << i;
}

scene::Scene stiff_spring(double step) {
  auto bob = ball("bob", 0.01, 1.0, {1.1, 0, 0}, Vector3d::Zero());
  bob.collides = false;
  scene::Scene scene = scene_of({bob}, 1.0);
  scene.effects.of<effects::SpringSpec>().push_back(
      {"stiff", {"", Vector3d::Zero()}, {"bob", Vector3d::Zero()}, 1e6, 0.0, 1.0});
  scene.step_s = step;
  return scene;
}

// w = 1000 rad/s: RK4 follows it up to w h = 2 sqrt(2).
TEST(Stability, AStepBeyondTheMethodsRangeIsRefusedWithTheLargestOne) {
  try {
    run(stiff_spring(3.0e-3), reference_laws());
    FAIL() << "ran";
  } catch (const UserError& error) {
    const std::string what = error.what();
    EXPECT_NE(what.find("'stiff'"), std::string::npos) << what;
    EXPECT_NE(what.find("0.002828"), std::string::npos) << what;
  }
  EXPECT_EQ(run(stiff_spring(2.8e-3), reference_laws()).stopped_by, "");
}

TEST(Stability, EnergyThatNothingBroughtInStopsTheRunWithTheBodyNamed) {
  Laws wrong = reference_laws();
  wrong.spring_force = [right = wrong.spring_force](const Spring& spring, const AnchorState& a,
                                                    const AnchorState& b) {
    return Vector3d(-right(spring, a, b));
  };
  scene::Scene scene = stiff_spring(1e-3);
  // 10 rad/s: a hyperbolic cosine that reaches ten times the energy after some frames
  scene.effects.of<effects::SpringSpec>()[0].stiffness_n_m = 100.0;
  const Trajectory result = run(scene, wrong);
  EXPECT_NE(result.stopped_by.find("'bob'"), std::string::npos) << result.stopped_by;
  EXPECT_NE(result.stopped_by.find("runaway energy"), std::string::npos) << result.stopped_by;
  EXPECT_GT(result.frames.size(), 1u);  // what was recorded up to there is kept
}

// Where an edge sticks while the board turns, nothing is lost or won: what a step makes of energy
// falls as its square, and never rises.
TEST(Tipping, EnergyIsKeptToSecondOrderAndTheEdgeStaysOnTheFloor) {
  std::vector<double> lost;
  for (const double step : {1.0 / 60, 1.0 / 120}) {
    const Trajectory result = run_it(tipping_board(step));
    double most = energy(result.frames.front());
    for (const Frame& frame : result.frames) {
      // Once it slides the step in which that begins is of first order: 2e-5 of the energy at 1/60
      // s.
      EXPECT_LE(energy(frame), most * (1 + (frame.time < 1.0 / 3 ? 1e-12 : 1e-4)))
          << "t = " << frame.time;
      most = std::min(most, energy(frame));
      // shells of 2e-11 m; a step that lets go leaves 1e-6 m and more
      EXPECT_LT(frame.smallest_gap, 1e-7) << "t = " << frame.time;
    }
    // at t = 1/3 s, before it slides
    lost.push_back(energy(result.frames.front()) - energy(result.frames[20]));
  }
  EXPECT_LT(lost[0], 2e-4 * energy(run_it(tipping_board(1.0 / 60)).frames.front()));
  EXPECT_NEAR(lost[0] / lost[1], 4.0, 0.5);  // second order
}

// The board comes down flat on the floor at 6 rad/s, in the middle of a step, and stays: plastic,
// and at rest at once.
TEST(Tipping, LandsWithinAStepAndLies) {
  const Trajectory result = run_it(tipping_board(1.0 / 60));
  EXPECT_GT(result.counters.counts.at("contact_activations"), 0u);
  EXPECT_LT(result.frames.back().kinetic_energy, 1e-12);
  EXPECT_NEAR(result.frames.back().poses[0].com_world.z(), 0.02, 1e-9);
}

// A plank that turns about one of its corners, and spins about its long axis, whose moment is a
// hundredth of the others: momenta and velocities are far from parallel, and the impulses of a step
// must change the former.
TEST(Turning, OnACornerKeepsTheEnergyToSecondOrder) {
  const auto change = [](double step) {
    auto plank =
        rough(box("plank", {1.0, 0.1, 1e-3}, 1.0, Vector3d::Zero(), Vector3d::Zero()), 2.0);
    plank.world_from_body = Quaterniond(Eigen::AngleAxisd(-1.1, Vector3d::UnitY()));
    const Quaterniond roll(Eigen::AngleAxisd(0.1, plank.world_from_body * Vector3d::UnitX()));
    plank.world_from_body = roll * plank.world_from_body;
    const Vector3d corner = plank.world_from_body * Vector3d(-1.0, -0.1, -1e-3);  // the lowest
    plank.position_m = {0, 0, -corner.z()};
    plank.omega_world_rad_s = {5, -1, 10};
    plank.velocity_m_s = -plank.omega_world_rad_s.cross(corner);
    scene::Scene scene = with_contact({plank, floor_of(2.0)}, 0.1);
    scene.step_s = step;
    const Trajectory result = run_it(scene);
    return std::abs(energy(result.frames.back()) / energy(result.frames.front()) - 1);
  };
  const double coarse = change(1.0 / 240), fine = change(1.0 / 480);
  // w h = 0.05; in proportion to the step it would be 4e-4 and more
  EXPECT_LT(coarse, 1e-4);
  EXPECT_GT(coarse / fine, 3.0);  // 4 in the limit
}

// Frames between the ends of steps: on its path from one to the next a body that turns on an edge
// dips in.
TEST(Turning, FramesWithinAStepAreApartAndChangeNothing) {
  const scene::Scene scene = tipping_board(1.0 / 60);
  const Trajectory few = run(scene, reference_laws(), 60.0),
                   many = run(scene, reference_laws(), 420.0);
  for (const Frame& frame : many.frames) EXPECT_GE(frame.smallest_gap, 0.0) << "t = " << frame.time;
  EXPECT_EQ(few.frames.back().poses[0].com_world, many.frames.back().poses[0].com_world);
  EXPECT_EQ(few.counters.counts.at("position_corrections"),
            many.counters.counts.at("position_corrections"));
}

// A rod slides on the two corners of its end until friction jams it. One corner could do it alone,
// and the rod would be flung about its axis.
TEST(Jamming, WhatIsSymmetricStaysSo) {
  auto rod = rough(box("rod", {1.0, 0.1, 1e-3}, 1.0, Vector3d::Zero(), {-3, 0, 0}), 1.4);
  rod.world_from_body = Quaterniond(Eigen::AngleAxisd(-std::atan(2.0), Vector3d::UnitY()));
  rod.position_m = {0, 0, -(rod.world_from_body * Vector3d(-1.0, 0, -1e-3)).z()};
  scene::Scene scene = with_contact({rod, floor_of(1.4)}, 0.25);
  scene.step_s = 1.0 / 240;
  const Trajectory result = run_it(scene);
  for (const Frame& frame : result.frames) {
    EXPECT_NEAR(frame.poses[0].omega_world.x(), 0.0, 1e-9) << frame.time;  // of 2 rad/s
    EXPECT_NEAR(frame.poses[0].omega_world.z(), 0.0, 1e-9) << frame.time;
  }
}

// Two blocks that fill a slot from wall to wall, to the last bit of their widths: nothing presses
// them against it, so they fall as if it were not there, however rough it is.
TEST(Jamming, WhatFitsExactlyBetweenTwoWallsFalls) {
  const auto block = [](const char* name, double width, double x) {
    return rough(box(name, {width / 2, 0.3, 0.2}, 1.0, {x, 0, 0}, Vector3d::Zero()), 0.5);
  };
  const auto wall = [](const char* name, double x) {
    auto spec = rough(box(name, {0.5, 5, 20}, 1.0, {x, 0, 0}, Vector3d::Zero()), 0.5);
    spec.immovable = true;
    return spec;
  };
  const Trajectory result = run(with_contact({block("narrow", 0.3, 0.15), block("wide", 0.7, 0.65),
                                              wall("left", -0.5), wall("right", 1.5)},
                                             1.0),
                                reference_laws());
  ASSERT_EQ(result.stopped_by, "");
  for (const int block : {0, 1})  // RK4 is exact for a parabola: 60 steps of rounding
    EXPECT_NEAR(result.frames.back().poses[block].com_world.z(), -kG / 2, 1e-11);
  // no room for margins: gaps of 0 to rounding, as they were
  for (const Frame& frame : result.frames) EXPECT_GE(frame.smallest_gap, -1e-14);
}

// Corners that a .3ds file keeps in single precision leave gaps between what is built of them. It
// stands from the start: nothing falls.
TEST(PersistentContacts, WhatIsBuiltInSinglePrecisionStandsFromTheStart) {
  const Trajectory result = run_it(with_contact(
      {rough(box("lower", {0.1, 0.1, 0.1}, 1.0, {0, 0, 0.1 + 2e-8}, Vector3d::Zero()), 0.5),
       rough(box("upper", {0.1, 0.1, 0.1}, 1.0, {0, 0, 0.3 + 5e-8}, Vector3d::Zero()), 0.5),
       floor_of(0.5)},
      0.5));
  for (const Event& event : result.events)
    EXPECT_NE(event.kind, EventKind::kCollision) << event.time;
  EXPECT_LT(result.frames.back().kinetic_energy, 1e-20);
  EXPECT_NEAR(result.frames.back().poses[1].com_world.z(), 0.3, 1e-9);
}

// An edge of a block parts from the floor at 1 mm/s: it hops for 0.2 ms and is down again. A step
// of 1/60 s that ends at rest where half of that speed has taken it would lift the edge by 8e-6 m,
// and have a hundred times the energy that the block moves with.
TEST(PersistentContacts, AnEdgeThatPartsSlowlyComesDownAgain) {
  // m, kg, rad/s: the far edge goes up at 0.9 mm/s, below the restitution threshold
  const double half = 0.01, mass = 1.0, rate = 0.045;
  auto block =
      rough(box("block", Vector3d::Constant(half), mass, {0, 0, half}, Vector3d::Zero()), 1.0);
  // about the edge at x = half, which lies still
  block.omega_world_rad_s = {0, rate, 0};
  block.velocity_m_s = {rate * half, 0, rate * half};
  for (const auto plastic : {scene::PlasticImpacts::kAutomatic, scene::PlasticImpacts::kInStep}) {
    scene::Scene scene = with_contact({block, floor_of(1.0)}, 0.5);
    scene.contact->plastic_impacts = plastic;
    const Trajectory result = run_it(scene);
    double highest = half;
    for (const Frame& frame : result.frames)
      highest = std::max(highest, frame.poses[0].com_world.z());
    const double moves = result.frames.front().kinetic_energy;
    EXPECT_GT(moves, 0.0);
    EXPECT_LT(mass * kG * (highest - half), moves);
  }
}

}  // namespace
}  // namespace tumble::testing
