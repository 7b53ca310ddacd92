// What lands has a truth.
#include <gtest/gtest.h>

#include "framework/engines/cost/cost.h"
#include "framework/scene/load_scene.h"
#include "tests/engines/reference_laws.h"

namespace tumble::testing {
namespace {

/// A box that comes down on a corner, tips to an edge and then to a face: how it lands must not hang on the step. It did where the edge's normal was
/// whatever rounding left of it; runs at 1/960, 1/1920 and 1/3840 s then lay some 1e-3 m beside each other for good.
TEST(Truth, OfALandingLastsToTheEndAndThreeRunsAgreeOnIt) {
  const scene::Scene scene = scene::load_scene(TUMBLE_SOURCE_DIR "/assignments/a3_constraints/scenes/drop_a_box.json");
  std::string why;
  const auto truth = engines::try_truth(scene, reference_laws(), {}, why);
  ASSERT_TRUE(truth) << why;
  EXPECT_EQ(truth->duration_s, scene.duration_s) << truth->shortened_by;
  EXPECT_LE(truth->floor_m, 3e-4);   // what the finest steps leave: 6e-5 m where there is time for 1/7680 s
}

}  // namespace
}  // namespace tumble::testing
