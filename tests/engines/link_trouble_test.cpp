// Springs, rods, contacts and callbacks that misbehave end the run with body, time and effect; what
// was recorded before stays. Energy that nothing brings in ends it with the effect that most likely
// does.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "framework/dynamics/stopped_run.h"
#include "framework/effects/drag/drag.h"
#include "framework/effects/rod/rod.h"
#include "framework/effects/spring/spring.h"
#include "framework/engines/base/guarded_laws.h"
#include "framework/truths/memory_scene.h"
#include "tests/engines/effect_scenes.h"
#include "tests/engines/reference_laws.h"

namespace tumble::testing {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kHalf = 0.5;  // s: laws go wrong then

void expect_stopped(const Trajectory& result, const std::vector<std::string>& words, double from,
                    double to) {
  for (const std::string& word : words)
    EXPECT_NE(result.stopped_by.find(word), std::string::npos)
        << "no \"" << word << "\" in: " << result.stopped_by;
  ASSERT_FALSE(result.frames.empty());
  EXPECT_GE(result.frames.back().time, from) << result.stopped_by;
  EXPECT_LE(result.frames.back().time, to) << result.stopped_by;
  for (const Frame& frame : result.frames)
    for (const BodyPose& pose : frame.poses)
      EXPECT_TRUE(pose.com_world.allFinite() && pose.velocity_world.allFinite() &&
                  pose.omega_world.allFinite())
          << frame.time;
}

/// A bob on a spring or on a rod, under gravity, for a second.
scene::Scene swinging(const std::string& link) {
  scene::Scene scene =
      scene_of({ball("bob", 0.1, 1.0, {1.0, 0, 0}, Vector3d::Zero())}, 1.0, Vector3d(0, 0, -9.81));
  if (link == "spring")
    scene.effects.of<effects::SpringSpec>().push_back(
        {"coil", {"", Vector3d::Zero()}, {"bob", Vector3d::Zero()}, 50.0, 0.0, 0.8});
  if (link == "drag") scene.effects.of<effects::DragSpec>().push_back({"bob", 0.5, 0.0});
  if (link == "rod" || link == "stabilised rod") {
    scene.effects.of<effects::RodSpec>().push_back(
        {"wire", {"", Vector3d::Zero()}, {"bob", Vector3d::Zero()}, 1.0});
    scene.stabilisation.emplace();
    if (link == "stabilised rod") scene.stabilisation->kind = scene::StabilisationKind::kBaumgarte;
  }
  return scene;
}

/// Laws that know what time it is: by the integration that is asked for.
struct Clock {
  double now = 0.0;
  Laws laws = reference_laws();
  Clock() {
    laws.integrate_step = [this, step = laws.integrate_step](const OdeFunction& f, double t,
                                                             const VectorXd& y, double h) {
      now = t;
      return step(f, t, y, h);
    };
  }
  bool is_late() const { return now >= kHalf; }
};

// A step that runs away within itself asks for rows and forces of bodies beyond all numbers: no law
// of a link is blamed for what it cannot answer.
TEST(LinkTrouble, ALawIsNotBlamedForBodiesThatHaveRunAway) {
  for (const auto& [link, far] : {std::pair<std::string, double>{"rod", 1e200},
                                  {"rod", std::numeric_limits<double>::infinity()},
                                  {"spring", std::numeric_limits<double>::infinity()}}) {
    Laws laws = reference_laws();
    laws.integrate_step = [step = laws.integrate_step, far](const OdeFunction& f, double t,
                                                            const VectorXd& y,
                                                            double h) -> VectorXd {
      if (t < kHalf) return step(f, t, y, h);
      return y + h * f(t, VectorXd(far * y));
    };
    const Trajectory result = run(swinging(link), laws);
    expect_stopped(result, {"bob", link + " '", "the steps have run away"}, kHalf - 0.1,
                   kHalf + 0.1);
    for (const char* law : {"rod_row", "spring_force"})
      EXPECT_EQ(result.stopped_by.find(law), std::string::npos) << result.stopped_by;
  }
}

TEST(LinkTrouble, ASpringForceThatIsNotANumberIsNamed) {
  Clock clock;
  clock.laws.spring_force = [&, right = clock.laws.spring_force](
                                const Spring& spring, const AnchorState& a, const AnchorState& b) {
    return clock.is_late() ? Vector3d(Vector3d::Constant(kNaN)) : right(spring, a, b);
  };
  expect_stopped(run(swinging("spring"), clock.laws),
                 {"t = 0.5", "'bob'", "spring 'coil'", "spring_force", "not a number"}, 0.45, 0.55);
}

TEST(LinkTrouble, ARodsRowThatIsNotANumberIsNamed) {
  for (double ConstraintRow::*part :
       {&ConstraintRow::value, &ConstraintRow::rate, &ConstraintRow::velocity_product}) {
    Clock clock;
    clock.laws.set<effects::RodRow>([&, part, right = clock.laws.of<effects::RodRow>()](
                                        const Body& a, const Vector3d& point_a, const Body& b,
                                        const Vector3d& point_b, double length) {
      ConstraintRow row = right(a, point_a, b, point_b, length);
      if (clock.is_late()) row.*part = kNaN;
      return row;
    });
    expect_stopped(run(swinging("rod"), clock.laws),
                   {"t = 0.5", "'bob'", "rod 'wire'", "rod_row", "not a number"}, 0.45, 0.55);
  }
}

TEST(LinkTrouble, ARodThatIsNeverANumberIsNamedAtTheStart) {
  Laws laws = reference_laws();
  laws.set<effects::RodRow>([](const Body&, const Vector3d&, const Body&, const Vector3d&, double) {
    ConstraintRow row{};
    row.value = kNaN;
    return row;
  });
  const Trajectory result = run(swinging("rod"), laws);
  for (const char* word : {"t = 0.000000", "'bob'", "rod 'wire'", "rod_row"})
    EXPECT_NE(result.stopped_by.find(word), std::string::npos) << result.stopped_by;
}

TEST(LinkTrouble, MultipliersThatAreNotNumbersAreNamed) {
  Clock clock;
  clock.laws.constraint_multipliers = [&, right = clock.laws.constraint_multipliers](
                                          const std::vector<Constraint>& rows,
                                          const std::vector<ConstrainedBody>& bodies,
                                          const VectorXd& wanted) {
    return clock.is_late() ? VectorXd(VectorXd::Constant(wanted.size(), kNaN))
                           : right(rows, bodies, wanted);
  };
  expect_stopped(run(swinging("rod"), clock.laws),
                 {"t = 0.5", "'bob'", "rods and joints", "constraint_multipliers", "not a number"},
                 0.45, 0.55);
}

TEST(LinkTrouble, ACorrectionThatIsNotANumberIsNamed) {
  Clock clock;
  clock.laws.constraint_correction = [&, right = clock.laws.constraint_correction](
                                         const std::vector<Constraint>& rows,
                                         const std::vector<ConstrainedBody>& bodies,
                                         const VectorXd& error) {
    const VectorXd change = right(rows, bodies, error);
    return clock.is_late() ? VectorXd(VectorXd::Constant(change.size(), kNaN)) : change;
  };
  expect_stopped(run(swinging("rod"), clock.laws),
                 {"t = 0.5", "'bob'", "rods and joints", "constraint_correction", "not a number"},
                 0.45, 0.55);
}

TEST(LinkTrouble, BaumgartesTermThatIsNotANumberIsNamed) {
  Clock clock;
  clock.laws.baumgarte_acceleration = [&, right = clock.laws.baumgarte_acceleration](
                                          double value, double rate, double T) {
    return clock.is_late() ? kNaN : right(value, rate, T);
  };
  expect_stopped(run(swinging("stabilised rod"), clock.laws),
                 {"t = 0.5", "'bob'", "rods and joints", "baumgarte_acceleration", "not a number"},
                 0.45, 0.55);
}

// Drag is the framework's: what can go wrong is what it is evaluated in.
TEST(LinkTrouble, ADraggedBodysMotionThatIsNotANumberIsNamed) {
  Clock clock;
  clock.laws.state_derivative = [&, right = clock.laws.state_derivative](
                                    const RigidBodyState& state, const Inertia& inertia,
                                    const Wrench& wrench) {
    return clock.is_late() ? VectorXd(VectorXd::Constant(kStateSize, kNaN))
                           : right(state, inertia, wrench);
  };
  expect_stopped(run(swinging("drag"), clock.laws),
                 {"t = 0.5", "'bob'", "integration", "rigid_body_derivative", "not a number"}, 0.45,
                 0.55);
}

TEST(LinkTrouble, AContactForceThatIsNotANumberIsNamed) {
  Clock clock;
  clock.laws.contact_forces = [&, right = clock.laws.contact_forces](const MatrixXd& A,
                                                                     const VectorXd& b) {
    return clock.is_late() ? VectorXd(VectorXd::Constant(b.size(), kNaN)) : right(A, b);
  };
  scene::Scene scene = scene_of({box("crate", {0.5, 0.5, 0.5}, 1.0, {0, 0, 0.5}, Vector3d::Zero()),
                                 plane("floor", Vector3d::Zero(), Vector3d::UnitZ())},
                                1.0, Vector3d(0, 0, -9.81));
  for (scene::BodySpec& body : scene.bodies) body.restitution = 0.0;
  scene.contact.emplace();
  expect_stopped(run(scene, clock.laws),
                 {"t = 0.5", "'crate'", "persistent contact", "contact_forces", "not a number"},
                 0.45, 0.55);
}

TEST(LinkTrouble, ALawIsNotBlamedForWhatItWasGivenThatIsNoNumber) {
  Laws answering = reference_laws();
  answering.contact_forces = [](const MatrixXd&, const VectorXd& b) { return b; };
  const Laws laws = engines::guarded(answering);
  const auto why = [](const auto& ask) -> std::string {
    try {
      ask();
    } catch (const StoppedRun& stop) {
      return stop.what();
    }
    return "no stop";
  };
  std::vector<Constraint> rows(1);
  rows[0].body_b = 1;
  rows[0].row.jacobian_a << 1, 0, 0, 0, 0, 0;
  rows[0].row.jacobian_b = -rows[0].row.jacobian_a;
  rows[0].row.value = rows[0].row.rate = rows[0].row.velocity_product = 0.0;
  std::vector<ConstrainedBody> bodies(2, {1.0, Matrix3d::Identity(), Vector6d::Zero()});
  const VectorXd none = VectorXd::Zero(1);
  EXPECT_EQ(why([&] { laws.constraint_multipliers(rows, bodies, none); }), "no stop");
  EXPECT_EQ(why([&] { laws.constraint_correction(rows, bodies, none); }), "no stop");
  bodies[0].free_acceleration[0] = kNaN;
  rows[0].row.jacobian_a[0] = kNaN;
  const VectorXd no_number = VectorXd::Constant(1, kNaN);
  const MatrixXd one = MatrixXd::Identity(1, 1);
  for (const std::string& stopped :
       {why([&] { laws.constraint_multipliers(rows, bodies, none); }),
        why([&] { laws.constraint_correction(rows, bodies, no_number); }),
        why([&] { laws.contact_forces(one, no_number); })}) {
    EXPECT_EQ(stopped.find("returned"), std::string::npos) << stopped;
    EXPECT_NE(stopped.find("the steps have run away"), std::string::npos) << stopped;
  }
}

TEST(LinkTrouble, ACallbackThatLeavesNoNumbersOrThrowsIsNamed) {
  using Act = void (*)(int, RigidBodyState&);
  const std::pair<Act, const char*> wrongs[] = {
      {[](int, RigidBodyState& state) { state.momentum_world.x() = kNaN; }, "not a number"},
      {[](int, RigidBodyState&) { throw std::runtime_error("no such valve"); }, "no such valve"}};
  for (const char* engine : {"rd", "ordered", "ca"})
    for (const auto& [act, word] : wrongs)
      for (const double duration : {1.0, kHalf}) {  // and at the very end
        engines::RunOptions options;
        options.engine = engine;
        options.callbacks.push_back({kHalf, {0}, act});
        scene::Scene scene = bare();
        scene.duration_s = duration;
        expect_stopped(run_with(scene, reference_laws(), options),
                       {"t = 0.5", "'a'", "callback", word}, 0.45, 0.55);
      }
}

// ---- Energy from nowhere -----------------------------------------------------------------------

void expect_runaway(const scene::Scene& scene, const Laws& laws,
                    const std::vector<std::string>& words) {
  const Trajectory result = run(scene, laws);
  std::vector<std::string> all = words;
  all.push_back("runaway energy");
  expect_stopped(result, all, 0.0, scene.duration_s - 0.01);
}

TEST(LinkTrouble, EnergyOfASpringThatPushesIsTheSprings) {
  Laws laws = reference_laws();
  laws.spring_force = [right = laws.spring_force](const Spring& spring, const AnchorState& a,
                                                  const AnchorState& b) {
    return Vector3d(-right(spring, a, b));
  };
  scene::Scene scene = swinging("spring");
  scene.duration_s = 5.0;
  expect_runaway(scene, laws, {"'bob'", "comes from spring 'coil'", "spring_force"});
}

// A rod that pushes the faster the longer it grows: what is left of a rate grows as exp(5 t).
TEST(LinkTrouble, EnergyOfARodThatFeedsItsOwnErrorIsTheRods) {
  Laws laws = reference_laws();
  laws.constraint_multipliers = [right = laws.constraint_multipliers](
                                    const std::vector<Constraint>& rows,
                                    const std::vector<ConstrainedBody>& bodies,
                                    const VectorXd& wanted) {
    VectorXd multipliers = right(rows, bodies, wanted);
    for (std::size_t k = 0; k < rows.size(); ++k)
      multipliers[static_cast<Eigen::Index>(k)] += 5.0 * rows[k].row.rate;
    return multipliers;
  };
  scene::Scene scene = swinging("rod");
  scene.bodies[0].velocity_m_s = {0.1, 0, 0};
  scene.duration_s = 20.0;
  scene.stabilisation->kind = scene::StabilisationKind::kNone;
  expect_runaway(scene, laws, {"'bob'", "comes from rod 'wire'", "constraint_multipliers"});
}

TEST(LinkTrouble, EnergyOfImpactsIsTheCollisions) {
  Laws laws = reference_laws();
  laws.collision_impulse = [right = laws.collision_impulse](const Contact& contact, const Body& a,
                                                            const Body& b, double e) {
    return 1.5 * right(contact, a, b, e);
  };
  std::vector<scene::BodySpec> bodies{ball("ball", 0.1, 1.0, {0, 0, 0}, {1, 0, 0}),
                                      plane("left", {-1, 0, 0}, Vector3d::UnitX()),
                                      plane("right", {1, 0, 0}, -Vector3d::UnitX())};
  for (scene::BodySpec& body : bodies) body.restitution = 1.0;
  expect_runaway(scene_of(bodies, 20.0), laws,
                 {"'ball'", "comes from collision", "collision_impulse"});
}

TEST(LinkTrouble, EnergyOfAnIntegrationIsTheIntegrations) {
  Laws laws = reference_laws();
  laws.integrate_step = [right = laws.integrate_step](const OdeFunction& f, double t,
                                                      const VectorXd& y, double h) -> VectorXd {
    return (1 + h) * right(f, t, y, h);
  };
  expect_runaway(scene_of({ball("ball", 0.1, 1.0, {0, 0, 0}, {1, 0, 0})}, 20.0), laws,
                 {"'ball'", "comes from integration", "rk4_step"});
}

// A stage of RK4 stands off unit length, and R of such a quaternion tilts L: a stick of 1 m by 2 cm
// turns that into spin along its axis, and was a radian off after a second.
TEST(LinkTrouble, ADragOfNextToNothingTurnsNoStick) {
  scene::Scene scene =
      scene_of({box("stick", {0.5, 0.01, 0.01}, 1.0, Vector3d::Zero(), Vector3d::Zero())}, 1.0);
  scene.step_s = 1.0 / 60;
  scene.bodies[0].omega_world_rad_s = {0, 3, 4};
  const Trajectory free = run(scene, reference_laws());
  scene.effects.of<effects::DragSpec>().push_back({"stick", 1e-12, 1e-12});
  const Trajectory dragged = run(scene, reference_laws());
  const auto at_end = [](const Trajectory& of) { return of.frames.back().poses[0]; };
  ASSERT_EQ(dragged.stopped_by, "");
  // RK4's own error at w h = 1/12 is 60 (w h)^5 / 2880 = 8e-8 rad
  EXPECT_LT(at_end(free).world_from_body.angularDistance(at_end(dragged).world_from_body), 1e-6);
}

}  // namespace
}  // namespace tumble::testing
