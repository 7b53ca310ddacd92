// A ball on a half-space: closed forms for its bounces, and rest in finite time (Zeno).
#include <cmath>

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

TEST(BouncingBall, NoFrameHasANegativeGap) {
  for (const Frame& frame : run(dropped_ball(0.3, 1.0, 0.8, 5.0)).frames)
    EXPECT_GE(frame.smallest_gap, 0.0) << frame.time;
}

}  // namespace
}  // namespace tumble::testing
