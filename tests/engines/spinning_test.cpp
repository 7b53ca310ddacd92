// Bodies that spin, up to ten thousand radians a second: what collision finding promises about
// their paths, against looking everywhere.
#include <algorithm>
#include <cmath>

#include "framework/core/random.h"
#include "framework/effects/build_world.h"
#include "framework/engines/stepping/free_turning.h"
#include "framework/engines/stepping/moving_world.h"
#include "tests/engines/scenes.h"
#include "tests/support/story.h"

namespace tumble::testing {
namespace {

using engines::MovingWorld;
using engines::RunCounters;

Vector3d random_vector(Random& random, double size) {
  const double x = random.between(-size, size), y = random.between(-size, size),
               z = random.between(-size, size);
  return {x, y, z};
}

Quaterniond random_rotation(Random& random) {
  const Vector3d v = random_vector(random, 1);
  return Quaterniond(random.between(-1, 1), v.x(), v.y(), v.z()).normalized();
}

/// Methods that a student may have written: of order 1, 2, 2 and 4.
Laws laws_of_method(int method) {
  Laws laws = test_laws();
  if (method == 0)
    laws.integrate_step = [](const OdeFunction& f, double t, const VectorXd& y,
                             double h) -> VectorXd { return y + h * f(t, y); };
  if (method == 1)
    laws.integrate_step = [](const OdeFunction& f, double t, const VectorXd& y,
                             double h) -> VectorXd {
      return y + h * f(t + h / 2, y + h / 2 * f(t, y));
    };
  if (method == 2)
    laws.integrate_step = [](const OdeFunction& f, double t, const VectorXd& y,
                             double h) -> VectorXd {
      const VectorXd k = f(t, y);
      return y + h / 2 * (k + f(t + h, y + h * k));
    };
  return laws;
}

/// A rod or a box that spins at 1 to 1e4 rad/s and flies, and a floor or a fixed rod near it.
scene::Scene spinning_near(Random& random) {
  const bool is_rod = random.between(0, 1) < 0.5, is_floor = random.between(0, 1) < 0.5;
  scene::BodySpec body = box("spinning", is_rod ? Vector3d(1, 0.02, 0.02) : Vector3d(0.3, 0.2, 0.1),
                             1.0, random_vector(random, 1.2), Vector3d::Zero());
  const double spin = std::pow(10.0, random.between(0, 4));
  if (is_floor) body.position_m.z() = std::abs(body.position_m.z());
  body.world_from_body = random_rotation(random);
  body.omega_world_rad_s = spin * random_vector(random, 1).normalized();
  body.velocity_m_s = -random.between(0.02, 0.5) * spin * body.position_m.normalized();
  scene::BodySpec other =
      is_floor ? plane("floor", Vector3d::Zero(), Vector3d::UnitZ())
               : box("fixed rod", {1.5, 0.02, 0.02}, 1.0, Vector3d::Zero(), Vector3d::Zero());
  other.immovable = true;
  if (!is_floor) other.world_from_body = random_rotation(random);
  return scene_of({body, other}, 1.0, Vector3d(0, 0, -9.81));
}

double gap_at(MovingWorld& moving, double t) {
  return collision::compute_gap(moving.shape(0), moving.motion_at(0, t).pose, moving.shape(1),
                                moving.motion_at(1, t).pose)
      .distance;
}

/// The smallest gap on the paths from now to `until`, by looking at 100 times and more closely
/// about the least.
double smallest_gap_seen(MovingWorld& moving, double until) {
  constexpr int kLooks = 100;
  const double start = moving.time(), stride = (until - start) / kLooks;
  double least = gap_at(moving, start), at = start;
  for (int k = 1; k < kLooks; ++k) {  // not the end: an impact there is found
    const double gap = gap_at(moving, start + k * stride);
    if (gap < least) {
      least = gap;
      at = start + k * stride;
    }
  }
  double low = std::max(start, at - stride), high = std::min(until - 1e-6 * stride, at + stride);
  for (int k = 0; k < 30; ++k) {
    const double left = low + (high - low) / 3, right = high - (high - low) / 3;
    const double gap_left = gap_at(moving, left), gap_right = gap_at(moving, right);
    least = std::min({least, gap_left, gap_right});
    (gap_left < gap_right ? high : low) = gap_left < gap_right ? right : left;
  }
  return least;
}

// Coordinates of some metres are rounded by 4e-16, a gap by some of these; times within the step by
// 1e-16 of it, 1e4 m/s by less.
constexpr double kRoundOff = 1e-12;  // m

TEST(Spinning, NoContactOfARodOrABoxIsMissed) {
  Random random(31);
  int cases = 0, hits = 0, cut = 0;
  while (cases < 6000) {
    const scene::Scene scene = spinning_near(random);
    const Laws laws = laws_of_method(cases % 4);
    RunCounters counters;
    MovingWorld moving(build_world(scene), laws, counters);
    const double start_gap = collision::compute_gap(moving.shape(0), moving.motion_at(0, 0).pose,
                                                    moving.shape(1), moving.motion_at(1, 0).pose)
                                 .distance;
    if (!(start_gap > 1e-6 && start_gap < 0.3)) continue;
    ++cases;
    for (int part = 0; part < 6; ++part) {  // of a step of 1/60 s
      moving.begin_step(1.0 / 60);
      if (moving.shorten_step({{0, 1}})) ++cut;
      const auto impact =
          collision::first_impact(moving.shape(0), moving.motion(0), moving.shape(1),
                                  moving.motion(1), moving.time(), moving.target());
      const double until = impact ? impact->time : moving.target();
      ASSERT_GE(smallest_gap_seen(moving, until), -kRoundOff)
          << "case " << cases << ", method " << (cases - 1) % 4 << ", "
          << scene.bodies[0].omega_world_rad_s.norm() << " rad/s against the "
          << scene.bodies[1].name
          << (impact ? ": touched before the impact found at "
                     : ": touched before the end of the step at ")
          << until << " s";
      if (impact) {
        ++hits;
        break;
      }
      if (moving.target() == 1.0 / 60) break;
      moving.commit(moving.target());
    }
  }
  EXPECT_GT(hits, cases / 4);
  EXPECT_GT(cut, cases / 2) << "steps of 1/60 s should have been cut for most of these spins";
}

TEST(Paths, APlaceAloneIsThatOfTheMotion) {
  std::vector<scene::BodySpec> bodies;
  for (const char* name : {"flies", "is pushed", "is driven"})
    bodies.push_back(box(name, {0.3, 0.2, 0.1}, 1.0,
                         {2.0 * static_cast<double>(bodies.size()), 0, 0}, {0.3, 0.2, 0.1}));
  bodies[0].omega_world_rad_s = bodies[1].omega_world_rad_s = {3, 2, 1};
  bodies[2].mass_kg.reset();
  bodies[2].velocity_m_s = Vector3d::Zero();
  bodies[2].immovable = true;
  bodies[2].motion.emplace().velocity_m_s = {0, 1, 0};
  const Laws laws = laws_of_method(3);
  RunCounters counters;
  MovingWorld moving(build_world(scene_of(bodies, 1.0)), laws, counters);
  const double h = 1.0 / 60;
  moving.begin_step(h);
  RigidBodyState end = moving.path_end(1);
  end.com_world.z() += 0.01;
  moving.set_path(1, moving.state(1), end);
  for (int body = 0; body < moving.size(); ++body)
    for (const double t : {0.0, 0.3 * h, h}) {
      const collision::Pose place = moving.pose_at(body, t), whole = moving.motion_at(body, t).pose;
      EXPECT_EQ(place.com_world, whole.com_world) << bodies[body].name << " at " << t;
      EXPECT_EQ(place.world_from_body.coeffs(), whole.world_from_body.coeffs())
          << bodies[body].name << " at " << t;
    }
}

TEST(Spinning, TheErrorOfAPathsTurningIsBelowItsBound) {
  Random random(32);
  for (int i = 0; i < 2000; ++i) {
    // Bodies from needles to plates: sides that differ up to a thousand times.
    const auto side = [&] { return std::pow(10.0, random.between(-3, 0)); };
    scene::BodySpec body =
        box("box", {side(), side(), side()}, 1.0, Vector3d::Zero(), Vector3d::Zero());
    body.world_from_body = random_rotation(random);
    body.omega_world_rad_s =
        std::pow(10.0, random.between(0, 4)) * random_vector(random, 1).normalized();
    const Laws laws = laws_of_method(i % 4);
    RunCounters counters;
    MovingWorld moving(build_world(scene_of(
                           {body, box("other", {1, 1, 1}, 1.0, {5, 0, 0}, Vector3d::Zero())}, 1.0)),
                       laws, counters);
    moving.begin_step(1.0 / 60);
    moving.shorten_step({{0, 1}});
    const collision::MotionBounds bounds = moving.motion(0).bounds;
    const double h = moving.target();
    EXPECT_LE(bounds.angular_speed * h, 1.001) << i;
    for (int k = 1; k < 50; ++k) {
      const double t = k * h / 50, dt = 1e-4 * h;
      const auto before = moving.motion_at(0, t - dt), after = moving.motion_at(0, t + dt);
      Quaterniond turn = after.pose.world_from_body * before.pose.world_from_body.conjugate();
      if (turn.w() < 0) turn.coeffs() *= -1.0;
      // Rounding of the quaternions leaves 1e-12 / h; the rest of the rate is what it is compared
      // with, to (1e-4)^2.
      const Vector3d error = turn.vec() / dt - 0.5 * (before.omega_world + after.omega_world);
      EXPECT_LE(error.norm(), bounds.angular_velocity_error + 1e-7 / h)
          << "body " << i << ", method " << i % 4 << ", part " << k;
      EXPECT_LE(after.omega_world.norm(), bounds.angular_speed * (1 + 1e-9))
          << "body " << i << ", method " << i % 4 << ", part " << k;
      EXPECT_LE((after.omega_world - before.omega_world).norm() / (2 * dt),
                bounds.angular_acceleration * (1 + 1e-6) + 1e-6 / h / h)
          << "body " << i << ", part " << k;
    }
  }
}

TEST(Spinning, AShortenedStepIsReportedOnceAndCounted) {
  auto scene = scene_of({box("wheel", {0.3, 0.3, 0.05}, 1.0, {0, 0, 0.35}, {0, 0, 0}),
                         plane("floor", Vector3d::Zero(), Vector3d::UnitZ())},
                        0.1, Vector3d(0, 0, -9.81));
  scene.bodies[0].omega_world_rad_s = {720, 0, 0};  // 12 rad in 1/60 s
  const Trajectory result = run(scene);
  EXPECT_EQ(result.stopped_by, "");
  EXPECT_GT(collision_times(result).size(), 0u);
  for (const Frame& frame : result.frames) EXPECT_GE(frame.smallest_gap, 0.0);
  EXPECT_GT(result.counters.counts.at("shortened_steps"), 3u);
  ASSERT_EQ(result.counters.notices.size(), 1u);
  EXPECT_NE(
      result.counters.notices[0].find("step shortened: body 'wheel' turns 12 rad a step of 1/60 s"),
      std::string::npos)
      << result.counters.notices[0];
}

TEST(Spinning, ABallAndABodyAlonePayNothing) {
  auto scene = scene_of({ball("ball", 0.1, 1.0, {0, 0, 0.2}, {0, 0, -1}),
                         box("alone", {0.3, 0.2, 0.1}, 1.0, {0, 0, 100}, Vector3d::Zero()),
                         plane("floor", Vector3d::Zero(), Vector3d::UnitZ())},
                        0.2);
  for (int k : {0, 1}) scene.bodies[k].omega_world_rad_s = {0, 0, 1e4};
  const Trajectory result = run(scene);
  EXPECT_EQ(collision_times(result).size(), 1u);
  EXPECT_EQ(result.counters.counts.at("shortened_steps"), 0u);
  ASSERT_EQ(result.counters.notices.size(), 1u);  // a ball's orientation is never seen
  EXPECT_NE(result.counters.notices[0].find("ball 'ball' turns more than half a turn in a step"),
            std::string::npos)
      << result.counters.notices[0];
  ASSERT_EQ(result.counters.faults.size(), 1u);  // a body's is
  EXPECT_EQ(result.counters.faults[0].kind, "turn_unresolved");
  EXPECT_EQ(result.counters.faults[0].subject, "'alone'");
  // rad: 1e4 rad/s about an axis that it keeps
  EXPECT_NEAR(result.counters.faults[0].worst, 1e4 / 60, 1.0);
  EXPECT_NE(result.counters.faults[0].remedy.find("a step of at most 0.0001 s"), std::string::npos)
      << result.counters.faults[0].remedy;
}

TEST(Spinning, AStepThatWouldTakeForeverStopsTheRunWithWords) {
  auto scene = scene_of({box("drill", {0.3, 0.2, 0.1}, 1.0, {0, 0, 0.5}, {0, 0, -1}),
                         plane("floor", Vector3d::Zero(), Vector3d::UnitZ())},
                        1.0);
  scene.bodies[0].omega_world_rad_s = {0, 0, 1e9};
  const std::string said = run(scene).stopped_by;
  for (const char* words : {"'drill'", "rad a step", "step_s"})
    EXPECT_NE(said.find(words), std::string::npos) << said;
}

// About an axis that it keeps, Runge and Kutta's method of order 4, whose stages see unit
// quaternions, turns a body late by (w h)^5 / 5120 a step, and its energy stays to rounding: 0.2
// rad in 10 s at 1 rad a step, a sixteenth of that at half a radian. At 1 rad the next term is 8 %
// of the first.
TEST(Spinning, WhatStepsTurnWrongIsAFaultThoughTheEnergyStays) {
  const double w = 100.0;
  auto scene = scene_of({box("spun", {0.3, 0.2, 0.1}, 1.0, {0, 0, 0}, {0, 0, 0})}, 10.0);
  scene.bodies[0].omega_world_rad_s = {0, 0, w};
  for (const double step : {1.0 / 100, 1.0 / 200}) {
    SCOPED_TRACE(step);
    scene.step_s = step;
    const Trajectory result = run(scene);
    const double late = std::pow(w * step, 5) / 5120 * 10.0 / step;
    const Quaterniond exact(Eigen::AngleAxisd(w * 10.0, Vector3d::UnitZ()));
    const double error = result.frames.back().poses[0].world_from_body.angularDistance(exact);
    EXPECT_NEAR(error, late, 0.1 * late);
    ASSERT_EQ(result.counters.faults.size(), late > 0.1 ? 1U : 0U);
    if (late < 0.1) continue;
    EXPECT_EQ(result.counters.faults[0].kind, "turns_wrong");
    EXPECT_EQ(result.counters.faults[0].subject, "'spun'");
    // looked at once a radian, of which it is late by (w h)^4 / 5120
    EXPECT_NEAR(result.counters.faults[0].worst, error, 1e-3 * error);
    EXPECT_NE(result.counters.faults[0].remedy.find("--propagator auto"), std::string::npos);
  }
  scene.bodies[0] = ball("ball", 0.1, 1.0, {0, 0, 0}, {0, 0, 0});
  scene.bodies[0].omega_world_rad_s = {0, 0, w};
  scene.step_s = 1.0 / 100;
  const Trajectory of_ball = run(scene);  // it looks the same and moves the same
  EXPECT_TRUE(of_ball.counters.faults.empty());
  ASSERT_EQ(of_ball.counters.notices.size(), 1U);
  EXPECT_NE(of_ball.counters.notices[0].find("orientation is not to be trusted"),
            std::string::npos);
}

// Two flights, each 0.25 rad late, with an impact between them that turns it about another axis.
TEST(Spinning, WhatFlightsTurnWrongAddsUp) {
  Body body;
  body.inertia = finite_inertia(1.0, Vector3d(1.0, 2.0, 2.5).asDiagonal());
  engines::FreeTurning turning(body.inertia);
  const double h = 0.1;
  double turned = 0.0;
  for (const Vector3d& axis : {Vector3d(Vector3d::UnitX()), Vector3d(Vector3d::UnitZ())}) {
    RigidBodyState state{Vector3d::Zero(), Quaterniond::Identity(), Vector3d::Zero(),
                         body.inertia.inertia_body * (5.0 * axis)};
    for (int i = 0; i < 100; ++i) {
      RigidBodyState end = state;  // 5 rad/s and 0.0025 rad a step too little
      end.world_from_body =
          Quaterniond(Eigen::AngleAxisd(5.0 * h - 0.0025, axis)) * state.world_from_body;
      turning.step(state, end, h, 5.0);
      state = end;
    }
    turned += 0.25;
    // looked at after every second step
    EXPECT_NEAR(turning.error(), turned, 1e-9);
  }
}

}  // namespace
}  // namespace tumble::testing
