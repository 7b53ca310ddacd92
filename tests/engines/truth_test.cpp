// Runs of the engine against independently computed reference values, at 100 times the floor of
// double precision.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/collision/truth_reader.h"
#include "tests/engines/scenes.h"

namespace tumble::testing {
namespace {

// A ball measured from its lowest point, radius 0, above a floor with a given motion; the files
// count as many impacts as they list.
Trajectory run_ball_on_floor(const nlohmann::json& truth, const scene::PrescribedMotion& motion,
                             double floor_height, double duration) {
  auto scene =
      scene_of({ball("ball", 0.0, 1.0, {0, 0, number(input(truth, "h"))}, Vector3d::Zero()),
                plane("floor", {0, 0, floor_height}, Vector3d::UnitZ())},
               duration, Vector3d(0, 0, -number(input(truth, "g"))));
  scene.bodies[0].restitution = number(input(truth, "e"));
  scene.bodies[1].motion = motion;
  scene.rest_speed_m_s = 1e-5;
  return run(scene);
}

void expect_impacts(const nlohmann::json& truth, const Trajectory& result, double slowest) {
  const std::vector<double> expected = numbers(output(truth, "impact_times"));
  const std::vector<double> found = collision_times(result);
  EXPECT_EQ(result.stopped_by, "");
  for (std::size_t i = 0; i < expected.size(); ++i) {
    if (truth["outputs"].contains("speed_after_impact") &&
        number(output(truth, "speed_after_impact")[i]) < slowest)
      break;
    ASSERT_LT(i, found.size());
    EXPECT_NEAR(found[i], expected[i], pass_mark(truth, "impact_times"))
        << truth["id"] << " impact " << i;
  }
  for (const Frame& frame : result.frames)
    EXPECT_GE(frame.smallest_gap, 0.0) << truth["id"] << " at " << frame.time;
}

TEST(Truths, BouncingBall) {
  for (const std::string name : {"e0.5", "e0.8", "e1"}) {
    const auto truth = read_truth("bouncing_ball/" + name);
    expect_impacts(truth, run_ball_on_floor(truth, {}, 0.0, name == "e1" ? 18.0 : 5.0), 1.1e-5);
  }
}

TEST(Truths, BallOnMovingFloor) {
  for (const std::string name : {"rising_0.5", "sinking_1"}) {
    const auto truth = read_truth("ball_moving_floor/" + name);
    scene::PrescribedMotion motion;
    motion.velocity_m_s = {0, 0, number(input(truth, "V_floor"))};
    const Trajectory result =
        run_ball_on_floor(truth, motion, number(input(truth, "z0_floor")), 5.0);
    expect_impacts(truth, result, 0.0);
    // At rest on the floor, the ball moves with it.
    const Frame& end = result.frames.back();
    EXPECT_EQ(end.poses[0].com_world, end.poses[1].com_world);
    EXPECT_EQ(end.poses[0].velocity_world, end.poses[1].velocity_world);
  }
}

TEST(Truths, BallOnShakenFloor) {
  const auto truth = read_truth("ball_shaken_floor/A0.05_w10");
  scene::PrescribedMotion motion;
  motion.amplitude_m = {0, 0, number(input(truth, "A"))};
  motion.angular_frequency_rad_s = number(input(truth, "omega"));
  expect_impacts(truth, run_ball_on_floor(truth, motion, 0.0, 5.2), 0.0);
}

TEST(Truths, NewtonsCradle) {
  for (const std::string name :
       {"5balls_1moving_e0.9", "5balls_1moving_e1", "5balls_2moving_e1", "5balls_3moving_e1"}) {
    const auto truth = read_truth("newtons_cradle/" + name);
    const int n = static_cast<int>(number(input(truth, "N"))),
              moving = static_cast<int>(number(input(truth, "k_moving")));
    std::vector<scene::BodySpec> balls;
    for (int i = 0; i < n; ++i) {
      const bool moves = i < moving;
      balls.push_back(ball("ball " + std::to_string(i), 0.5, number(input(truth, "mass")),
                           {i - (moves ? 0.25 : 0.0), 0, 0},
                           {moves ? number(input(truth, "v")) : 0.0, 0, 0}));
      balls.back().restitution = number(input(truth, "e"));
    }
    const Trajectory result = run(scene_of(balls, 0.5));
    const char* key = truth["outputs"].contains("velocities_after_sequential")
                          ? "velocities_after_sequential"
                          : "velocities_after_sequential_left_first";
    const std::vector<double> expected = numbers(output(truth, key));
    for (int i = 0; i < n; ++i)
      EXPECT_NEAR(result.frames.back().poses[i].velocity_world.x(), expected[i],
                  pass_mark(truth, key))
          << name << " ball " << i;
    EXPECT_EQ(result.counters.counts.at("impulses"), number(output(truth, "pair_impulses_used")))
        << name;
    EXPECT_NEAR(result.frames.back().momentum_world.x(), number(output(truth, "momentum")),
                pass_mark(truth, "momentum"));
    EXPECT_NEAR(result.frames.back().kinetic_energy,
                number(output(truth, "kinetic_energy_sequential")),
                pass_mark(truth, "kinetic_energy_sequential"));
  }
}

TEST(Truths, HardSpheres) {
  for (const std::string name : {"three_a", "three_equal"}) {
    const auto truth = read_truth("hard_spheres/" + name);
    const auto masses = numbers(input(truth, "masses")), radii = numbers(input(truth, "radii"));
    std::vector<scene::BodySpec> bodies;
    for (std::size_t i = 0; i < masses.size(); ++i)
      bodies.push_back(ball("ball " + std::to_string(i), radii[i], masses[i],
                            vector(input(truth, "x0")[i]), vector(input(truth, "v0")[i])));
    const Vector3d size = vector(input(truth, "box"));
    for (int axis = 0; axis < 3; ++axis) {
      bodies.push_back(plane("wall", Vector3d::Zero(), Vector3d::Unit(axis)));
      bodies.push_back(plane("wall", size, -Vector3d::Unit(axis)));
    }
    const Trajectory result = run(scene_of(bodies, 70.0), test_laws(), 1.0);
    std::size_t event = 0;
    for (const auto& row : output(truth, "collisions")) {
      const double floor = number(row.at("tolerance_floor"));
      if (floor > 1e-3) break;
      while (event < result.events.size() &&
             result.events[event].body_b >= static_cast<int>(masses.size()))
        ++event;
      ASSERT_LT(event, result.events.size());
      const Event& found = result.events[event++];
      EXPECT_EQ(found.body_a, row.at("pair")[0].get<int>()) << name << " collision " << row.at("k");
      EXPECT_EQ(found.body_b, row.at("pair")[1].get<int>()) << name << " collision " << row.at("k");
      EXPECT_NEAR(found.time, number(row.at("t")), 100 * floor)
          << name << " collision " << row.at("k");
    }
    for (const Frame& frame : result.frames) {
      EXPECT_NEAR(frame.kinetic_energy, number(output(truth, "kinetic_energy")), 1e-12);
      EXPECT_GE(frame.smallest_gap, 0.0);
    }
  }
}

}  // namespace
}  // namespace tumble::testing
