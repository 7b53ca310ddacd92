// Drag, springs and water beside contacts that press: what these forces feel is the path that the
// contact allows, and not the one on which nothing holds the body up.
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "framework/dynamics/methods.h"
#include "framework/effects/drag/drag.h"
#include "framework/effects/spring/spring.h"
#include "framework/effects/water/water.h"
#include "tests/engines/event_process_scenes.h"
#include "tests/engines/reference_runs.h"

namespace tumble::testing {
namespace pressed_in_motion_test {

constexpr double kG = 9.81;

scene::Scene pressed(std::vector<scene::BodySpec> bodies, double duration, double step) {
  for (scene::BodySpec& body : bodies) body.restitution = 0.0;
  scene::Scene scene = scene_of(std::move(bodies), duration, kEarth);
  scene.contact.emplace();
  scene.step_s = step;
  return scene;
}

Vector3d force_on(int body, const Frame& frame) {
  Vector3d sum = Vector3d::Zero();
  for (const ContactPoint& point : frame.contacts) {
    if (point.body_a == body) sum += point.force_on_a_world;
    if (point.body_b == body) sum -= point.force_on_a_world;
  }
  return sum;
}

const scene::BodySpec kFloor = plane("floor", {0, 0, 0}, {0, 0, 1});
const scene::BodySpec kBox = box("box", {0.2, 0.2, 0.05}, 1.0, {0, 0, 0.05}, {0, 0, 0});

// Nothing moves, so nothing but its weight is to be held. A step of first order loses c g h / 2: a
// twelfth at 1/60 s. The first step looks until a ten-thousandth is left, and each later one leaves
// a part c h / 2m of the last one's: nothing but rounding and the solver's residue after half a
// second.
TEST(PressedInMotion, ABoxAtRestInSyrupWeighsWhatItWeighs) {
  for (const double step : {1.0 / 30, 1.0 / 60, 1.0 / 240}) {
    scene::Scene scene = pressed({kFloor, kBox}, 0.5, step);
    scene.effects.of<effects::DragSpec>().push_back({"box", 10.0, 1.0});
    for (const std::string& engine : kEngines) {
      SCOPED_TRACE(engine);
      const Trajectory run = run_well(engine, scene);
      EXPECT_LT((force_on(1, run.frames.back()) - Vector3d(0, 0, kG)).norm(), 1e-8 * kG);
      for (std::size_t k = 1; k < run.frames.size(); ++k)
        EXPECT_LT((force_on(1, run.frames[k]) - Vector3d(0, 0, kG)).norm(), 1e-4 * kG);
    }
  }
}

// Lighter than water, it is pressed against a roof below the surface: statics.
// Syrup that takes a motion within a step, c h / m = 1 to 2.7 of the 2.78 up to which Runge-Kutta's
// method is stable: a round of looking for what presses leaves a half to 19 twentieths of the error,
// and where the rounds lead to is told by two of them. Rounds alone left 1e-3 to 0.7 of the weight.
TEST(PressedInMotion, ABoxAtRestInStiffSyrupWeighsWhatItWeighsFromTheFirstStepOn) {
  constexpr double kStep = 1.0 / 60;
  for (const double stiffness : {1.0, 2.1, 2.7}) {
    scene::Scene scene = pressed({kFloor, kBox}, 0.2, kStep);
    scene.effects.of<effects::DragSpec>().push_back({"box", stiffness / kStep, 1.0});
    for (const std::string& engine : kEngines) {
      const Trajectory run = run_well(engine, scene);
      // as near as the rounds look
      for (std::size_t k = 1; k < run.frames.size(); ++k)
        EXPECT_LT((force_on(1, run.frames[k]) - Vector3d(0, 0, kG)).norm(), 1e-4 * kG)
            << engine << ", c h / m = " << stiffness << ", frame " << k;
    }
  }
}

TEST(PressedInMotion, ABoxUnderARoofInWaterIsPressedByItsBuoyancy) {
  scene::BodySpec roof = plane("roof", {0, 0, 0.1}, {0, 0, -1});
  scene::Scene scene = pressed({roof, kBox}, 0.5, 1.0 / 60);
  scene.effects.of<effects::WaterSpec>().push_back({{0, 0, 2}, 1000.0, 3.0});
  const double lift = (1000.0 * 0.4 * 0.4 * 0.1 - 1.0) * kG;
  for (const std::string& engine : kEngines) {
    SCOPED_TRACE(engine);
    const Trajectory run = run_well(engine, scene);
    EXPECT_LT((force_on(1, run.frames.back()) - Vector3d(0, 0, -lift)).norm(), 1e-8 * lift);
  }
}

/// What halving the step leaves of an error of second order: a quarter, and a little more as long
/// as steps are not short.
constexpr double kQuarter = 0.27;

// m v' = -mu m g - c v until it stops, if nothing but the box's weight presses it.
double slides(double v0, double mu, double c, double t) {
  const double end = mu * kG / c;
  return (v0 + end) * std::exp(-c * t) - end;
}

// Of the speed the errors of first order cancel: friction is too small by as much as drag is too
// large. Of the force that presses it they do not: c g h / 2m of it is 1/60 at 1/60 s.
double error_of_sliding(const std::string& engine, double step) {
  constexpr double kMu = 0.2, kC = 2.0, kSpeed = 2.0, kTime = 0.4;
  scene::BodySpec box = kBox;
  box.velocity_m_s = {kSpeed, 0, 0};
  scene::Scene scene = pressed({kFloor, box}, kTime, step);
  for (scene::BodySpec& body : scene.bodies) body.friction = kMu;
  scene.effects.of<effects::DragSpec>().push_back({"box", kC, 0.0});
  const Trajectory run = run_well(engine, scene);
  for (std::size_t k = 1; k < run.frames.size(); ++k)
    EXPECT_NEAR(force_on(1, run.frames[k]).z(), kG, 1e-4 * kG);
  return std::abs(run.frames.back().poses[1].velocity_world.x() - slides(kSpeed, kMu, kC, kTime));
}

TEST(PressedInMotion, ABoxThatSlidesInSyrupIsOfSecondOrderInTheStep) {
  for (const std::string& engine : kEngines) {
    SCOPED_TRACE(engine);
    const double coarse = error_of_sliding(engine, 1.0 / 60),
                 fine = error_of_sliding(engine, 1.0 / 120);
    EXPECT_LT(coarse, 1e-4);                    // m/s
    EXPECT_LT(fine, kQuarter * coarse + 1e-9);  // the solver's residue
  }
}

scene::Scene box_on_sprung_block(double lifted, double damping, double duration, double step) {
  scene::Scene scene = pressed({box("block", {0.3, 0.3, 0.05}, 4.0, {0, 0, lifted}, {0, 0, 0}),
                                box("box", {0.1, 0.1, 0.1}, 1.0, {0, 0, 0.15 + lifted}, {0, 0, 0})},
                               duration, step);
  // each carries a quarter of the weight where `lifted` is 0
  constexpr double kStiffness = 1000.0, kLength = 1.0;
  for (const double x : {-0.25, 0.25})
    for (const double y : {-0.25, 0.25})
      scene.effects.of<effects::SpringSpec>().push_back({"spring",
                                                         {"", {x, y, kLength}},
                                                         {"block", {x, y, 0}},
                                                         kStiffness,
                                                         damping,
                                                         kLength - 5 * kG / (4 * kStiffness)});
  return scene;
}

// What is left is what the first step leaves of its force, a ten-thousandth at most, in
//   x'' = -w^2 x:  h^2 / 2 of it, and w h of that again.
TEST(PressedInMotion, ABoxThatLiesOnASprungBlockLiesStill) {
  const scene::Scene scene = box_on_sprung_block(0.0, 30.0, 2.0, 1.0 / 60);
  for (const std::string& engine : kEngines) {
    SCOPED_TRACE(engine);
    const Trajectory run = run_well(engine, scene);
    for (const Frame& frame : run.frames)
      EXPECT_LT(frame.poses[0].com_world.norm(), 1e-7);  // m; 9e-4 in steps of first order
  }
}

// Methods put other parts of a constant force into a path: symplectic Euler all of it twice. What
// is taken off again is what they put in.
TEST(PressedInMotion, ABoxLiesStillOnASprungBlockByOtherMethods) {
  for (const char* method : {"symplectic", "midpoint", "verlet"}) {
    SCOPED_TRACE(method);
    Laws laws = reference_laws();
    laws.integrate_step = step_of(method_named(method), kUnset);
    const Trajectory run = run_as_told({}, box_on_sprung_block(0.0, 0.0, 0.5, 1.0 / 240), laws);
    EXPECT_EQ(run.stopped_by, "");
    for (const Frame& frame : run.frames) EXPECT_LT(frame.poses[0].com_world.norm(), 1e-7);  // m
  }
}

// Together they swing as one mass of 5 kg, as long as the box is not thrown off (w^2 A < g):
//   x'' + 2 d x' + w^2 x = 0,   from rest.
double error_of_swing(const std::string& engine, double step) {
  constexpr double kAmplitude = 0.005, kTime = 0.5, kDamping = 5.0;  // N s/m, of each spring
  const Trajectory run = run_well(engine, box_on_sprung_block(kAmplitude, kDamping, kTime, step));
  const double d = 4 * kDamping / (2 * 5.0), w = std::sqrt(4000.0 / 5.0 - d * d);
  const double z =
      kAmplitude * std::exp(-d * kTime) * (std::cos(w * kTime) + d / w * std::sin(w * kTime));
  return std::abs(run.frames.back().poses[0].com_world.z() - z);
}

TEST(PressedInMotion, ABoxThatSwingsOnASprungBlockIsOfSecondOrderInTheStep) {
  for (const std::string& engine : kEngines) {
    SCOPED_TRACE(engine);
    const double coarse = error_of_swing(engine, 1.0 / 240),
                 fine = error_of_swing(engine, 1.0 / 480);
    EXPECT_LT(coarse, 1e-5);  // m
    EXPECT_LT(fine, kQuarter * coarse + 1e-9);
  }
}

}  // namespace pressed_in_motion_test
}  // namespace tumble::testing
