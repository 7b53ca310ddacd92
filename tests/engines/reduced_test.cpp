// Rods and joints in joint coordinates: the same motion as in six coordinates a body, without rows.
#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "assignments/a1_impulse/a1_binding.h"
#include "assignments/a2_integration/a2_binding.h"
#include "assignments/a3_constraints/a3_binding.h"
#include "framework/engines/run.h"
#include "framework/engines/truths/memory_scene.h"
#include "framework/modules/load.h"
#include "framework/modules/registry.h"
#include "framework/scene/load_scene.h"

namespace tumble::testing::reduced_test {
namespace {

using scene::Coordinates;

Laws laws() {
  modules::Registry registry;
  register_assignments(registry);
  const std::filesystem::path built = std::filesystem::path(TUMBLE_BINARY_DIR) / "modules";
  Laws laws = library_laws();
  a1::bind(*std::static_pointer_cast<const a1::Module>(
               modules::load_module(registry.find("a1"), built / "a1_reference.so")),
           laws);
  a2::bind(*std::static_pointer_cast<const a2::Module>(
               modules::load_module(registry.find("a2"), built / "a2_reference.so")),
           laws);
  a3::bind(*std::static_pointer_cast<const a3::Module>(
               modules::load_module(registry.find("a3"), built / "a3_reference.so")),
           laws);
  return laws;
}

scene::Scene of_course(const std::string& name, double duration) {
  scene::Scene scene = scene::load_scene(std::filesystem::path(TUMBLE_SOURCE_DIR) /
                                         "assignments/a3_constraints/scenes" / (name + ".json"));
  scene.duration_s = duration;
  return scene;
}

Trajectory run(scene::Scene scene, Coordinates coordinates, double step,
               const std::string& engine = "rd") {
  scene.coordinates = coordinates;
  engines::RunOptions options;
  options.engine = engine;
  options.step_s = step;
  options.frame_rate_hz = 10.0;
  TrajectoryRecorder recorder;
  engines::run_scene(scene, laws(), options, recorder);
  EXPECT_EQ(recorder.trajectory().stopped_by, "");
  return recorder.trajectory();
}

/// Largest distance of centres, and of turnings in parts of 1 m. [m]
double distance(const Trajectory& a, const Trajectory& b) {
  double worst = a.frames.size() == b.frames.size() ? 0.0 : 1.0;
  for (std::size_t k = 0; k < std::min(a.frames.size(), b.frames.size()); ++k)
    for (std::size_t i = 0; i < a.frames[k].poses.size(); ++i) {
      const BodyPose &p = a.frames[k].poses[i], &q = b.frames[k].poses[i];
      worst = std::max({worst, (p.com_world - q.com_world).norm(),
                        p.world_from_body.angularDistance(q.world_from_body)});
    }
  return worst;
}

std::uint64_t solves(const Trajectory& run) { return run.counters.counts.at("constraint_solves"); }

TEST(JointCoordinates, MoveScenesOfTheCourseAsSixCoordinatesABodyDo) {
  // Both are of order 4 with errors of their own: half the step brings them 16 times nearer. Half
  // of
  // that is asked for, and to be near enough that another motion shows: a wrong bias term or torque
  // is off by centimetres in a second.
  for (const auto& [name, step] : {std::pair{"double_pendulum", 1.0 / 120},
                                   {"chain_8", 1.0 / 240},
                                   {"four_bar", 1.0 / 60},
                                   {"robot_arm", 1.0 / 200}}) {
    const scene::Scene scene = of_course(name, 0.8);
    const auto apart = [&](double h) {
      return distance(run(scene, Coordinates::kReduced, h), run(scene, Coordinates::kMaximal, h));
    };
    const double coarse = apart(step), fine = apart(0.5 * step);
    EXPECT_LT(coarse, 1e-3) << name;
    EXPECT_LT(fine, std::max(coarse / 8, 1e-11)) << name;
  }
}

TEST(JointCoordinates, OfATreeAskForNoRowsInAStep) {
  // what frames record of rods is worked out nine times, at frames alone
  const Trajectory tree = run(of_course("double_pendulum", 0.8), Coordinates::kReduced, 1.0 / 480);
  EXPECT_LE(solves(tree), tree.frames.size() + 1);
  const Trajectory loop = run(of_course("four_bar", 0.8), Coordinates::kReduced, 1.0 / 480);
  EXPECT_GT(solves(loop), loop.frames.size() + 1) << "a loop is closed by rows";
}

TEST(JointCoordinates, KeepTheirEnergyToTheOrderOfTheMethod) {
  const auto lost = [&](double step) {
    const Trajectory of = run(of_course("double_pendulum", 1.0), Coordinates::kReduced, step);
    double worst = 0.0;
    for (const Frame& frame : of.frames)
      worst = std::max(
          worst, std::abs(frame.kinetic_energy + frame.potential_energy -
                          of.frames.front().kinetic_energy - of.frames.front().potential_energy));
    return worst;
  };
  // RK4 loses energy by order 4 or 5 a unit of time: 16 or 32 times, less what the next terms add
  EXPECT_GT(lost(1.0 / 60) / lost(1.0 / 120), 12.0);
}

TEST(JointCoordinates, AreTheSameInProcesses) {
  const scene::Scene scene = of_course("double_pendulum", 0.8);
  EXPECT_LT(distance(run(scene, Coordinates::kReduced, 1.0 / 480, "ordered"),
                     run(scene, Coordinates::kReduced, 1.0 / 480)),
            1e-12)
      << "one island, the same steps: rounding alone";
}

TEST(JointCoordinates, GiveWayToSixCoordinatesInContact) {
  // A ball drops on a block that hangs on rods, bounces and stays: the block leaves joint
  // coordinates
  // and goes on from the same state. Both are at their step's truncation, which is the same where
  // nothing turns; rounding, through some fifteen impacts, is 1e-12.
  const scene::Scene scene = of_course("dropped_on_a_block_on_rods", 0.8);
  const Trajectory reduced = run(scene, Coordinates::kReduced, scene.step_s),
                   maximal = run(scene, Coordinates::kMaximal, scene.step_s);
  EXPECT_GT(reduced.events.size(), 1u);
  EXPECT_LT(distance(reduced, maximal), 1e-10);
}

TEST(JointCoordinates, LeaveRodsAutomaticallyToTheModuleThatIsShown) {
  const scene::Scene scene = of_course("double_pendulum", 0.2);
  // the module's rows are what this run shows
  EXPECT_EQ(distance(run(scene, Coordinates::kAutomatic, 1.0 / 480),
                     run(scene, Coordinates::kMaximal, 1.0 / 480)),
            0.0);
}

}  // namespace
}  // namespace tumble::testing::reduced_test
