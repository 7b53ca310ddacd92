// A scene in which errors grow has a reference solution for a limited time only.
#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/cost/cost.h"
#include "framework/truths/memory_scene.h"
#include "tests/support/test_laws.h"

namespace tumble::testing {
namespace {

using cost::CostOptions;

/// Six balls between four walls: each collision of two multiplies an error by about three.
scene::Scene billiard() {
  scene::Scene scene = truths::empty_scene("billiard", 60.0, 1e-3);
  const std::pair<Vector3d, Vector3d> walls[] = {{{-2, 0, 0}, {1, 0, 0}},
                                                 {{2, 0, 0}, {-1, 0, 0}},
                                                 {{0, -2, 0}, {0, 1, 0}},
                                                 {{0, 2, 0}, {0, -1, 0}}};
  for (const auto& [place, normal] : walls)
    scene.bodies.push_back(
        truths::wall("wall " + std::to_string(scene.bodies.size()), place, normal, 1.0));
  for (int i = 0; i < 6; ++i)
    scene.bodies.push_back(truths::ball("ball " + std::to_string(i), 1.0, 0.3,
                                        Vector3d(-1.4 + 1.3 * (i % 3), -0.7 + 1.45 * (i / 3), 0.0),
                                        Vector3d(3.0 - i, 1.0 + 0.7 * i, 0.0), 1.0));
  return scene;
}

TEST(Truth, OfChaosHoldsForAWhileAndIsRefusedForLonger) {
  CostOptions options;
  std::string why;
  const auto reference = cost::try_reference(billiard(), test_laws(), options, why);
  ASSERT_TRUE(reference) << why;
  // errors of 1e-16 grow by e per collision: some forty collisions, seconds
  EXPECT_GT(reference->duration_s, 1.0);
  EXPECT_LT(reference->duration_s, 59.0);
  EXPECT_LE(reference->floor_m, 1e-4 * reference->scale_m);
  // half of the scene's duration is tried; the reference holds for less
  options.least_share = 0.3;
  EXPECT_FALSE(cost::try_reference(billiard(), test_laws(), options, why)) << "it holds for a part";
  options.least_share = 0.0;
  options.shorten = false;
  EXPECT_THROW(cost::find_reference(billiard(), test_laws(), options), UserError);
}

}  // namespace
}  // namespace tumble::testing
