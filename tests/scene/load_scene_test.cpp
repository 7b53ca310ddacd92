#include <filesystem>

#include <gtest/gtest.h>

#include "tests/support/places.h"
#include "framework/scene/build_shape.h"
#include "framework/scene/load_scene.h"

namespace tumble::scene {
namespace {

TEST(CommittedScenes, AllLoadAndBuild) {
  int scenes = 0;
  for (const auto& entry :
       std::filesystem::recursive_directory_iterator(test::source_dir() + "/assignments")) {
    if (entry.path().extension() != ".json" || entry.path().parent_path().filename() != "scenes")
      continue;
    SCOPED_TRACE(entry.path().string());
    ++scenes;
    Scene scene;
    ASSERT_NO_THROW(scene = load_scene(entry.path()));
    EXPECT_NO_THROW(build_solids(scene, test::source_dir()));
    EXPECT_FALSE(scene.checks.empty());
  }
  EXPECT_GT(scenes, 0);
}

}  // namespace
}  // namespace tumble::scene
