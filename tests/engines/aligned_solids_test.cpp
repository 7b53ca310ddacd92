// Models that are exactly aligned meet like others: they rebound, and rest on each other.
#include <gtest/gtest.h>

#include "tests/engines/reference_runs.h"
#include "tests/support/places.h"

namespace tumble::testing::aligned_solids_test {
namespace {

scene::BodySpec model(const std::string& name, const std::string& file, const Vector3d& place,
                      const Vector3d& velocity) {
  scene::BodySpec body = ball(name, 1.0, 1.0, place, velocity);
  body.shape = scene::ModelSpec{test::source_dir() + "/models/" + file + ".3ds", "", 0.1};
  return body;
}

struct HeadOn {
  std::string file;
  Vector3d along, aside;  // unit; of the second [m]
  bool contact;

  scene::Scene scene() const {
    std::vector<scene::BodySpec> bodies{model("a", file, -0.3 * along, along),
                                        model("b", file, 0.3 * along + aside, -along)};
    for (scene::BodySpec& body : bodies) body.restitution = 0.5;
    scene::Scene scene = scene_of(std::move(bodies), 0.5);
    scene.step_s = 1.0 / 240.0;
    if (contact) scene.contact = scene::ContactSpec{};
    return scene;
  }
};

// The parts that touch come back e times as fast. Dumbbells, which are their own mirror images, do
// not turn.
TEST(AlignedSolids, ThatFlyAtEachOtherReboundInEveryEngine) {
  for (const std::string& engine : kEngines)
    for (const auto& [file, along] : {std::pair{"t_handle", Vector3d::UnitX().eval()},
                                      std::pair{"scoop", Vector3d::UnitX().eval()},
                                      std::pair{"dumbbell", Vector3d::UnitX().eval()}})
      for (const bool contact : {false, true}) {
        SCOPED_TRACE(engine + ", " + file + (contact ? ", contact" : ""));
        const Trajectory run = run_well(engine, HeadOn{file, along, {0, 0, 0}, contact}.scene());
        ASSERT_FALSE(run.events.empty());
        EXPECT_EQ(run.events[0].kind, EventKind::kCollision);
        // Models' coordinates are of single precision: a normal of facets is off by 1e-6 at most. A
        // facet's own normal is off by 0.1, and takes a tenth of the speed.
        EXPECT_NEAR(run.events[0].normal_velocity_before, -2.0, 1e-6);
        const auto& poses = run.frames.back().poses;
        EXPECT_LT((poses[0].velocity_world + poses[1].velocity_world).norm(), 1e-12);
        EXPECT_NEAR(run.events[0].normal_velocity_after, 1.0, 1e-6);
        if (std::string(file) != "dumbbell") continue;
        EXPECT_LT((poses[0].velocity_world + 0.5 * along).norm(), 1e-6);
        EXPECT_LT(poses[0].omega_world.norm(), 1e-4) << "1e-6 m/s over the radius of 3 cm";
      }
}

// A shift across the motion by less than any length of the models changes no speed by more.
TEST(AlignedSolids, ReboundAsTheyDoBesideTheLine) {
  for (const double aside : {1e-14, 1e-12, 1e-9}) {
    const auto end = [&](const Vector3d& shift) {
      return run_well("rd", HeadOn{"t_handle", Vector3d::UnitX(), shift, true}.scene())
          .frames.back()
          .poses;
    };
    const auto aligned = end(Vector3d::Zero()), beside = end({0, aside, aside});
    for (const int body : {0, 1})
      EXPECT_LT((aligned[body].velocity_world - beside[body].velocity_world).norm(),
                1e-12 + 100 * aside)
          << "of a lever of " << aside << " m over some centimetres";
  }
}

TEST(AlignedSolids, OneThatFallsOnAnotherRestsOnIt) {
  for (const std::string& engine : kEngines) {
    SCOPED_TRACE(engine);
    scene::BodySpec low = model("low", "l_shape", {0, 0, 0.5}, Vector3d::Zero());
    low.immovable = true;
    low.mass_kg.reset();
    std::vector<scene::BodySpec> bodies{low,
                                        model("up", "l_shape", {0, 0, 0.65}, Vector3d::Zero())};
    for (scene::BodySpec& body : bodies) {
      body.friction = 0.4;
      body.restitution = 0.0;
    }
    scene::Scene scene = scene_of(std::move(bodies), 0.5, Vector3d(0, 0, -9.81));
    scene.step_s = 1.0 / 240.0;
    scene.contact = scene::ContactSpec{};
    const Trajectory run = run_well(engine, scene);
    // both are 0.1 m high; a contact keeps 1e-10 of their size, and its last millimetres per second
    // are still there
    EXPECT_NEAR(run.frames.back().poses[1].com_world.z(), 0.6, 1e-6);
    for (const Frame& frame : run.frames) EXPECT_GT(frame.poses[1].com_world.z(), 0.6 - 1e-6);
  }
}

}  // namespace
}  // namespace tumble::testing::aligned_solids_test
