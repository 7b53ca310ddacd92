// Every demo scene passes its checks at every frame with right laws; with wrong laws it fails.
#include <algorithm>

#include <gtest/gtest.h>

#include "tests/support/places.h"
#include "framework/effects/point_force/point_force.h"
#include "framework/effects/rod/rod.h"
#include "framework/engines/judging/judge.h"
#include "framework/engines/run.h"
#include "framework/modules/load.h"
#include "framework/modules/registry.h"
#include "framework/scene/load_scene.h"
#include "tests/support/test_laws.h"

namespace tumble::testing {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> demo_scenes() {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(test::source_dir() + "/assignments"))
    if (entry.path().extension() == ".json" && entry.path().parent_path().filename() == "scenes")
      files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

scene::Scene demo_scene(const std::string& name) {
  for (const auto& file : demo_scenes())
    if (file.stem() == name) return scene::load_scene(file);
  throw std::runtime_error("no demo scene " + name);
}

/// Right laws of all assignments: impulses and motion by code independent of any solution, all
/// others (springs, rods, contacts, scheduling) by the references.
Laws right_laws() {
  modules::Registry registry;
  register_assignments(registry);
  Laws laws = test_laws();
  for (const modules::ModuleKind* kind : registry.all()) {
    const fs::path file = fs::path(test::binary_dir()) / "modules" / (kind->id + "_reference.so");
    if (!fs::exists(file)) continue;
    const modules::AnyModule module = modules::load_module(*kind, file);
    Laws alone;  // has only the laws that this module implements
    kind->bind(module, alone);
    if (!alone.collision_impulse && !alone.integrate_step) kind->bind(module, laws);
  }
  return laws;
}

Trajectory run(const scene::Scene& scene, const Laws& laws,
               const engines::RunOptions& options = {}) {
  TrajectoryRecorder recorder;
  engines::RunOptions judged = options;
  judged.instants_s = engines::instants_of_checks(scene);
  engines::run_scene(scene, laws, judged, recorder);
  return recorder.trajectory();
}

/// Kinds of checks that a run fails.
std::vector<std::string> failures(const scene::Scene& scene, const Trajectory& run) {
  std::vector<std::string> kinds;
  for (const auto& result : engines::judge_run(scene, run))
    if (!result.passed) kinds.push_back(result.kind);
  return kinds;
}

bool fails(const scene::Scene& scene, const Laws& laws) {
  const Trajectory result = run(scene, laws);
  return !result.stopped_by.empty() || !failures(scene, result).empty();
}

Laws with_euler() {
  Laws laws = right_laws();
  laws.integrate_step = [](const OdeFunction& f, double t, const VectorXd& y,
                           double h) -> VectorXd { return y + h * f(t, y); };
  return laws;
}

TEST(DemoScenes, AreJudgedRightAndNeverOverlap) {
  for (const auto& file : demo_scenes()) {
    SCOPED_TRACE(file.stem().string());
    const scene::Scene scene = scene::load_scene(file);
    // a frame at the end of each step where steps are shorter than frames, so that everything
    // committed is checked
    engines::RunOptions options;
    options.frame_rate_hz = std::max(options.frame_rate_hz, 1.0 / scene.step_s);
    const Trajectory result = run(scene, right_laws(), options);
    EXPECT_EQ(result.stopped_by, "");
    EXPECT_EQ(failures(scene, result), std::vector<std::string>{});
    EXPECT_NEAR(result.frames.back().time, scene.duration_s, 1e-9);
    for (const Frame& frame : result.frames) ASSERT_GE(frame.smallest_gap, 0.0) << frame.time;
  }
}

TEST(DemoScenes, EulersMethodIsJudgedWrongWhereTruncationShows) {
  for (const std::string name : {"t_handle",
                                 "poked_box",
                                 "poked_pawn",
                                 "hung_by_rod",
                                 "double_pendulum",
                                 "chain_8",
                                 "heavy_bob",
                                 "four_bar",
                                 "two_joined_by_springs",
                                 "blocks_on_an_incline",
                                 "sliding_to_rolling",
                                 "drop_a_box",
                                 "drop_a_t_handle",
                                 "drop_a_gear",
                                 "newtons_cradle_2",
                                 "newtons_cradle_springs",
                                 "newtons_cradle_springs_2",
                                 "newtons_cradle_springs_3",
                                 "wedge",
                                 "bounce_to_rolling"})
    EXPECT_TRUE(fails(demo_scene(name), with_euler())) << name;
}

TEST(DemoScenes, AnImpulseOfTheWrongSignIsJudgedWrong) {
  Laws laws = test_laws();
  laws.collision_impulse = [right = laws.collision_impulse](const Contact& contact, const Body& a,
                                                            const Body& b, double e) {
    return -right(contact, a, b, e);
  };
  for (const std::string name : {"ball_against_wall", "collide_off_centre_e1", "pong_1"})
    EXPECT_TRUE(fails(demo_scene(name), laws)) << name;
}

TEST(DemoScenes, AForgottenRestitutionIsJudgedWrong) {
  Laws laws = right_laws();
  laws.collision_impulse = [right = laws.collision_impulse](const Contact& contact, const Body& a,
                                                            const Body& b, double) {
    return right(contact, a, b, 0.0);
  };
  for (const std::string name :
       {"ball_against_wall", "collide_off_centre_e05", "collide_off_centre_e1", "bouncing_ball",
        "newtons_cradle", "newtons_cradle_3", "newtons_cradle_springs", "newtons_cradle_springs_2",
        "newtons_cradle_springs_3", "bounce_to_rolling"})
    EXPECT_TRUE(fails(demo_scene(name), laws)) << name;
}

TEST(DemoScenes, ContactForcesThatAreNotThereAreJudgedWrong) {
  Laws laws = right_laws();
  laws.contact_forces = [](const MatrixXd&, const VectorXd& b) {
    return VectorXd(VectorXd::Zero(b.size()));
  };
  for (const std::string name : {"stack_of_10", "beam_on_two_supports"})
    EXPECT_TRUE(fails(demo_scene(name), laws)) << name;
}

// Without friction the student's forces hold the box: forces that are too large make it bounce
// repeatedly.
TEST(DemoScenes, ContactForcesThatAreHalfTooLargeAreJudgedWrong) {
  Laws laws = right_laws();
  laws.contact_forces = [right = laws.contact_forces](const MatrixXd& A, const VectorXd& b) {
    return VectorXd(1.5 * right(A, b));
  };
  EXPECT_TRUE(fails(demo_scene("drop_without_friction"), laws));
}

TEST(DemoScenes, AForceThatCountsTwiceIsJudgedWrongWhereAllStandsStill) {
  Laws laws = right_laws();
  laws.state_derivative = [right = laws.state_derivative](const RigidBodyState& state,
                                                          const Inertia& inertia,
                                                          const Wrench& wrench) {
    return right(state, inertia, {2.0 * wrench.force_world, wrench.torque_world});
  };
  for (const std::string name : {"stack_of_50", "arch", "wedge", "card_tent"})
    EXPECT_TRUE(fails(demo_scene(name), laws)) << name;
}

TEST(DemoScenes, AnEndOfBouncingThatForgetsTheRestitutionIsJudgedWrong) {
  Laws laws = right_laws();
  laws.ends_in_contact = [](double approach_speed, double, double restitution_threshold) {
    return approach_speed <= restitution_threshold;
  };
  EXPECT_TRUE(fails(demo_scene("bounce_to_rolling"), laws));
}

TEST(DemoScenes, AForgottenArmIsJudgedWrong) {
  Laws laws = test_laws();
  laws.wrench_of_point_force = [](const Vector3d& force, const Vector3d& point, const Vector3d&) {
    return Wrench{force, point.cross(force)};
  };
  scene::Scene scene = demo_scene("poked_box");
  scene.checks.clear();
  scene::CheckSpec check;  // torque times time, up to the change of the arm in a push of 1 ms
  check.kind = "angular_momentum";
  auto& push = scene.effects.of<effects::PointForceSpec>().front();
  push.duration_s = 1e-3;
  const Vector3d exact = push.point_m.cross(push.force_n) * push.duration_s;
  check.expected = {exact.x(), exact.y(), exact.z()};
  // the point moves by far less than 1e-3 of its arm in 1 ms
  check.tolerance = 1e-3 * exact.norm();
  scene.checks.push_back(check);
  EXPECT_FALSE(fails(scene, test_laws()));
  EXPECT_TRUE(fails(scene, laws));
}

TEST(DemoScenes, ASpringThatPushesWhereItShouldPullIsJudgedWrong) {
  Laws laws = right_laws();
  laws.spring_force = [right = laws.spring_force](const Spring& spring, const AnchorState& a,
                                                  const AnchorState& b) {
    return Vector3d(-right(spring, a, b));
  };
  for (const std::string name :
       {"hung_by_spring", "two_joined_by_springs", "dropped_on_a_hung_block",
        "newtons_cradle_springs", "newtons_cradle_springs_2", "newtons_cradle_springs_3"})
    EXPECT_TRUE(fails(demo_scene(name), laws)) << name;
}

TEST(DemoScenes, AForgottenRestLengthIsJudgedWrong) {
  Laws laws = right_laws();
  laws.spring_force = [right = laws.spring_force](Spring spring, const AnchorState& a,
                                                  const AnchorState& b) {
    spring.rest_length = 0.0;
    return right(spring, a, b);
  };
  for (const std::string name : {"hung_by_spring", "newtons_cradle_springs",
                                 "newtons_cradle_springs_2", "newtons_cradle_springs_3"})
    EXPECT_TRUE(fails(demo_scene(name), laws)) << name;
}

// A rod with a force on one of its two bodies only: the common centre of mass leaves its parabola.
TEST(DemoScenes, ARodThatPullsOneEndOnlyIsJudgedWrong) {
  Laws laws = right_laws();
  laws.set<effects::RodRow>(
      [right = laws.of<effects::RodRow>()](const Body& a, const Vector3d& point_a, const Body& b,
                                           const Vector3d& point_b, double length) {
        ConstraintRow row = right(a, point_a, b, point_b, length);
        row.jacobian_b *= 0.5;
        return row;
      });
  const Trajectory result = run(demo_scene("joined_by_rods"), laws);
  const auto wrong = failures(demo_scene("joined_by_rods"), result);
  EXPECT_TRUE(!result.stopped_by.empty() ||
              std::find(wrong.begin(), wrong.end(), "centre_of_mass") != wrong.end());
}

TEST(DemoScenes, ARodWithoutItsVelocityProductIsJudgedWrong) {
  Laws laws = right_laws();
  laws.set<effects::RodRow>(
      [right = laws.of<effects::RodRow>()](const Body& a, const Vector3d& point_a, const Body& b,
                                           const Vector3d& point_b, double length) {
        ConstraintRow row = right(a, point_a, b, point_b, length);
        row.velocity_product = 0.0;
        return row;
      });
  for (const std::string name :
       {"hung_by_rod", "double_pendulum", "chain_8", "newtons_cradle_2", "joined_by_rods"})
    EXPECT_TRUE(fails(demo_scene(name), laws)) << name;
}

TEST(DemoScenes, ASolverThatIsOffByAMillionthIsJudgedWrong) {
  Laws laws = right_laws();
  laws.constraint_multipliers =
      [right = laws.constraint_multipliers](
          const std::vector<Constraint>& rows, const std::vector<ConstrainedBody>& bodies,
          const VectorXd& wanted) { return VectorXd((1 + 1e-6) * right(rows, bodies, wanted)); };
  for (const std::string name : {"chain_100", "chain_1000", "heavy_bob", "robot_arm"})
    EXPECT_TRUE(fails(demo_scene(name), laws)) << name;
}

}  // namespace
}  // namespace tumble::testing
