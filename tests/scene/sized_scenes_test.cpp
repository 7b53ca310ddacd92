// Scenes whose size is a parameter: as many bodies as asked for, at kept density, the same each time.
#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/geometry/solid.h"
#include "framework/scene/sized_scenes.h"

namespace tumble::testing {
namespace {

int movers(const scene::Scene& scene) {
  int count = 0;
  for (const scene::BodySpec& body : scene.bodies) count += body.immovable ? 0 : 1;
  return count;
}

TEST(SizedScenes, HaveAsManyBodiesAsAskedForWithNamesOfTheirOwn) {
  for (const scene::SizedScene& sized : scene::sized_scenes())
    for (const int n : {1, 2, 7, 300}) {
      const scene::Scene scene = scene::make_sized_scene(sized.name, n);
      EXPECT_EQ(movers(scene), sized.name == "cars" ? n + 5 * std::max(1, n / 100) : sized.name == "robots" ? 10 * n : n) << sized.name;
      std::set<std::string> names;
      for (const scene::BodySpec& body : scene.bodies) names.insert(body.name);
      EXPECT_EQ(names.size(), scene.bodies.size()) << sized.name;
    }
}

TEST(SizedScenes, KeepTheirDensity) {
  // Room between the left and the right wall, the near and the far one, floor and ceiling, a body; small rooms have layers that are not full.
  const auto room = [](int n) {
    const scene::Scene scene = scene::make_sized_scene("gas", n);
    return 8.0 * scene.bodies[1].position_m.x() * scene.bodies[3].position_m.y() * scene.bodies[5].position_m.z() / n;
  };
  EXPECT_NEAR(room(1000), room(100000), 0.02 * room(100000));
}

TEST(SizedScenes, AreTheSameEachTime) {
  const scene::Scene once = scene::make_sized_scene("atoms", 30), again = scene::make_sized_scene("atoms", 30);
  for (std::size_t i = 0; i < once.bodies.size(); ++i) {
    EXPECT_EQ(once.bodies[i].position_m, again.bodies[i].position_m);
    EXPECT_EQ(once.bodies[i].velocity_m_s, again.bodies[i].velocity_m_s);
  }
  EXPECT_EQ(once.hash, again.hash);
  EXPECT_NE(once.hash, scene::make_sized_scene("atoms", 31).hash);
}

// The scene places the block of ground by its centre of mass, which it knows as numbers.
TEST(SizedScenes, PlaceTheMountainWhereItsModelIs) {
  const SolidModel mountain = load_solid(std::filesystem::path(TUMBLE_SOURCE_DIR) / "models/mountainside.3ds");
  const scene::Scene scene = scene::make_sized_scene("avalanche", 3);
  const auto piece = std::find_if(scene.bodies.begin(), scene.bodies.end(), [](const scene::BodySpec& body) { return body.name == "mountain_1"; });
  ASSERT_NE(piece, scene.bodies.end());
  EXPECT_LT((piece->position_m - mountain.com_mesh).norm(), 1e-4);   // m: its toe lies 10 cm deep in the valley's floor
  EXPECT_TRUE(piece->immovable);
}

TEST(SizedScenes, RefuseSizesAndNamesThereAreNone) {
  EXPECT_THROW(scene::make_sized_scene("gas", 0), UserError);
  EXPECT_THROW(scene::make_sized_scene("gas", 3000000), UserError);
  EXPECT_THROW(scene::make_sized_scene("atom", 3), UserError);
  EXPECT_EQ(scene::sized_scene_named("atom"), nullptr);
}

}  // namespace
}  // namespace tumble::testing
