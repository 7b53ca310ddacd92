// Files written by other programs. They are not part of the project: set TUMBLE_REAL_MODELS to a
// folder that has them. Without it the folder shared/models_real beside the checkout is tried, and
// the tests are skipped where neither exists.
#include <cstdlib>
#include <filesystem>

#include <gtest/gtest.h>

#include "tests/support/places.h"
#include "framework/geometry/load_3ds.h"
#include "framework/geometry/mass_properties.h"
#include "framework/geometry/solid.h"

namespace tumble::testing {
namespace {

std::filesystem::path real(const std::string& file) {
  const char* folder = std::getenv("TUMBLE_REAL_MODELS");
  return (folder != nullptr
              ? std::filesystem::path(folder)
              : std::filesystem::path(test::source_dir()).parent_path() / "shared/models_real") /
         file;
}

#define SKIP_WITHOUT(file)                  \
  if (!std::filesystem::exists(real(file))) \
  GTEST_SKIP() << real(file).string()       \
               << " does not exist: set TUMBLE_REAL_MODELS to a folder that has " << file

void expect_all_closed(const LoadedFile& file) {
  for (const LoadedObject& object : file.objects) {
    EXPECT_TRUE(object.report.is_closed())
        << file.where << ": " << object.name << ": " << object.report.defects.front().problem;
  }
}

TEST(RealModels, FelsIsOneClosedRock) {
  SKIP_WITHOUT("fels.3ds");
  const LoadedFile file = load_3ds(real("fels.3ds"));
  ASSERT_EQ(file.objects.size(), 1u);
  expect_all_closed(file);
  EXPECT_EQ(file.objects[0].report.mesh.vertices.size(), 386u);
  EXPECT_EQ(file.objects[0].report.mesh.faces.size(), 768u);
  EXPECT_GT(load_solid(real("fels.3ds")).volume, 0.0);
}

TEST(RealModels, NineBoxesSplitBySmoothingGroupsAreClosedAfterTheWeld) {
  SKIP_WITHOUT("test1.3ds");
  const LoadedFile file = load_3ds(real("test1.3ds"));
  ASSERT_EQ(file.objects.size(), 9u);
  expect_all_closed(file);
  for (const LoadedObject& object : file.objects)
    EXPECT_EQ(object.report.mesh.vertices.size(), 8u) << object.name;
  EXPECT_EQ(file.objects[0].name, "Box01");
}

TEST(RealModels, NodesKeepBoxesAtTheirModelledPlaces) {
  // At frame 0 of this file matrix and node cancel, up to float32, for a box rotated and scaled to
  // 0.1.
  SKIP_WITHOUT("test1.3ds");
  const Bounds found = bounds_of(load_3ds(real("test1.3ds")).objects[0].report.mesh);
  constexpr double kFloat = 1e-4;  // m: coordinates of 10, through a matrix of 0.1 and its inverse
  // read off the file's vertex list
  EXPECT_LE((found.low - Vector3d(-10.3385, -0.1942, -10.1436)).norm(), kFloat);
  EXPECT_LE((found.high - Vector3d(9.8509, 0.0019, 10.2417)).norm(), kFloat);
}

TEST(RealModels, FiveCubesHaveTheVolumesOfTheirSides) {
  SKIP_WITHOUT("cubes_with_alpha.3DS");
  const LoadedFile file = load_3ds(real("cubes_with_alpha.3DS"), {0.01});  // centimetres
  ASSERT_EQ(file.objects.size(), 5u);
  for (int i = 0; i < 5; ++i) {
    const double side = 1.0 + i;  // m
    ASSERT_TRUE(file.objects[i].report.is_closed());
    EXPECT_NEAR(signed_volume(file.objects[i].report.mesh), side * side * side,
                1e-5 * side * side * side)
        << file.objects[i].name;
  }
}

TEST(RealModels, TurningCubeAndRolledCameraAreClosed) {
  for (const char* name : {"RotatingCube.3DS", "CameraRollAnimWithChildObject.3ds"}) {
    SKIP_WITHOUT(name);
    const LoadedFile file = load_3ds(real(name));
    expect_all_closed(file);
    for (const LoadedObject& object : file.objects) EXPECT_EQ(object.report.mesh.faces.size(), 12u);
  }
}

}  // namespace
}  // namespace tumble::testing
