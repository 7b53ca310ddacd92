// Faulty laws end the run with the error, the body and the time; the recording up to then is kept.
#include <cmath>
#include <limits>
#include <stdexcept>

#include "framework/core/error.h"
#include "framework/core/not_implemented.h"
#include "framework/core/version.h"
#include "framework/dynamics/stopped_run.h"
#include "framework/effects/spring/spring.h"
#include "framework/engines/base/guarded_laws.h"
#include "framework/engines/run.h"
#include "tests/engines/scenes.h"
#include "tests/support/story.h"

namespace tumble::testing {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

scene::Scene head_on() {
  return scene_of({ball("left ball", 0.1, 1.0, {-1, 0, 0}, {1, 0, 0}),
                   ball("right ball", 0.1, 1.0, {1, 0, 0}, {-1, 0, 0})},
                  3.0);
}

void expect_stopped(const Trajectory& result, std::initializer_list<const char*> words,
                    std::size_t frames_kept) {
  for (const char* word : words)
    EXPECT_NE(result.stopped_by.find(word), std::string::npos)
        << "no \"" << word << "\" in: " << result.stopped_by;
  EXPECT_GE(result.frames.size(), frames_kept);
  for (const Frame& frame : result.frames)
    for (const BodyPose& pose : frame.poses)
      EXPECT_TRUE(pose.com_world.allFinite() && pose.velocity_world.allFinite()) << frame.time;
}

// Every engine's record, from which pages, pictures and files are made.
TEST(Records, ARunNamesItsVersionItsSceneItsSeedsAndTheSourceOfEachLaw) {
  scene::Scene scene = head_on();
  scene.digest = "ab12";
  scene.seeds = {7, 11};
  Laws laws = test_laws();
  laws.constraint_source = "a3 student";
  for (const char* engine : {"rd", "ca", "ordered"}) {
    engines::RunOptions options;
    options.engine = engine;
    options.command = "tumble run x";
    TrajectoryRecorder recorder;
    engines::run_scene(scene, laws, options, recorder);
    const TrajectoryInfo& info = recorder.trajectory().info;
    EXPECT_EQ(info.version, kProgramVersion) << engine;
    EXPECT_EQ(info.command, "tumble run x") << engine;
    EXPECT_EQ(info.scene_digest, "ab12") << engine;
    EXPECT_EQ(info.seeds, scene.seeds) << engine;
    EXPECT_EQ(info.constraint_source, "none") << engine << ": nothing here calls a3";
    EXPECT_EQ(info.integrator_source, laws.integrator_source) << engine;
  }
}

// A solver from elsewhere is named beside the module, whose springs and rows stay its own.
TEST(Records, ASolverOfLinksStandsBesideTheModuleAndNotInItsPlace) {
  Laws laws = test_laws();
  laws.constraint_source = "a3 student";
  laws.link_solver = "conjugate gradients";
  scene::Scene scene = head_on();
  scene.effects.of<effects::SpringSpec>().push_back(
      {"spring", {"left ball", {0, 0, 0}}, {"right ball", {0, 0, 0}}, 1.0, 0.0, 2.0});
  laws.spring_force = [](const auto&...) -> Vector3d { return Vector3d::Zero(); };
  TrajectoryRecorder recorder;
  engines::run_scene(scene, laws, {}, recorder);
  EXPECT_EQ(recorder.trajectory().info.constraint_source,
            "a3 student, links by conjugate gradients");
  laws.spring_force = [](const Spring&, const AnchorState&, const AnchorState&) -> Vector3d {
    return {kNaN, 0, 0};
  };
  laws.constraint_correction = [](const auto&, const auto&, const VectorXd&) -> VectorXd {
    return VectorXd::Constant(6, kNaN);
  };
  const Laws safe = engines::guarded(laws);
  const auto said = [](const auto& call) -> std::string {
    try {
      call();
    } catch (const StoppedRun& stop) {
      return stop.what();
    }
    return "";
  };
  EXPECT_NE(said([&] { safe.spring_force({}, {}, {}); }).find("a3 student"), std::string::npos);
  EXPECT_NE(said([&] { safe.constraint_correction({}, {}, VectorXd::Zero(1)); }).find("gradients"),
            std::string::npos);
}

// The balls meet at 0.9 s: 54 frames before it.
TEST(Trouble, AnImpulseThatIsNotANumberIsNamed) {
  Laws laws = test_laws();
  laws.collision_impulse = [](const Contact&, const Body&, const Body&, double) { return kNaN; };
  expect_stopped(run(head_on(), laws), {"left ball", "right ball", "0.9", "impulse"}, 54);
}

// Applied with the wrong sign an impulse drives the bodies together, faster each time, until the
// numbers end: the function in which they end is right, and the one that drives them has no part
// in it. Both are named.
TEST(Trouble, AnImpulseThatDrivesBodiesTogetherIsNoMissingNumber) {
  Laws laws = test_laws();
  laws.apply_impulse = [right = laws.apply_impulse](const Body& body, const Vector3d& impulse_world,
                                                    const Vector3d& point_world) {
    return right(body, -impulse_world, point_world);
  };
  expect_stopped(run(head_on(), laws),
                 {"left ball", "right ball", "0.9", "apply_impulse", "drives them together"}, 54);
}

TEST(Trouble, ALawThatThrowsIsNamed) {
  Laws laws = test_laws();
  laws.collision_impulse = [](const Contact&, const Body&, const Body&, double) -> double {
    throw std::runtime_error("I divided by zero");
  };
  expect_stopped(run(head_on(), laws), {"left ball", "0.9", "impulse", "I divided by zero"}, 54);
}

TEST(Trouble, AnUnwrittenLawIsNotAttemptedRatherThanStopped) {
  Laws laws = test_laws();
  laws.collision_impulse = [](const Contact&, const Body&, const Body&, double) -> double {
    throw NotImplemented("collision_impulse", "handouts/a1_impulse.md");
  };
  EXPECT_THROW(run(head_on(), laws), NotImplemented);
}

TEST(Trouble, AVelocityAfterAnImpulseThatIsNotANumberIsNamed) {
  Laws laws = test_laws();
  laws.apply_impulse = [](const Body&, const Vector3d&, const Vector3d&) {
    return Velocity{Vector3d::Constant(kNaN), Vector3d::Zero()};
  };
  expect_stopped(run(head_on(), laws), {"left ball", "0.9", "impulse"}, 54);
}

TEST(Trouble, AnIntegrationThatIsNotANumberIsNamed) {
  Laws laws = test_laws();
  const auto good = laws.integrate_step;
  laws.integrate_step = [good](const OdeFunction& f, double t, const VectorXd& y, double h) {
    return t > 0.5 ? VectorXd(VectorXd::Constant(y.size(), kNaN)) : good(f, t, y, h);
  };
  expect_stopped(run(head_on(), laws), {"left ball", "0.5", "integra"}, 30);
}

TEST(Trouble, AnIntegrationThatThrowsIsNamed) {
  Laws laws = test_laws();
  const auto good = laws.integrate_step;
  laws.integrate_step = [good](const OdeFunction& f, double t, const VectorXd& y,
                               double h) -> VectorXd {
    if (t > 0.5) throw std::out_of_range("y has no element 13");
    return good(f, t, y, h);
  };
  expect_stopped(run(head_on(), laws), {"left ball", "0.5", "integra", "y has no element 13"}, 30);
}

TEST(Trouble, AStateOfAnotherSizeIsNamed) {
  Laws laws = test_laws();
  const auto good = laws.integrate_step;
  laws.integrate_step = [good](const OdeFunction& f, double t, const VectorXd& y, double h) {
    return t > 0.5 ? VectorXd(VectorXd::Zero(3)) : good(f, t, y, h);
  };
  expect_stopped(run(head_on(), laws), {"left ball", "0.5", "integra", "3"}, 30);
}

TEST(Trouble, AnImpulseThatPullsTogetherIsAStallWithNames) {
  Laws laws = test_laws();
  laws.collision_impulse = [](const Contact&, const Body&, const Body&, double) { return -1.0; };
  expect_stopped(run(head_on(), laws), {"left ball", "right ball", "0.9"}, 54);
}

TEST(Trouble, AnImpulseOfNothingIsAStallWithNames) {
  Laws laws = test_laws();
  laws.collision_impulse = [](const Contact&, const Body&, const Body&, double) { return 0.0; };
  expect_stopped(run(head_on(), laws), {"left ball", "right ball", "0.9"}, 54);
}

TEST(Trouble, ARootFinderOfNonsenseChangesNothing) {
  for (const double nonsense : {kNaN, -1.0, 1e9}) {
    Laws laws = test_laws();
    laws.find_impact_time = [nonsense](const ScalarFunction&, const ScalarFunction&, double, double,
                                       double) {
      RootResult root{};
      root.time = nonsense;
      return root;
    };
    const Trajectory result = run(head_on(), laws);
    ASSERT_EQ(collision_times(result).size(), 1u);
    EXPECT_NEAR(collision_times(result)[0], 0.9, 1e-14);
  }
}

// In free flight, too, where a path is known exactly: a search for its collisions samples every
// radian.
TEST(Trouble, ABodyThatTurnsTooOftenAStepForItsCollisionsIsNamed) {
  for (const double rate : {1e4, 1e9}) {
    scene::BodySpec top = ball("top", 0.1, 1.0, {0, 0, 1}, Vector3d::Zero());
    top.shape = scene::BoxSpec{Vector3d(0.1, 0.1, 0.1)};
    top.omega_world_rad_s = {rate, 0, 0};
    scene::BodySpec floor = top;
    floor.name = "floor";
    floor.shape = scene::BoxSpec{Vector3d(1, 1, 0.1)};
    floor.immovable = true;
    floor.mass_kg.reset();
    floor.omega_world_rad_s.setZero();
    floor.position_m = {0, 0, 0.7};
    scene::Scene scene = scene_of({top, floor}, 0.02);
    scene.step_s = 0.01;
    for (const char* engine : {"rd", "ca", "ordered"}) {
      engines::RunOptions options;
      options.engine = engine;
      options.frame_rate_hz = 100.0;
      TrajectoryRecorder recorder;
      engines::run_scene(scene, test_laws(), options, recorder);
      const std::string& stopped = recorder.trajectory().stopped_by;
      if (rate > 1e5)
        EXPECT_TRUE(stopped.find("'top' turns 1e+07 rad a step") != std::string::npos &&
                    stopped.find("step_s") != std::string::npos)
            << engine << ": " << stopped;
      else
        EXPECT_EQ(stopped, "") << engine;
    }
  }
}

// Refused before it begins: a run of 1e9 steps is a mistake in the scene, and frames are kept in
// memory.
TEST(Trouble, ARunOfTooManyStepsOrFramesIsRefused) {
  const auto refused = [](double step, double duration, double rate) -> std::string {
    scene::Scene scene = head_on();
    scene.step_s = step;
    scene.duration_s = duration;
    TrajectoryRecorder recorder;
    engines::RunOptions options;
    options.frame_rate_hz = rate;
    try {
      engines::run_scene(scene, test_laws(), options, recorder);
    } catch (const UserError& error) {
      return error.what();
    }
    return "";
  };
  const std::string steps = refused(1e-9, 1.0, 60.0), frames = refused(1.0, 1e6, 60.0);
  EXPECT_NE(steps.find("1e+09 steps"), std::string::npos) << steps;
  EXPECT_NE(steps.find("\"step_s\""), std::string::npos) << steps;
  EXPECT_NE(frames.find("6e+07 frames"), std::string::npos) << frames;
  EXPECT_NE(frames.find("\"duration_s\""), std::string::npos) << frames;
  EXPECT_EQ(refused(0.01, 1.0, 60.0), "");
}

}  // namespace
}  // namespace tumble::testing
