// A scene's body from a model file: found, with its mass properties, scaled, and refused with the
// body's name.
#include <gtest/gtest.h>

#include "tests/support/places.h"
#include "framework/core/error.h"
#include "framework/scene/build_shape.h"

namespace tumble::testing {
namespace {

scene::BodySpec body_of(const std::string& file, const std::string& object = "",
                        double metres_per_unit = 1.0) {
  scene::BodySpec body;
  body.name = "thing";
  body.shape = scene::ModelSpec{file, object, metres_per_unit};
  body.density_kg_m3 = 500.0;
  return body;
}

const std::filesystem::path kScene =
    std::filesystem::path(test::source_dir()) / "assignments/a1_impulse/scenes/any.json";

TEST(ModelBody, CubeHasTheMassAndInertiaOfACube) {
  const scene::Solid solid = scene::build_solid(body_of("box.3ds"), kScene, test::source_dir());
  EXPECT_NEAR(solid.mass_kg, 500.0, 1e-10);
  EXPECT_LE((solid.inertia_body_kg_m2 - Matrix3d(Matrix3d::Identity() * 500.0 / 6.0))
                .cwiseAbs()
                .maxCoeff(),
            1e-10);
  EXPECT_TRUE(std::get<MeshSolid>(solid.shape).is_convex);
}

TEST(ModelBody, MassScalesWithTheThirdPower) {
  EXPECT_NEAR(scene::build_solid(body_of("box.3ds", "", 0.5), kScene, test::source_dir()).mass_kg,
              62.5, 1e-10);
}

TEST(ModelBody, GivenMassOverridesTheDensity) {
  scene::BodySpec body = body_of("l_shape.3ds");
  body.density_kg_m3.reset();
  body.mass_kg = 6.0;
  const scene::Solid solid = scene::build_solid(body, kScene, test::source_dir());
  EXPECT_EQ(solid.mass_kg, 6.0);
  // Three unit cubes of 2 kg each, by the parallel axis theorem: centres at (1/2, 1/2), (3/2, 1/2),
  // (1/2, 3/2), their mean (5/6, 5/6).
  EXPECT_NEAR(solid.inertia_body_kg_m2(2, 2),
              3 * 2.0 / 6.0 + 2.0 * (2.0 / 9.0 + 5.0 / 9.0 + 5.0 / 9.0), 1e-10);
}

TEST(ModelBody, ModelIsFoundFromTheScenesFolderWithoutTheProjectsRoot) {
  EXPECT_NO_THROW(scene::build_solid(body_of("rock_1.3ds"), kScene));
}

TEST(ModelBody, ObjectIsChosenByName) {
  EXPECT_NEAR(
      scene::build_solid(body_of("two_objects.3ds", "box"), kScene, test::source_dir()).mass_kg,
      500.0, 1e-10);
}

TEST(ModelBody, RefusalNamesTheBodyTheFileAndTheRemedy) {
  for (const auto& [file, words] : {std::pair{"none.3ds", "no such file"},
                                    {"broken/lampshade.3ds", "lampshade"},
                                    {"two_objects.3ds", "holds 2 objects"}}) {
    try {
      scene::build_solid(body_of(file), kScene, test::source_dir());
      ADD_FAILURE() << file << " was accepted";
    } catch (const UserError& error) {
      const std::string said = error.what();
      EXPECT_NE(said.find("body 'thing'"), std::string::npos) << said;
      EXPECT_NE(said.find(file), std::string::npos) << said;
      EXPECT_NE(said.find(words), std::string::npos) << said;
      EXPECT_FALSE(error.remedy().empty()) << said;
    }
  }
}

}  // namespace
}  // namespace tumble::testing
