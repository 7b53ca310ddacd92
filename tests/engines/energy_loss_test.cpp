// Energy that is lost where nothing takes any is told of, with a step that mends it; and what takes
// energy rightly is left in peace.
#include <cmath>
#include <functional>
#include <optional>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "framework/core/random.h"
#include "framework/effects/build_world.h"
#include "framework/effects/drag/drag.h"
#include "framework/effects/joint/joint.h"
#include "framework/effects/point_force/point_force.h"
#include "framework/effects/rod/rod.h"
#include "framework/effects/spring/spring.h"
#include "framework/engines/judging/judge.h"
#include "framework/engines/stepping/energy_watch.h"
#include "framework/engines/stepping/loss_remedy.h"
#include "tests/engines/energy_losses.h"
#include "tests/engines/scenes.h"
#include "tests/engines/watched_runs.h"

namespace tumble::testing::energy_loss_test {
namespace {

double number_before(const std::string& words, const std::string& unit) {
  const std::size_t end = words.find(unit);
  if (end == std::string::npos) return kUnset;
  return std::stod(words.substr(words.rfind(' ', end - 1) + 1));
}

// ---- The ledger --------------------------------------------------------------------------------

/// A ball that moves in the world's plane at the speeds of three looks 1/60 s apart, beside a box
/// that lies still.
class ThreeLooks {
 public:
  explicit ThreeLooks(scene::Scene scene) : world_(build_world(scene)), watch_(1e-5, kStep, true) {}

  std::optional<RunFault> told_at(const std::vector<double>& speeds, int noted_before = -1,
                                  const std::function<void(engines::EnergyWatch&)>& note = {}) {
    for (std::size_t k = 0; k < speeds.size(); ++k) {
      if (static_cast<int>(k) == noted_before) note(watch_);
      std::vector<RigidBodyState> states;
      for (const WorldBody& body : world_.bodies) states.push_back(body.state);
      states[0].momentum_world.x() = world_.bodies[0].inertia.mass * speeds[k];
      watch_.look(static_cast<double>(k) * kStep, world_, states, {});
    }
    engines::RunCounters counters;
    watch_.tell(world_, test_laws(), counters);
    return lost_in(counters.watch.faults());
  }

  static constexpr double kStep = 1.0 / 60;

 private:
  World world_;
  engines::EnergyWatch watch_;
};

scene::Scene ball_and_box() {
  return scene_of({ball("ball", 0.5, 2.0, {0, 0, 2}, Vector3d::Zero()),
                   box("box", {0.1, 0.1, 0.1}, 1.0, {3, 0, 0.1}, Vector3d::Zero()),
                   plane("floor", Vector3d::Zero(), Vector3d::UnitZ())},
                  1.0, kDown);
}

// 2 kg at 1 m/s have 1 J. At 0.99 m/s 1.99 % are gone, at 0.996 m/s 0.8 %.
TEST(EnergyLost, IsToldAboveAHundredthOfWhatMoves) {
  const auto told = ThreeLooks(ball_and_box()).told_at({1.0, 1.0, 0.99});
  ASSERT_TRUE(told);
  EXPECT_EQ(told->subject, "'ball'");
  EXPECT_NEAR(told->worst, 1.0 - 0.99 * 0.99, 1e-12);  // rounding of a sum of energies
  EXPECT_NEAR(told->first_s, 2.0 / 60, 1e-12);
  EXPECT_NE(told->meaning.find("0.0199 J of the 1 J"), std::string::npos) << told->meaning;
  EXPECT_FALSE(ThreeLooks(ball_and_box()).told_at({1.0, 1.0, 0.996}));
}

// A height near 0 is rounded as the body's other coordinates are: of 2 kg at 0.5 m gravity makes
// 2 * 9.81 * 0.5 * 2.2e-16 = 2e-15 J of each rounding, and what moves with 1e-8 m/s has 1e-16 J.
// All of these may go; where nothing falls, and at 1e-4 m/s, none.
TEST(EnergyLost, IsNotWhatRoundingLeavesOfHeights) {
  const auto stops = [](double speed, bool falls) {
    scene::Scene scene = scene_of({ball("ball", 0.1, 2.0, {0.5, 0, 0}, Vector3d::Zero())}, 1.0);
    if (falls) effects::set_gravity(scene, kDown);
    return ThreeLooks(scene).told_at({speed, speed, 0.0});
  };
  EXPECT_FALSE(stops(1e-8, true));
  EXPECT_TRUE(stops(1e-8, false));
  EXPECT_TRUE(stops(1e-4, true));
}

// Nor where it comes back: a method whose energy swings is told of where it rises.
TEST(EnergyLost, IsNotWhatComesBack) {
  EXPECT_FALSE(ThreeLooks(ball_and_box()).told_at({1.0, 0.97, 1.0}));
  EXPECT_TRUE(ThreeLooks(ball_and_box()).told_at({1.0, 0.9, 0.91}));
}

// A body that is hit or touched may lose anything then, and nothing before and after; what touches
// another body says nothing of it.
TEST(EnergyLost, IsAskedOfNoBodyThatIsHitOrTouchedMeanwhile) {
  constexpr int kBall = 0, kBox = 1, kFloor = 2;
  const auto hit = [](int a, int b) {
    return [=](engines::EnergyWatch& watch) {
      watch.note(
          {0.03, EventKind::kCollision, a, b, Vector3d::Zero(), Vector3d::UnitZ(), 1.0, -1.0});
    };
  };
  const auto touched = [](int a, int b) {
    return [=](engines::EnergyWatch& watch) { watch.note_touch(a, b); };
  };
  for (const auto& made :
       {std::function<std::function<void(engines::EnergyWatch&)>(int, int)>(hit),
        std::function<std::function<void(engines::EnergyWatch&)>(int, int)>(touched)}) {
    EXPECT_FALSE(ThreeLooks(ball_and_box()).told_at({1.0, 1.0, 0.5}, 2, made(kBall, kFloor)));
    EXPECT_TRUE(ThreeLooks(ball_and_box()).told_at({1.0, 1.0, 0.5}, 1, made(kBall, kFloor)));
    EXPECT_TRUE(ThreeLooks(ball_and_box()).told_at({1.0, 1.0, 0.5, 0.5}, 3, made(kBall, kFloor)));
    EXPECT_TRUE(ThreeLooks(ball_and_box()).told_at({1.0, 1.0, 0.5}, 2, made(kBox, kFloor)));
  }
  // what is linked with it may give it anything
  scene::Scene linked = ball_and_box();
  linked.effects.of<effects::SpringSpec>().push_back(
      spring_between("ball", Vector3d::Zero(), "box", 1e-3, 3.5));
  EXPECT_FALSE(ThreeLooks(linked).told_at({1.0, 1.0, 0.5}, 2, touched(kBox, kFloor)));
}

// Of 1 J at 1 m/s drag of c takes c * 1 W: in a sixtieth of a second all that 0.99 m/s misses where
// c is 1.2 N s/m, a tenth of it at 0.12.
TEST(EnergyLost, IsWhatDragDoesNotTake) {
  const auto dragged = [](double linear) {
    scene::Scene scene = ball_and_box();
    scene.effects.of<effects::DragSpec>().push_back({"ball", linear, 0.0});
    return ThreeLooks(scene).told_at({1.0, 1.0, 0.99});
  };
  EXPECT_FALSE(dragged(1.2));
  EXPECT_TRUE(dragged(0.12));
}

// One anchor that is shaken is at rest in its frame; two that are shaken differently may take and
// give anything.
TEST(EnergyLost, IsNotAskedOfWhatIsLinkedWithBodiesThatMoveDifferently) {
  scene::Scene scene = ball_and_box();
  scene.bodies[2].motion.emplace();
  scene.bodies[2].motion->amplitude_m = {0, 0, 0.1};
  scene.effects.of<effects::SpringSpec>().push_back(
      spring_between("floor", Vector3d::Zero(), "ball", 1e-3, 2.0));
  EXPECT_TRUE(ThreeLooks(scene).told_at({1.0, 1.0, 0.5}));
  scene.bodies[2].motion->angular_frequency_rad_s = 5.0;
  EXPECT_TRUE(ThreeLooks(scene).told_at({1.0, 1.0, 0.5}));
  scene.effects.of<effects::SpringSpec>().push_back(
      spring_between("", Vector3d::Zero(), "ball", 1e-3, 2.0));
  EXPECT_FALSE(ThreeLooks(scene).told_at({1.0, 1.0, 0.5}));
}

// ---- Runs that lose -----------------------------------------------------------------------------

/// What a step of Runge and Kutta's method leaves of the energy of a swing that turns by x radians
/// in it: |1 + ix - x^2/2 - ix^3/6 + x^4/24|^2.
double kept_by_a_step(double x) { return 1.0 - std::pow(x, 6) / 72 + std::pow(x, 8) / 576; }

// Closed form: drawn by lot between a step that follows the swing and one that takes all. Told if,
// and only if, more than 1 % is gone, as much as is; and with the step that is named, not.
TEST(EnergyLost, BySpringsThatAreStiffForTheStep) {
  const Laws laws = reference_laws();
  Random random(20);
  int told = 0;
  for (int trial = 0; trial < 24; ++trial) {
    const double x = 0.15 * std::pow(15.0, random.unit()), mass = random.between(0.1, 10.0),
                 step = random.between(1e-3, 3e-2), frequency = x / step;
    const int steps = static_cast<int>(random.between(20, 200));
    const scene::Scene scene =
        swing(mass, mass * frequency * frequency, random.between(0.05, 0.5), step, step * steps);
    const double lost = 1.0 - std::pow(kept_by_a_step(x), steps);
    const std::string& engine = kEngines[static_cast<std::size_t>(trial) % kEngines.size()];
    // Frames of event engines lie between steps, on cubic paths: their velocities are off by up to
    // sqrt(3) x^3 / 216 of the swing's, its energy by twice that.
    const double of_paths = engine == "rd" ? 0.0 : std::sqrt(3.0) / 108 * std::pow(x, 3);
    if (std::abs(lost - engines::kEnergyLost) < 0.1 * engines::kEnergyLost + of_paths)
      continue;  // at the limit itself
    const Trajectory run = run_by(engine, scene, laws);
    const auto fault = lost_in(run);
    const std::string words = fmt::format("trial {}, {}: w h = {:.3g}, {} steps, {:.3g} lost{}",
                                          trial, engine, x, steps, lost, said(run));
    ASSERT_EQ(fault.has_value(), lost > engines::kEnergyLost) << words;
    if (!fault) continue;
    ++told;
    // noted where it has grown by a tenth (kSeen)
    EXPECT_LE(fault->worst, lost * (1 + 1e-9) + of_paths) << words;
    EXPECT_GE(fault->worst, lost / 1.11 - of_paths) << words;
    EXPECT_EQ(fault->subject, "'bob'");
    scene::Scene mended = scene;
    mended.step_s = number_before(fault->remedy, " s (\"step_s\")");
    ASSERT_LT(mended.step_s, scene.step_s) << fault->remedy;
    EXPECT_FALSE(lost_in(run_by(engine, mended, laws))) << words << fault->remedy;
  }
  EXPECT_GE(told, 6);  // the lot has drawn both
}

/// y' = f by Euler's implicit method, its equation solved by iteration: loses wherever it swings.
Laws with_implicit_euler(Laws laws) {
  laws.integrate_step = [](const OdeFunction& f, double t, const VectorXd& y, double h) {
    VectorXd end = y;
    for (int round = 0; round < 40; ++round) end = y + h * f(t + h, end);
    return end;
  };
  laws.integrator_source = "implicit Euler";
  return laws;
}

TEST(EnergyLost, HasTheOrderOfTheMethodsOwnDamping) {
  EXPECT_NEAR(engines::order_of_damping(reference_laws()), engines::kOrderOfMethods, 1e-9);
  // ln(1 + x^2) / x instead of x: 0.1 off at 0.4 rad
  EXPECT_NEAR(engines::order_of_damping(with_implicit_euler(reference_laws())), 1.0, 0.1);
}

// A body that only gravity acts on can go in closed forms, one that a force or drag acts on cannot.
TEST(EnergyLost, NamesClosedFormsOnlyWhereNothingButGravityActs) {
  scene::Scene scene = ball_and_box();
  const auto remedy = [&scene] {
    const engines::LostEnergy of_ball{{0}, 0.1, 1.0, 0.5, 1.0, false, false};
    return engines::told_of_loss(of_ball, build_world(scene), reference_laws(), 1.0 / 60).remedy;
  };
  EXPECT_NE(remedy().find("--propagator auto"), std::string::npos) << remedy();
  scene.effects.of<effects::PointForceSpec>().push_back({"box", {1, 0, 0}, {3, 0, 0.1}, 0.0, 1.0});
  EXPECT_NE(remedy().find("--propagator auto"), std::string::npos) << remedy();
  scene::Scene with_drag = scene;
  scene.effects.of<effects::PointForceSpec>().push_back({"ball", {1, 0, 0}, {0, 0, 2}, 0.0, 1.0});
  EXPECT_EQ(remedy().find("--propagator auto"), std::string::npos) << remedy();
  scene = with_drag;
  scene.effects.of<effects::DragSpec>().push_back({"ball", 0.1, 0.0});
  EXPECT_EQ(remedy().find("--propagator auto"), std::string::npos) << remedy();
}

/// Two arms that hang from the world on hinges across their plane, held out sideways.
scene::Scene double_pendulum(double angle, bool with_rods) {
  const Vector3d along(std::sin(angle), 0, -std::cos(angle));
  scene::Scene scene = scene_of({ball("upper", 0.1, 1.0, along, Vector3d::Zero()),
                                 ball("lower", 0.1, 1.0, 2.0 * along, Vector3d::Zero())},
                                2.0, kDown);
  for (scene::BodySpec& body : scene.bodies) body.collides = false;
  scene.step_s = 1.0 / 120;
  scene.stabilisation.emplace();
  if (with_rods) {
    scene.effects.of<effects::RodSpec>().push_back(
        {"first", {"upper", Vector3d::Zero()}, {"", Vector3d::Zero()}, 1.0});
    scene.effects.of<effects::RodSpec>().push_back(
        {"second", {"lower", Vector3d::Zero()}, {"upper", Vector3d::Zero()}, 1.0});
    return scene;
  }
  effects::JointSpec first, second;
  first.name = "first";
  second.name = "second";
  first.kind = second.kind = effects::JointKind::kHinge;
  first.axis = second.axis = Vector3d::UnitY();
  first.body_a = "upper";
  second.body_a = "lower";
  second.body_b = "upper";
  second.point_m = along;
  scene.effects.of<effects::JointSpec>() = {first, second};
  return scene;
}

// The same arms lose by a method that damps, and keep what they have by one that does not.
TEST(EnergyLost, ByAMethodThatDampsPendulums) {
  const Laws laws = reference_laws(), damping = with_implicit_euler(laws);
  for (const bool with_rods : {false, true})
    for (const std::string& engine : kEngines) {
      const scene::Scene scene = double_pendulum(0.6, with_rods);
      const Trajectory right = run_by(engine, scene, laws), wrong = run_by(engine, scene, damping);
      EXPECT_FALSE(lost_in(right)) << engine << said(right);
      const auto fault = lost_in(wrong);
      ASSERT_TRUE(fault) << engine << said(wrong);
      EXPECT_EQ(fault->subject, "'upper' and 'lower'");
      EXPECT_NE(fault->remedy.find("a step of at most"), std::string::npos) << fault->remedy;
      // a check that failed, so that it stands in tables, pages and the exit code
      const auto checks = engines::judge_run(scene, wrong);
      ASSERT_FALSE(checks.empty());
      EXPECT_EQ(checks.back().kind, "energy_lost");
      EXPECT_FALSE(checks.back().passed);
    }
}

// Beside bodies that lie on the floor and slide, which may lose what they have. 30 steps of
// w h = 1.18 leave 0.39 of what swings along the spring (kept_by_a_step).
TEST(EnergyLost, IsNotHiddenByOthersThatLoseRightly) {
  scene::Scene scene = swing(2.0, 1e4, 0.1, 1.0 / 60, 0.5);
  scene.bodies.push_back(plane("floor", {0, 0, -1}, Vector3d::UnitZ()));
  scene.bodies.push_back(
      box("sliding", Vector3d::Constant(0.1), 50.0, {0, 3, -0.9}, {2.0, 0.5, 0}));
  scene.bodies[1].friction = scene.bodies[2].friction = 0.5;
  effects::set_gravity(scene, Vector3d(0, 0, -9.81));
  scene.contact.emplace();
  for (const std::string& engine : kEngines) {
    const Trajectory run = run_by(engine, scene);
    const auto fault = lost_in(run);
    ASSERT_TRUE(fault) << engine << said(run);
    EXPECT_EQ(fault->subject, "'bob'") << engine;
  }
}

}  // namespace
}  // namespace tumble::testing::energy_loss_test
