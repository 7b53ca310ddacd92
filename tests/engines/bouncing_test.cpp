// A ball on a half-space: closed forms for its bounces, and rest in finite time (Zeno).
#include <cmath>

#include <fmt/format.h>

#include "framework/engines/base/rest_speed.h"
#include "framework/scene/load_scene.h"
#include "tests/engines/scenes.h"
#include "tests/support/story.h"

namespace tumble::testing {
namespace {

constexpr double kGravity = 9.81;

scene::Scene dropped_ball(double radius, double height, double restitution, double duration) {
  auto scene = scene_of({ball("ball", radius, 1.0, {0, 0, height + radius}, Vector3d::Zero()),
                         plane("floor", Vector3d::Zero(), Vector3d::UnitZ())},
                        duration, Vector3d(0, 0, -kGravity));
  scene.bodies[0].restitution = restitution;
  scene.rest_speed_m_s = 5e-4;
  return scene;
}

TEST(BouncingBall, ImpactTimesAreThoseOfTheGeometricSeries) {
  for (const double e : {0.5, 0.8, 1.0}) {
    const Trajectory result = run(dropped_ball(0.25, 1.0, e, 3.0));
    const double t1 = std::sqrt(2.0 / kGravity);
    double expected = t1, flight = 2 * t1;
    int compared = 0;
    for (const double t : collision_times(result)) {
      // Each bounce adds a few roundings of the height, 1e-16 m, over the speed.
      const double speed = 0.5 * kGravity * flight;
      EXPECT_NEAR(t, expected, 2e-15 + 4e-16 * 30 / speed)
          << "e = " << e << ", bounce " << compared;
      flight *= e;
      expected += flight;
      ++compared;
    }
    EXPECT_GE(compared, 3);
  }
}

TEST(BouncingBall, ComesToRestExactlyOnTheFloorInFewEvents) {
  for (const double e : {0.5, 0.8}) {
    const Trajectory result = run(dropped_ball(0.25, 1.0, e, 6.0));
    EXPECT_EQ(result.stopped_by, "");
    const double t1 = std::sqrt(2.0 / kGravity), t_infinity = t1 * (1 + e) / (1 - e), v_rest = 5e-4;
    ASSERT_EQ(result.events.back().kind, EventKind::kRest);
    EXPECT_NEAR(result.events.back().time, t_infinity, 2 * v_rest * e / (kGravity * (1 - e)));
    EXPECT_LE(result.events.size() - 1,
              std::ceil(std::log(v_rest / (kGravity * t1)) / std::log(e)) + 3);
    const BodyPose& end = result.frames.back().poses[0];
    EXPECT_EQ(end.com_world.z(), 0.25);
    EXPECT_EQ(end.velocity_world, Vector3d::Zero());
    EXPECT_EQ(result.frames.back().smallest_gap, 0.0);
  }
}

// A ball of a micrometre that falls from ten: bounces count until they are 1e-5 of its radius high,
// where no rest speed is given; 1 mm/s, which is given or suits larger balls, ends them at a
// twentieth of it. The one after bounce k begins at v e^k, and none begins below e v_rest.
TEST(BouncingBall, OfAMicrometreBouncesUntilNothingIsSeenOfIt) {
  constexpr double kRadius = 1e-6, kRestitution = 0.5, kHeight = 1e-5;
  const auto bounces = [&](const std::string& rest, double unit) {
    const std::string text = fmt::format(
        R"({{ "title": "t", "duration_s": {}, "step_s": {}, {} "gravity_m_s2": [0, 0, -9.81],
              "bodies": [ {{ "name": "bead", "shape": {{ "sphere": {{ "radius_m": {} }} }},
                             "mass_kg": 1, "restitution": {}, "position_m": [0, 0, {}] }},
                          {{ "name": "floor", "shape": {{ "plane": {{}} }}, "immovable": true }} ]
           }})",
        6.0 * std::sqrt(unit), 1e-2 * std::sqrt(unit), rest, kRadius * unit, kRestitution,
        (kRadius + kHeight) * unit);
    const Trajectory result = run(scene::parse_scene(text, "bead.json"));
    EXPECT_EQ(result.stopped_by, "");
    return static_cast<double>(collision_times(result).size());
  };
  const auto expected = [&](double rest_speed, double unit) {
    return std::ceil(std::log(rest_speed / std::sqrt(2.0 * kGravity * kHeight * unit)) /
                     std::log(kRestitution)) +
           1.0;
  };
  EXPECT_EQ(bounces("", 1.0), expected(std::sqrt(2.0 * kGravity * 1e-5 * kRadius), 1.0));
  EXPECT_EQ(bounces(R"("rest_speed_m_s": 1e-3,)", 1.0), expected(1e-3, 1.0));
  EXPECT_EQ(bounces("", 1e6), expected(1e-3, 1e6));
}

// Nothing falls: a hundredth of the fastest speed at the start, that of a turning surface too; what
// a scene gives stays.
TEST(RestSpeed, OfSlowBodiesInFreeSpaceIsAPartOfTheirSpeed) {
  const auto rest_speed = [](const std::string& more) {
    return engines::rest_speed_of(scene::parse_scene(
        R"({ "title": "t", "duration_s": 1, )" + more + R"( "mass_kg": 1 } ] })", "slow.json"));
  };
  const std::string ball =
      R"("bodies": [ { "name": "ball", "shape": { "sphere": { "radius_m": 0.5 } }, )";
  EXPECT_DOUBLE_EQ(rest_speed(ball + R"("velocity_m_s": [0, 1e-4, 0],)"), 1e-6);
  EXPECT_DOUBLE_EQ(rest_speed(ball + R"("angular_velocity_rad_s": [0, 0, 4e-4],)"), 2e-6);
  EXPECT_EQ(rest_speed(ball + R"("velocity_m_s": [0, 3, 0],)"), 1e-3);
  EXPECT_EQ(rest_speed(ball), 1e-3);
  EXPECT_EQ(rest_speed(R"("rest_speed_m_s": 0.01, )" + ball + R"("velocity_m_s": [0, 1e-4, 0],)"),
            0.01);
}

TEST(BouncingBall, NoFrameHasANegativeGap) {
  for (const Frame& frame : run(dropped_ball(0.3, 1.0, 0.8, 5.0)).frames)
    EXPECT_GE(frame.smallest_gap, 0.0) << frame.time;
}

}  // namespace
}  // namespace tumble::testing
