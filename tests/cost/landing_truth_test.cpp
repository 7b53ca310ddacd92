// A scene with a first contact has a reference solution.
#include <gtest/gtest.h>

#include "tests/support/places.h"
#include "framework/effects/spring/spring.h"
#include "framework/cost/cost.h"
#include "framework/truths/memory_scene.h"
#include "framework/scene/load_scene.h"
#include "tests/engines/reference_laws.h"

namespace tumble::testing {
namespace {

/// A box that falls on a corner, tips to an edge and then to a face: the end state must not depend
/// on the step. With an edge normal that is only rounding, runs at 1/960, 1/1920 and 1/3840 s
/// differ by 1e-3 m permanently.
TEST(Truth, OfALandingLastsToTheEndAndThreeRunsAgreeOnIt) {
  const scene::Scene scene =
      scene::load_scene(test::source_dir() + "/assignments/a3_constraints/scenes/drop_a_box.json");
  std::string why;
  const auto reference = cost::try_reference(scene, reference_laws(), {}, why);
  ASSERT_TRUE(reference) << why;
  EXPECT_EQ(reference->duration_s, scene.duration_s) << reference->shortened_by;
  // error of the finest steps: 6e-5 m where there is time for 1/7680 s
  EXPECT_LE(reference->floor_m, 3e-4);
}

TEST(CostReference, AReferenceWithImpactsIsAsAccurateAsTheRunsThatItJudges) {
  // A ball on a spring hits a wall: between impacts the tolerance determines the error, the time of
  // an impact depends on the path within a step. RK4 at 1/3840 s reaches an error of 6e-12 m; a
  // reference with a floor of 2e-7 m could not distinguish it from a step thirty times as long.
  scene::Scene scene = truths::empty_scene("spring and wall", 1.5, 1.0 / 60.0);
  scene::BodySpec ball = truths::point_mass("ball", 1.0, Vector3d(0.5, 0, 0), Vector3d::Zero());
  ball.shape = scene::SphereSpec{0.1};
  ball.collides = true;
  ball.restitution = 0.8;
  scene::BodySpec wall;
  wall.name = "wall";
  wall.shape = scene::PlaneSpec{};
  wall.immovable = true;
  wall.position_m = Vector3d(-0.3, 0, 0);
  wall.world_from_body = Quaterniond(Eigen::AngleAxisd(1.5707963267948966, Vector3d::UnitY()));
  scene.bodies = {wall, ball};
  scene.effects.of<effects::SpringSpec>().push_back(
      {"spring", {"ball", Vector3d::Zero()}, {"", Vector3d(3, 0, 0)}, 50.0, 0.0, 3.0});
  cost::CostOptions options;
  options.frame_rate_hz = 60.0;
  const cost::CostReference reference = cost::find_reference(scene, reference_laws(), options);
  EXPECT_EQ(reference.intervals, 90) << reference.shortened_by;
  EXPECT_LE(reference.floor_m, 1e-10) << reference.what;
}

}  // namespace
}  // namespace tumble::testing
