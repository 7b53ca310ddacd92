// Links are read as intended: anchors in the body's frame, lengths measured at the start, chains
// expanded.
#include <numbers>

#include <gtest/gtest.h>

#include "tests/support/places.h"
#include "framework/core/error.h"
#include "framework/effects/drag/drag.h"
#include "framework/effects/joint/joint.h"
#include "framework/effects/motor/motor.h"
#include "framework/effects/rod/rod.h"
#include "framework/effects/spring/spring.h"
#include "framework/scene/load_scene.h"

namespace tumble::scene::links_test {
namespace {

const std::string kBodies = R"("bodies": [
  { "name": "box", "shape": { "box": { "size_m": [2, 2, 2] } },
    "mass_kg": 1, "position_m": [0, 0, 5], "orientation": { "euler_deg": [90, 0, 0] } },
  { "name": "ball", "shape": { "sphere": { "radius_m": 0.1 } },
    "mass_kg": 1, "position_m": [3, 0, 5] }
])";

Scene scene_with(const std::string& more, const std::string& bodies = kBodies) {
  return parse_scene(R"({ "title": "t", "duration_s": 1, )" + bodies + ", " + more + " }",
                     "s.json");
}

// Coordinates up to 5 m, a rotation and a difference: below 10 eps * 5.
constexpr double kRounding = 50 * 2.3e-16;

TEST(Links, ASceneThatNamesNoneHasNone) {
  const Scene scene = scene_with(R"("step_s": 0.01)");
  EXPECT_TRUE(scene.effects.of<effects::SpringSpec>().empty() &&
              scene.effects.of<effects::RodSpec>().empty() &&
              scene.effects.of<effects::JointSpec>().empty() &&
              scene.effects.of<effects::DragSpec>().empty() &&
              scene.effects.of<effects::MotorSpec>().empty() && scene.apart.empty());
  EXPECT_FALSE(scene.contact.has_value());
  EXPECT_FALSE(scene.stabilisation.has_value());
}

TEST(Links, AnchorsAreFoundInTheBodysOwnFrame) {
  // The box is rotated by 90 degrees about z: its own +x points along the world's +y.
  const Scene scene = scene_with(R"("springs": [
    { "a": { "body": "box", "point_world_m": [0, 1, 5] }, "b": { "body": "ball" },
      "stiffness_n_m": 10 },
    { "a": { "body": "box", "point_body_m": [0, 1, 0] }, "b": { "point_world_m": [-1, 0, 7] },
      "stiffness_n_m": 10, "damping_n_s_m": 2, "rest_length_m": 0.5 },
    { "name": "corner", "a": { "body": "box", "vertex_towards": [1, 1, 1] },
      "b": { "body": "ball", "point_body_m": [0, 0, 0.1] }, "stiffness_n_m": 10 }])");
  ASSERT_EQ(scene.effects.of<effects::SpringSpec>().size(), 3u);
  EXPECT_EQ(scene.effects.of<effects::SpringSpec>()[0].name, "spring 1");
  EXPECT_LE((scene.effects.of<effects::SpringSpec>()[0].a.point_m - Vector3d(1, 0, 0)).norm(),
            kRounding);
  EXPECT_NEAR(scene.effects.of<effects::SpringSpec>()[0].rest_length_m, std::sqrt(10.0), kRounding);
  EXPECT_EQ(scene.effects.of<effects::SpringSpec>()[1].a.point_m, Vector3d(0, 1, 0));
  EXPECT_EQ(scene.effects.of<effects::SpringSpec>()[1].b.body, "");
  EXPECT_EQ(scene.effects.of<effects::SpringSpec>()[1].rest_length_m, 0.5);
  EXPECT_EQ(scene.effects.of<effects::SpringSpec>()[1].damping_n_s_m, 2.0);
  EXPECT_EQ(scene.effects.of<effects::SpringSpec>()[2].name, "corner");
  EXPECT_LE((scene.effects.of<effects::SpringSpec>()[2].a.point_m - Vector3d(1, 1, 1)).norm(),
            kRounding);
  EXPECT_EQ(scene.effects.of<effects::SpringSpec>()[2].pointer, "/springs/2");
}

TEST(Links, AVertexOfAModelIsTakenByItsNumber) {
  const std::string bodies =
      R"("bodies": [{ "name": "pawn", "shape": { "model": { "file": "chess_pawn.3ds",
        "metres_per_unit": 0.1 } }, "density_kg_m3": 700 }])";
  const std::string file = test::source_dir() + "/models/s.json";
  const auto scene_at = [&](const std::string& vertex) {
    return parse_scene(R"({ "title": "t", "duration_s": 1, )" + bodies +
                           R"(, "springs": [{ "a": { "body": "pawn", )" + vertex +
                           R"( }, "b": { "point_world_m": [0, 0, 9] }, "stiffness_n_m": 1 }] })",
                       file);
  };
  const Vector3d first = scene_at(R"("vertex": 0)").effects.of<effects::SpringSpec>()[0].a.point_m,
                 second = scene_at(R"("vertex": 1)").effects.of<effects::SpringSpec>()[0].a.point_m;
  EXPECT_GT(first.norm(), 0.0);
  EXPECT_NE(first, second);
  EXPECT_GE(
      scene_at(R"("vertex_towards": [0, 0, 1])").effects.of<effects::SpringSpec>()[0].a.point_m.z(),
      std::max(first.z(), second.z()));
  try {
    scene_at(R"("vertex": 100000)");
    ADD_FAILURE() << "vertex 100000 was accepted";
  } catch (const UserError& error) {
    EXPECT_NE(std::string(error.what()).find("body 'pawn' has"), std::string::npos) << error.what();
  }
}

TEST(Links, RodsAndJointsBringStabilisationByProjection) {
  const Scene scene =
      scene_with(R"("rods": [{ "a": { "body": "box" }, "b": { "body": "ball" } }])");
  EXPECT_NEAR(scene.effects.of<effects::RodSpec>()[0].length_m, 3.0, kRounding);
  ASSERT_TRUE(scene.stabilisation.has_value());
  EXPECT_EQ(scene.stabilisation->kind, StabilisationKind::kProjection);
  const Scene chosen = scene_with(
      R"("joints": [{ "kind": "hinge", "body_a": "ball", "point_m": [3, 0, 6], "axis": [0, 2, 0] }],
        "stabilisation": { "kind": "baumgarte", "time_constant_s": 0.05 })");
  EXPECT_EQ(chosen.effects.of<effects::JointSpec>()[0].body_b, "");
  EXPECT_EQ(chosen.effects.of<effects::JointSpec>()[0].axis, Vector3d(0, 1, 0));
  EXPECT_EQ(chosen.stabilisation->kind, StabilisationKind::kBaumgarte);
  EXPECT_EQ(chosen.stabilisation->time_constant_s, 0.05);
}

TEST(Links, DragMotorsContactFrictionAndPairsApartAreRead) {
  const Scene scene = scene_with(R"("drag": [{ "body": "ball", "linear_n_s_m": 0.5 }],
    "joints": [{ "name": "shoulder", "kind": "hinge", "body_a": "box", "body_b": "ball",
      "point_m": [1, 0, 5], "axis": [0, 0, 1] }],
    "motors": [{ "joint": "shoulder", "amplitude_rad": 0.5, "frequency_hz": 2,
      "stiffness_n_m_rad": 10, "damping_n_m_s_rad": 1, "largest_torque_n_m": 3,
      "period_s": 0.002 }],
    "contact": { "impact_law": "simultaneous", "plastic_impacts": "in_step", "sleep": true },
      "apart": [["ball", "box"]])");
  EXPECT_EQ(scene.effects.of<effects::DragSpec>()[0].linear_n_s_m, 0.5);
  EXPECT_EQ(scene.effects.of<effects::DragSpec>()[0].angular_n_m_s, 0.0);
  EXPECT_EQ(scene.effects.of<effects::MotorSpec>()[0].joint, "shoulder");
  EXPECT_EQ(scene.effects.of<effects::MotorSpec>()[0].largest_torque_n_m, 3.0);
  EXPECT_EQ(scene.effects.of<effects::MotorSpec>()[0].period_s, 0.002);
  EXPECT_EQ(scene.contact->impact_law, ImpactLaw::kSimultaneous);
  EXPECT_EQ(scene.contact->plastic_impacts, PlasticImpacts::kInStep);
  EXPECT_TRUE(scene.contact->sleep);
  EXPECT_EQ(scene.apart, (std::vector<std::pair<std::string, std::string>>{{"ball", "box"}}));
}

TEST(Links, AChainOfRodsHangsFromItsAnchorAndHoldsAnotherBody) {
  const Scene scene = scene_with(
      R"("chains": [{ "kind": "rods", "links": 100, "from": { "point_world_m": [3, 0, 15.1] },
        "direction": [0, 0, -2], "spacing_m": 0.1,
    "link": { "name": "bead", "shape": { "sphere": { "radius_m": 0 } },
      "mass_kg": 0.01, "collides": false } }],
    "rods": [{ "a": { "body": "bead_100" }, "b": { "body": "ball" } }])");
  ASSERT_EQ(scene.bodies.size(), 102u);
  ASSERT_EQ(scene.effects.of<effects::RodSpec>().size(), 101u);
  EXPECT_EQ(scene.bodies[2].name, "bead_1");
  EXPECT_FALSE(scene.bodies[2].collides);
  // coordinates up to 15 m
  EXPECT_LE((scene.bodies[101].position_m - Vector3d(3, 0, 5.1)).norm(), 4 * kRounding);
  EXPECT_EQ(scene.effects.of<effects::RodSpec>()[0].name, "rod to bead_1");
  EXPECT_EQ(scene.effects.of<effects::RodSpec>()[0].a.body, "");
  EXPECT_EQ(scene.effects.of<effects::RodSpec>()[99].a.body, "bead_99");
  for (const effects::RodSpec& rod : scene.effects.of<effects::RodSpec>())
    EXPECT_NEAR(rod.length_m, 0.1, 4 * kRounding);
  EXPECT_EQ(scene.effects.of<effects::RodSpec>()[99].pointer, "/chains/0");
}

TEST(Links, AChainOfBallJointsBetweenTwoPointsIsABridge) {
  const Scene scene = scene_with(
      R"("chains": [{ "kind": "ball_joints", "links": 4, "from": { "point_world_m": [0, 0, 0] },
        "to": { "body": "ball", "point_world_m": [3, 4, 0] }, "along": "z",
    "link": { "name": "plank", "shape": { "box": { "size_m": [0.1, 0.1, 1] } },
      "mass_kg": 1 } }])");
  ASSERT_EQ(scene.effects.of<effects::JointSpec>().size(), 5u);
  EXPECT_LE((scene.bodies[2].position_m - Vector3d(0.375, 0.5, 0)).norm(), kRounding);
  EXPECT_LE((scene.bodies[2].world_from_body * Vector3d::UnitZ() - Vector3d(0.6, 0.8, 0)).norm(),
            kRounding);
  EXPECT_EQ(scene.effects.of<effects::JointSpec>()[0].body_a, "plank_1");
  EXPECT_EQ(scene.effects.of<effects::JointSpec>()[0].body_b, "");
  EXPECT_EQ(scene.effects.of<effects::JointSpec>()[4].body_a, "plank_4");
  EXPECT_EQ(scene.effects.of<effects::JointSpec>()[4].body_b, "ball");
  EXPECT_LE((scene.effects.of<effects::JointSpec>()[4].point_m - Vector3d(3, 4, 0)).norm(),
            kRounding);
}

TEST(Links, AChainOfSpringsIsAsLongAsItIsLaidUnlessSaidOtherwise) {
  const Scene scene = scene_with(
      R"("chains": [{ "kind": "springs", "links": 3, "from": { "body": "box" },
        "direction": [0, 0, -1],
        "spacing_m": 1.5, "stiffness_n_m": 7, "damping_n_s_m": 0.1, "neighbours_apart": true,
    "link": { "name": "bead", "shape": { "sphere": { "radius_m": 0.1 } }, "mass_kg": 1 } }])");
  ASSERT_EQ(scene.effects.of<effects::SpringSpec>().size(), 3u);
  EXPECT_NEAR(scene.effects.of<effects::SpringSpec>()[2].rest_length_m, 1.5, kRounding);
  EXPECT_EQ(scene.effects.of<effects::SpringSpec>()[2].stiffness_n_m, 7.0);
  EXPECT_EQ(scene.effects.of<effects::SpringSpec>()[2].damping_n_s_m, 0.1);
  EXPECT_EQ(scene.apart.size(), 3u);  // with the box, too
  EXPECT_FALSE(scene.stabilisation.has_value());
}

}  // namespace
}  // namespace tumble::scene::links_test
