// A scene made of a .3ds file: the picture shows all of it, sizes follow the model, an open surface
// is refused with the loader's message.
#include "tests/support/places.h"
#include "framework/scene/model_scene.h"

#include <cmath>
#include <filesystem>
#include <numbers>

#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/effects/gravity/gravity.h"
#include "framework/scene/build_shape.h"

namespace tumble::testing {
namespace {

namespace fs = std::filesystem;
const fs::path kModels = test::source_dir() + "/models";

/// The largest angle between the camera's axis and a point of a body's bounding ball, over half the
/// field of view. Up to 1 is in the picture.
double largest_angle(const scene::Scene& scene) {
  const Vector3d sight = scene.camera.target_m - scene.camera.eye_m;
  double largest = 0.0;
  const auto solids = scene::build_solids(scene);
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const auto* mesh = std::get_if<MeshSolid>(&solids[i].shape);
    if (mesh == nullptr) continue;
    for (const Vector3d& vertex : mesh->mesh_body.vertices) {
      const Vector3d to = scene.bodies[i].position_m + scene.bodies[i].world_from_body * vertex -
                          scene.camera.eye_m;
      largest = std::max(largest, std::atan2(to.cross(sight).norm(), to.dot(sight)));
    }
  }
  return largest / (0.5 * scene.camera.field_of_view_deg * std::numbers::pi / 180.0);
}

TEST(ModelScene, ShowsEveryShippedModelWholeWhateverItsSize) {
  int seen = 0;
  for (const auto& entry : fs::directory_iterator(kModels)) {
    if (!scene::names_model(entry.path())) continue;
    for (const double unit : {1e-3, 1.0, 100.0})
      for (const bool drops : {false, true}) {
        const scene::Scene made =
            scene::make_model_scene(entry.path(), {unit, 1000.0, drops, true});
        EXPECT_LE(largest_angle(made), 1.0) << entry.path() << " " << unit << " " << drops;
        EXPECT_GE(largest_angle(made), 0.3) << entry.path() << ": a dot in the picture";
        EXPECT_EQ(made.checks.empty(), false);
        ++seen;
      }
  }
  EXPECT_GE(seen, 60);
}

// A fall by its own radius takes sqrt(2 r / g) for any model: steps and duration scale with it.
TEST(ModelScene, TakesStepsInProportionToTheTimeOfAFall) {
  const scene::Scene one =
                         scene::make_model_scene(kModels / "gear.3ds", {0.01, 1000.0, true, true}),
                     hundred = scene::make_model_scene(kModels / "gear.3ds",
                                                       {0.0001, 1000.0, true, true});
  EXPECT_NEAR(one.duration_s / hundred.duration_s, 10.0, 1e-9);
  EXPECT_NEAR(one.step_s / hundred.step_s, 10.0, 1e-9);
  EXPECT_TRUE(effects::gravity_of(one).has_value());
  EXPECT_FALSE(effects::gravity_of(scene::make_model_scene(kModels / "gear.3ds")).has_value());
}

TEST(ModelScene, PutsObjectsSideBySideClearOfEachOther) {
  const scene::Scene made = scene::make_model_scene(kModels / "two_objects.3ds");
  ASSERT_EQ(made.bodies.size(), 2u);
  EXPECT_NE(made.bodies[0].name, made.bodies[1].name);
  EXPECT_NE(made.about.find("2 objects side by side"), std::string::npos);
}

TEST(ModelScene, AsksAboutTheUnitWhereTheSizeIsOdd) {
  EXPECT_NE(scene::make_model_scene(kModels / "gear.3ds", {100.0}).about.find("--scale 0.001"),
            std::string::npos);
  EXPECT_EQ(scene::make_model_scene(kModels / "gear.3ds").about.find("--scale 0.001"),
            std::string::npos);
}

TEST(ModelScene, RefusesWhatIsNotClosedInTheLoadersWords) {
  try {
    scene::make_model_scene(kModels / "broken/missing_face.3ds");
    FAIL() << "an open surface has no mass";
  } catch (const UserError& error) {
    EXPECT_NE(error.problem().find("open edge"), std::string::npos) << error.problem();
    EXPECT_FALSE(error.remedy().empty());
  }
}

}  // namespace
}  // namespace tumble::testing
