// Springs, rods and joints are drawn where the scene puts them, in every frame.
#include <gtest/gtest.h>

#include "framework/effects/joint/joint.h"
#include "framework/effects/rod/rod.h"
#include "framework/effects/spring/spring.h"
#include "framework/render/links.h"
#include "framework/render/stage.h"
#include "framework/render/stage_geometries.h"
#include "framework/render/surfaces.h"
#include "tests/render/render_fixtures.h"

namespace tumble::render {
namespace {

/// The falling ball, suspended from (0, 0, 2.5) by a spring at its top and by a rod at its side; a
/// hinge through its centre.
scene::Scene hung_ball() {
  scene::Scene scene = falling_ball();
  scene.effects.of<effects::SpringSpec>() = {
      {"spring", {"", {0, 0, 2.5}}, {"ball", {0, 0, 0.3}}, 10.0, 0.0, 0.5}};
  scene.effects.of<effects::RodSpec>() = {{"rod", {"", {1, 0, 2.5}}, {"ball", {0.3, 0, 0}}, 1.0}};
  effects::JointSpec hinge;
  hinge.kind = effects::JointKind::kHinge;
  hinge.body_a = "ball";
  hinge.point_m = {0, 0, 2.0};
  hinge.axis = {0, 1, 0};
  scene.effects.of<effects::JointSpec>() = {hinge};
  return scene;
}

SceneLinks links_of(const scene::Scene& scene, const Trajectory& run) {
  return {scene, run.frames.front(), 6.0, {0.3, 0.0}};
}

TEST(Links, FollowTheirBodies) {
  const Trajectory run = ball_at(2.0);  // falls by 0.5 m in its second frame
  const SceneLinks links = links_of(hung_ball(), run);
  for (const Frame& frame : run.frames) {
    const auto now = links.at(frame);
    ASSERT_EQ(now.size(), 3u);
    const Vector3d com = frame.poses[0].com_world;
    EXPECT_EQ(now[0].a_world, Vector3d(0, 0, 2.5));
    EXPECT_EQ(now[0].b_world, com + Vector3d(0, 0, 0.3));
    EXPECT_EQ(now[1].b_world, com + Vector3d(0.3, 0, 0));
    EXPECT_LT((0.5 * (now[2].a_world + now[2].b_world) - com).norm(), 1e-12)
        << "a few roundings of numbers near 1";
    EXPECT_EQ(now[2].kind, LinkKind::kHinge);
  }
}

TEST(Links, AreAbsentInASceneWithoutThem) {
  Drawing drawing;
  draw_links(links_of(falling_ball(), ball_at(2.0)).at(ball_at(2.0).frames.front()), 480, drawing);
  EXPECT_TRUE(drawing.batches.empty());
}

TEST(Links, SpringIsACoilNearbyAndALineFarAway) {
  const auto drawn = [](double distance) {
    Drawing drawing;
    drawing.view = view_of({{0, -distance, 0}, {0, 0, 0}, 40.0, {}});
    draw_links({{LinkKind::kSpring, {0, 0, 0}, {0, 0, 1}, 0.1, 1.0}}, 480, drawing);
    return drawing.batches.at(0).geometry;
  };
  EXPECT_EQ(drawn(5.0), kCoil);
  EXPECT_EQ(drawn(500.0), static_cast<int>(kRod));
}

TEST(Links, SpringWithoutLengthAndBodyNotFiniteAreLeftOut) {
  Drawing drawing;
  drawing.view = view_of(falling_ball().camera);
  draw_links({{LinkKind::kSpring, {1, 1, 1}, {1, 1, 1}, 0.1, 1.0}}, 480, drawing);
  EXPECT_TRUE(drawing.batches.empty());
  Trajectory run = ball_at(2.0);
  const SceneLinks links = links_of(hung_ball(), run);
  run.frames[1].poses[0].com_world.x() = kUnset;
  EXPECT_TRUE(links.at(run.frames[1]).empty());
}

// Faces are oriented outward (otherwise culling would show the inside): six times the enclosed
// volume, by the divergence theorem, is positive.
TEST(Links, SurfacesAreOrientedOutward) {
  for (const Geometry& geometry : {unit_coil(10), unit_coil(40), unit_rod(), unit_ball(1)}) {
    double volume = 0.0, farthest = 0.0;
    const auto at = [&](std::size_t i) {
      const float* p = geometry.vertices[geometry.indices[i]].position;
      return Vector3d(p[0], p[1], p[2]);
    };
    for (std::size_t i = 0; i < geometry.indices.size(); i += 3)
      volume += at(i).dot(at(i + 1).cross(at(i + 2)));
    for (const Vertex& vertex : geometry.vertices)
      farthest = std::max(farthest,
                          static_cast<double>(std::hypot(vertex.position[0], vertex.position[1])));
    EXPECT_GT(volume, 0.01);
    EXPECT_LE(farthest, 1.001);
  }
}

TEST(Links, AreVisibleInThePicture) {
  PictureOptions options = small();
  options.captions = options.paths = false;
  const Image with = make_picture(hung_ball(), ball_at(1.2), 0.0, options),
              without = make_picture(falling_ball(), ball_at(1.2), 0.0, options);
  const View view = view_of(falling_ball().camera);
  const auto differs = [&](const Vector3d& place) {
    const auto at = project(view, options.width, options.height, place);
    const std::uint8_t* a = with.pixel(static_cast<int>(at->x()), static_cast<int>(at->y()));
    const std::uint8_t* b = without.pixel(static_cast<int>(at->x()), static_cast<int>(at->y()));
    return std::abs(a[0] - b[0]) > 25;
  };
  EXPECT_TRUE(differs({0.65, 0, 1.85})) << "the middle of the rod";
  int seen = 0;  // at each point some turns of the coil cross in front of its axis
  for (double z = 1.55; z < 2.4; z += 0.02) seen += differs({0, 0, z});
  EXPECT_GT(seen, 5);
}

}  // namespace
}  // namespace tumble::render
