// Scenes whose size is a parameter: the requested number of bodies, at constant density, the same
// each time.
#include <algorithm>
#include <limits>
#include <set>
#include <tuple>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "tests/support/places.h"
#include "framework/core/error.h"
#include "framework/geometry/solid.h"
#include "framework/scene/sized_scenes.h"

namespace tumble::testing {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

int movers(const scene::Scene& scene) {
  int count = 0;
  for (const scene::BodySpec& body : scene.bodies) count += body.immovable ? 0 : 1;
  return count;
}

TEST(SizedScenes, HaveAsManyBodiesAsAskedForWithNamesOfTheirOwn) {
  for (const scene::SizedScene& sized : scene::sized_scenes())
    for (const int n : {1, 2, 7, 300}) {
      const scene::Scene scene = scene::make_sized_scene(sized.name, n);
      EXPECT_EQ(movers(scene), sized.name == "cars"     ? n + 5 * std::max(1, n / 100)
                               : sized.name == "robots" ? 10 * n
                                                        : n)
          << sized.name;
      std::set<std::string> names;
      for (const scene::BodySpec& body : scene.bodies) names.insert(body.name);
      EXPECT_EQ(names.size(), scene.bodies.size()) << sized.name;
    }
}

// Volume per body of a scene with walls: between the left and the right, the near and the far one,
// floor and ceiling.
TEST(SizedScenes, InARoomKeepTheirDensity) {
  // incomplete layers: 2 of 11 of the atoms at n = 1000
  for (const auto& [name, tolerance] : {std::pair("gas", 0.02), {"atoms", 0.12}}) {
    const auto room = [&](int n) {
      const scene::Scene scene = scene::make_sized_scene(name, n);
      return 8.0 * scene.bodies[1].position_m.x() * scene.bodies[3].position_m.y() *
             scene.bodies[5].position_m.z() / n;
    };
    EXPECT_NEAR(room(1000), room(64'000), tolerance * room(64'000)) << name;
  }
  for (const char* name : {"pong", "pong_ghosts"}) {
    const auto room = [&](int n) {
      const scene::Scene scene = scene::make_sized_scene(name, n);
      return 4.0 * scene.bodies[1].position_m.x() * scene.bodies[3].position_m.y() / n;
    };
    // half a ball's place more at each wall: 7 % of 22 rows by 46
    EXPECT_NEAR(room(1000), room(64'000), 0.1 * room(64'000)) << name;
  }
}

// Ground per body: of the box around the start positions; for a row, length per body. A scene with
// constant width would be wrong by the ratio of sizes.
TEST(SizedScenes, OnTheGroundKeepTheirDensity) {
  const auto ground = [](const char* name, const char* kind, int n, bool is_row) {
    const scene::Scene scene = scene::make_sized_scene(name, n);
    Eigen::AlignedBox2d box;
    for (const scene::BodySpec& body : scene.bodies)
      if (body.name.starts_with(kind)) box.extend(Eigen::Vector2d(body.position_m.head<2>()));
    return (is_row ? box.sizes().x() : box.volume()) / n;
  };
  for (const auto& [name, kind, few, many, is_row] :
       {std::tuple("cars", "bob_", 400, 6400, false),
        {"robots", "hand_", 100, 900, false},
        {"avalanche", "rock_", 400, 6400, false},
        {"dominoes_row", "domino_", 100, 10'000, true},
        {"cradle", "ball_", 100, 10'000, true}})
    // the outermost have half their place outside the box: 19 % of 10 rows by 10
    EXPECT_NEAR(ground(name, kind, few, is_row), ground(name, kind, many, is_row),
                0.25 * ground(name, kind, many, is_row))
        << name;
}

// 1.54 m wide: at 20,000 pendula there are 141 m for a row of 200 vehicles.
TEST(SizedScenes, OfManyCarsHaveRoomForEachVehicle) {
  for (const int n : {400, 4000, 20'000}) {
    std::vector<Vector3d> wheels;
    for (const scene::BodySpec& body : scene::make_sized_scene("cars", n).bodies)
      if (body.name.starts_with("wheel")) wheels.push_back(body.position_m);
    double nearest = kInfinity;
    for (std::size_t i = 0; i < wheels.size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        nearest = std::min(nearest, (wheels[i] - wheels[j]).norm());
    EXPECT_GT(nearest, 0.44) << n;  // m: a wheel's diameter
  }
}

TEST(SizedScenes, AreTheSameEachTime) {
  const scene::Scene once = scene::make_sized_scene("atoms", 30),
                     again = scene::make_sized_scene("atoms", 30);
  for (std::size_t i = 0; i < once.bodies.size(); ++i) {
    EXPECT_EQ(once.bodies[i].position_m, again.bodies[i].position_m);
    EXPECT_EQ(once.bodies[i].velocity_m_s, again.bodies[i].velocity_m_s);
  }
  EXPECT_EQ(once.digest, again.digest);
  EXPECT_NE(once.digest, scene::make_sized_scene("atoms", 31).digest);
}

// The scene places the block of ground by its centre of mass, which is a number in the code.
TEST(SizedScenes, PlaceTheMountainWhereItsModelIs) {
  const SolidModel mountain =
      load_solid(std::filesystem::path(test::source_dir()) / "models/mountainside.3ds");
  const scene::Scene scene = scene::make_sized_scene("avalanche", 3);
  const auto piece =
      std::find_if(scene.bodies.begin(), scene.bodies.end(),
                   [](const scene::BodySpec& body) { return body.name == "mountain_1"; });
  ASSERT_NE(piece, scene.bodies.end());
  // m: its toe is 10 cm deep in the valley's floor
  EXPECT_LT((piece->position_m - mountain.com_mesh).norm(), 1e-4);
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
