// The largest step that a method can take is told where a run starts: for drag, Baumgarte's term
// and light bodies on rods, against closed forms.
#include <cmath>

#include <gtest/gtest.h>

#include "framework/core/decompositions.h"
#include "framework/core/error.h"
#include "framework/dynamics/methods.h"
#include "framework/effects/build_world.h"
#include "framework/effects/drag/drag.h"
#include "framework/effects/joint/joint.h"
#include "framework/effects/spring/spring.h"
#include "framework/engines/stepping/stability.h"
#include "framework/truths/memory_scene.h"
#include "tests/engines/reference_laws.h"

namespace tumble::testing {
namespace {

// Ends of the ranges of y' = -l y and y'' = -w^2 y. Euler: l h = 2. RK4: the real root of 1 - z +
// z^2/2 - z^3/6 + z^4/24 = 1, and w h = sqrt(8).
constexpr double kEulerDecay = 2.0, kRk4Decay = 2.785293563405282;
const double kRk4Swing = std::sqrt(8.0);

std::optional<engines::StepLimit> judge_rods_of(const scene::Scene& scene,
                                                const std::vector<double>& tensions,
                                                const Laws& laws, double step) {
  const World world = build_world(scene);
  return engines::judge_rods(world, engines::Carriers(world).all, tensions, laws, step);
}

// of the step: a method counts as stable up to 1e-9 above 1, and its amplification rises by about h
// / 1 s there
constexpr double kFound = 1e-6;
constexpr double kUnder = 0.99, kOver = 1.01;

Laws euler() {
  Laws laws = reference_laws();
  laws.integrate_step = [](const OdeFunction& f, double t, const VectorXd& y,
                           double h) -> VectorXd { return y + h * f(t, y); };
  return laws;
}

/// By steps of `step` for 2000 of them. @return why it was refused, or what was told of it at the
/// start
std::string answer(scene::Scene scene, const Laws& laws, double step) {
  scene.step_s = step;
  scene.duration_s = 2000 * step;
  TrajectoryRecorder recorder;
  engines::RunOptions options;
  options.frame_rate_hz = 1.0 / scene.duration_s;
  try {
    engines::run_scene(scene, laws, options, recorder);
  } catch (const UserError& refusal) {
    return std::string("refused: ") + refusal.what();
  }
  std::string told;
  for (const std::string& notice : recorder.trajectory().counters.notices) told += notice + '\n';
  return told;
}

bool holds(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// A body of 0.5 kg, moments 1, 2 and 3 kg m^2, in treacle.
scene::Scene dragged(double linear, double angular) {
  scene::BodySpec body = ball("spoon", 0.1, 0.5, Vector3d::Zero(), {1, 0, 0});
  body.inertia_body_kg_m2 = Vector3d(1, 2, 3).asDiagonal();
  body.omega_world_rad_s = {0.1, 0, 0};
  scene::Scene scene = scene_of({body}, 1.0);
  scene.effects.of<effects::DragSpec>().push_back({"spoon", linear, angular});
  return scene;
}

void expect_limit(const scene::Scene& scene, const Laws& laws, double largest,
                  const std::vector<std::string>& words) {
  EXPECT_EQ(answer(scene, laws, kUnder * largest), "");
  const std::string refusal = answer(scene, laws, kOver * largest);
  EXPECT_TRUE(refusal.starts_with("refused: ")) << refusal;
  for (const std::string& word : words)
    EXPECT_TRUE(holds(refusal, word)) << word << " in: " << refusal;
  const auto limits = engines::judge_decays(build_world(scene), laws, kOver * largest);
  ASSERT_EQ(limits.size(), 1u);
  EXPECT_NEAR(limits[0].largest_step, largest, kFound * largest);
}

TEST(LargestStep, DragIsRefusedFromTheStepAtWhichItsDecayGrows) {
  constexpr double kDrag = 50.0;  // N s/m over 0.5 kg: 100 1/s
  expect_limit(dragged(kDrag, 0.0), euler(), kEulerDecay / 100.0,
               {"drag", "'spoon'", "velocity", "at most 0.02 s"});
  expect_limit(dragged(kDrag, 0.0), reference_laws(), kRk4Decay / 100.0,
               {"drag", "'spoon'", "velocity", "at most 0.02785 s"});
  // the least moment
  expect_limit(dragged(0.0, kDrag), euler(), kEulerDecay / 50.0,
               {"drag", "'spoon'", "turning", "at most 0.04 s"});
  expect_limit(dragged(0.0, kDrag), reference_laws(), kRk4Decay / 50.0,
               {"drag", "'spoon'", "turning", "at most 0.05571 s"});
}

// A step of the command line has no line in the scene's file.
TEST(LargestStep, IsRefusedAtTheLineOfTheScenesStepInEachEngine) {
  scene::Scene scene =
      scene_of({ball("bob", 0.1, 1.0, {2, 0, 0}, Vector3d::Zero())}, 10.0, std::nullopt);
  effects::SpringSpec spring{"spring", {"", Vector3d::Zero()}, {"bob", Vector3d::Zero()}};
  spring.stiffness_n_m = 1e6;  // w h = 16.7
  spring.rest_length_m = 1.0;
  scene.effects.of<effects::SpringSpec>().push_back(spring);
  scene.file = "mine.json";
  scene.step_s = 1.0 / 60;
  scene.lines = {{"", 1}, {"/step_s", 4}};
  for (const std::string engine : {"rd", "ordered"})
    for (const bool is_given : {false, true}) {
      TrajectoryRecorder recorder;
      engines::RunOptions options;
      options.engine = engine;
      if (is_given) options.step_s = 1.0 / 50;
      try {
        engines::run_scene(scene, reference_laws(), options, recorder);
        FAIL() << engine;
      } catch (const UserError& refusal) {
        EXPECT_EQ(refusal.where(), is_given ? "mine.json" : "mine.json:4: /step_s") << engine;
      }
    }
}

// A kick takes (1 - l h) of a velocity; two of half a step, the second by what the first has left,
// (1 - l h / 2)^2.
TEST(LargestStep, DragIsRefusedForMethodsThatKickVelocities) {
  for (const auto& [method, largest] : {std::pair{"symplectic", 2.0}, std::pair{"verlet", 4.0}}) {
    Laws laws = reference_laws();
    laws.integrate_step = step_of(method_named(method), 0.0);
    expect_limit(dragged(50.0, 0.0), laws, largest / 100.0, {"drag", "'spoon'", "velocity"});
  }
}

// A bar on a hinge cannot turn about itself, where drag would take its least moment's spin at 750
// 1/s: 2.7 times what RK4 can follow.
TEST(LargestStep, OfATurningThatAJointHoldsIsNone) {
  scene::BodySpec bar = ball("bar", 0.1, 1.0, {0.5, 0, 0}, Vector3d::Zero());
  bar.inertia_body_kg_m2 = Vector3d(6.67e-5, 0.0833667, 0.0833667).asDiagonal();
  bar.collides = false;
  scene::Scene scene = scene_of({bar}, 1.0, Vector3d(0, 0, -9.81));
  scene.effects.of<effects::JointSpec>().push_back(
      {"pin", effects::JointKind::kHinge, "bar", "", Vector3d::Zero(), Vector3d::UnitY()});
  scene.effects.of<effects::DragSpec>().push_back({"bar", 0.0, 0.05});
  EXPECT_EQ(answer(scene, reference_laws(), 1.0 / 120), "");
  scene.effects.of<effects::JointSpec>().clear();
  EXPECT_TRUE(holds(answer(scene, reference_laws(), 1.0 / 120), "refused"));
}

// ---- Springs and their dampers -----------------------------------------------------------------

/// A ball of 0.5 kg on a spring of no length to the world, pulled 1 m along it.
scene::Scene on_springs(const std::vector<std::pair<double, double>>& stiffness_and_damping) {
  scene::Scene scene =
      scene_of({ball("weight", 0.1, 0.5, Vector3d::UnitX(), Vector3d::Zero())}, 1.0);
  for (const auto& [k, c] : stiffness_and_damping)
    scene.effects.of<effects::SpringSpec>().push_back(
        {"spring " + std::to_string(scene.effects.of<effects::SpringSpec>().size() + 1),
         {"", Vector3d::Zero()},
         {"weight", Vector3d::Zero()},
         k,
         c,
         0.0});
  return scene;
}

/// Of two roots of r^2 - d r + w^2 = 0 that are real, the faster one [1/s].
double faster_root(double k, double c, double m) {
  return 0.5 * (c / m + std::sqrt(c * c / (m * m) - 4.0 * k / m));
}

void expect_damper_limit(const scene::Scene& scene, const Laws& laws, double largest,
                         const std::string& spring) {
  EXPECT_EQ(answer(scene, laws, kUnder * largest), "");
  const std::string refusal = answer(scene, laws, kOver * largest);
  EXPECT_TRUE(refusal.starts_with("refused: ") &&
              holds(refusal, "damper of spring '" + spring + "'") && holds(refusal, "less damping"))
      << refusal;
  const auto limit = engines::judge_dampers(build_world(scene), laws, kOver * largest);
  ASSERT_TRUE(limit);
  EXPECT_NEAR(limit->largest_step, largest, kFound * largest);
}

// What overshoots nothing still has a rate; stiffness 0 is a damper alone, and of two springs side
// by side constants add.
TEST(LargestStep, OfWhatADamperTakesIsItsFasterRoot) {
  for (const auto& [k, c] : {std::pair{0.0, 50.0}, std::pair{10.0, 50.0}, std::pair{1000.0, 50.0},
                             std::pair{1.0, 1e6}}) {
    const double rate = faster_root(k, c, 0.5);
    expect_damper_limit(on_springs({{k, c}}), reference_laws(), kRk4Decay / rate, "spring 1");
    expect_damper_limit(on_springs({{k, c}}), euler(), kEulerDecay / rate, "spring 1");
  }
  expect_damper_limit(on_springs({{500.0, 0.0}, {0.0, 50.0}}), reference_laws(),
                      kRk4Decay / faster_root(500.0, 50.0, 0.5), "spring 2");
}

// A door's spring beside its hinge: w^2 = k d^2 / I there, though the door alone would swing on it
// with k (1/m + r^2 / I_com), 1e6 times that.
TEST(LargestStep, OfASpringOnAHingedBodyIsThatOfTheSwingItsHingeAllows) {
  const double m = 2.0, r = 0.5, d = 1e-3, k = 1e7, moment = 0.2,
               frequency = std::sqrt(k * d * d / (moment + m * r * r));
  for (const effects::JointKind kind : {effects::JointKind::kHinge, effects::JointKind::kBall}) {
    scene::BodySpec door = ball("door", r, m, {r, 0, 0}, Vector3d::Zero());
    door.inertia_body_kg_m2 = moment * Matrix3d::Identity();
    door.collides = false;
    scene::Scene scene = scene_of({door}, 1.0);
    scene.effects.of<effects::JointSpec>().push_back(
        {"pin", kind, "door", "", Vector3d::Zero(), Vector3d::UnitY()});
    scene.effects.of<effects::SpringSpec>().push_back(
        {"closer", {"", Vector3d(d, 0, 1.0)}, {"door", Vector3d(d - r, 0, 0)}, k, 0.0, 1.0});
    const auto judged = engines::judge_springs(build_world(scene), reference_laws(), 0.1);
    ASSERT_TRUE(judged);
    // rounding of 1e-6 of what the hinge holds
    EXPECT_NEAR(judged->angular_frequency, frequency, 1e-6 * frequency);
    EXPECT_EQ(answer(scene, reference_laws(), kUnder * kRk4Swing / frequency), "");
    EXPECT_TRUE(holds(answer(scene, reference_laws(), kOver * kRk4Swing / frequency), "refused"));
    scene.effects.of<effects::JointSpec>().clear();
    EXPECT_TRUE(holds(answer(scene, reference_laws(), kUnder * kRk4Swing / frequency), "refused"));
  }
}

// A net of more bodies than are factorised together is judged too, spring by spring: n equal
// springs in a row have 2 sqrt(k / m) sin(pi n / (2 n + 2)).
TEST(LargestStep, OfManySpringsIsThatOfTheRow) {
  for (const int n : {5, 100, 600}) {
    scene::Scene scene = scene_of({}, 1.0);
    for (int i = 0; i < n; ++i) {
      scene.bodies.push_back(
          ball("bead" + std::to_string(i), 0.01, 0.5, Vector3d(i + 1, 0, 0), Vector3d::Zero()));
      scene.effects.of<effects::SpringSpec>().push_back(
          {"spring" + std::to_string(i),
           {i == 0 ? "" : scene.bodies[static_cast<std::size_t>(i) - 1].name, Vector3d::Zero()},
           {scene.bodies.back().name, Vector3d::Zero()},
           200.0,
           0.0,
           1.0});
    }
    scene.effects.of<effects::SpringSpec>().push_back({"last",
                                                       {scene.bodies.back().name, Vector3d::Zero()},
                                                       {"", Vector3d(n + 1, 0, 0)},
                                                       200.0,
                                                       0.0,
                                                       1.0});
    const auto judged = engines::judge_springs(build_world(scene), reference_laws(), 0.1);
    ASSERT_TRUE(judged);
    const double exact = 40.0 * std::sin(M_PI * n / (2.0 * n + 2.0));
    // row sums are a bound, met by a long row
    EXPECT_NEAR(judged->angular_frequency, exact, n > 400 ? 1e-4 * exact : 1e-10 * exact) << n;
    EXPECT_FALSE(engines::judge_dampers(build_world(scene), reference_laws(), 0.1));
  }
}

// e'' = -e / T^2 - 2 e' / T dies away at the double rate 1 / T.
TEST(LargestStep, BaumgartesTermIsRefusedFromTheStepAtWhichErrorsGrow) {
  scene::Scene scene = truths::straight_chain({1.0}, 1.0, -Vector3d::UnitZ(), Vector3d(0, 0, -1.0));
  scene.stabilisation->kind = scene::StabilisationKind::kBaumgarte;
  scene.stabilisation->time_constant_s = 0.05;
  expect_limit(scene, euler(), kEulerDecay * 0.05, {"Baumgarte", "0.05 s", "at most 0.1 s"});
  expect_limit(scene, reference_laws(), kRk4Decay * 0.05,
               {"Baumgarte", "0.05 s", "at most 0.1393 s"});
}

TEST(LargestStep, ProjectionHasNoSuchStep) {
  const scene::Scene scene =
      truths::straight_chain({1.0}, 1.0, -Vector3d::UnitZ(), Vector3d(0, 0, -1.0));
  EXPECT_TRUE(engines::judge_decays(build_world(scene), reference_laws(), 1.0).empty());
}

// Two bobs of m and r m on rods of equal lengths: the faster swing has w^2 = (g/l) (1 + r + sqrt(r
// (1 + r))).
TEST(LargestStep, ALightBodyAboveAHeavyOneIsReportedWithTheLargestStep) {
  const double g = 9.81, l = 0.7;
  for (const double ratio : {100.0, 1e4, 1e6}) {
    const scene::Scene scene =
        truths::straight_chain({1.0, ratio}, l, -Vector3d::UnitZ(), Vector3d(0, 0, -g));
    const double largest =
        kRk4Swing / std::sqrt(g / l * (1 + ratio + std::sqrt(ratio * (1 + ratio))));
    EXPECT_EQ(answer(scene, reference_laws(), kUnder * largest), "") << ratio;
    const std::string told = answer(scene, reference_laws(), kOver * largest);
    EXPECT_TRUE(holds(told, "across its rods") && holds(told, "'" + scene.bodies[0].name + "'"))
        << told;
    const std::vector<double> tensions = {(1 + ratio) * g, ratio * g};
    const auto limit = judge_rods_of(scene, tensions, reference_laws(), kOver * largest);
    ASSERT_TRUE(limit);
    // a swing's amplification leaves 1 by (w h)^6 / 144 times what the step is over
    EXPECT_NEAR(limit->largest_step, largest, 1e-5 * largest) << ratio;
  }
}

// A bob on a joint of the world is a pendulum, w^2 = m g d / (I + m d^2), however small its own
// moment is. With a hinge, d is across the axis: where its point lies far along it, the pendulum is
// the same, and the bound must not pass over its swing.
TEST(LargestStep, OfABobOnAJointThatStaysIsThatOfItsPendulum) {
  const double g = 9.81, m = 1.0, d = 0.5;
  for (const double moment : {1e-9, 1e-5, 0.1}) {
    const double largest = kRk4Swing / std::sqrt(m * g * d / (moment + m * d * d));
    for (const auto kind : {effects::JointKind::kBall, effects::JointKind::kHinge}) {
      scene::BodySpec bob = ball("bob", 0.01, m, {0, 0, -d}, Vector3d::Zero());
      bob.inertia_body_kg_m2 = moment * Matrix3d::Identity();
      scene::Scene scene = scene_of({bob}, 1.0, Vector3d(0, 0, -g));
      scene.effects.of<effects::JointSpec>().push_back(
          {"pin", kind, "bob", "", Vector3d::Zero(), Vector3d::UnitY()});
      EXPECT_EQ(answer(scene, reference_laws(), kUnder * largest), "") << moment;
      EXPECT_TRUE(holds(answer(scene, reference_laws(), kOver * largest), "swing of body 'bob'"))
          << moment;
      if (kind != effects::JointKind::kHinge) continue;
      scene.effects.of<effects::JointSpec>().front().point_m = {0, 3, 0};
      EXPECT_TRUE(holds(answer(scene, reference_laws(), kOver * largest), "swing of body 'bob'"))
          << moment;
    }
  }
}

// A chain's swings across are the eigenvalues of a matrix with three numbers a row: rod i of n
// carries n - i + 1 links.
TEST(LargestStep, OfAChainOfAnyLengthIsReported) {
  const double g = 9.81, l = 0.05;
  for (const int n : {20, 300, 1000}) {
    const scene::Scene scene =
        truths::straight_chain(std::vector<double>(static_cast<std::size_t>(n), 0.1), l,
                               -Vector3d::UnitZ(), Vector3d(0, 0, -g));
    VectorXd diagonal(n), beside(n - 1);
    std::vector<double> tensions;
    for (int i = 0; i < n; ++i) {
      tensions.push_back((n - i) * 0.1 * g);
      diagonal[i] = g / l * (2 * (n - i) - 1);
      if (i + 1 < n) beside[i] = -g / l * (n - i - 1);
    }
    const double largest = kRk4Swing / std::sqrt(tridiagonal_eigenvalues(diagonal, beside)[n - 1]);
    const auto limit = judge_rods_of(scene, tensions, reference_laws(), 1.02 * largest);
    ASSERT_TRUE(limit) << n;
    // what it promises is true, and not much less than what is
    EXPECT_LE(limit->largest_step, (1 + 1e-5) * largest) << n;
    EXPECT_GE(limit->largest_step, (n > 100 ? 0.95 : 1 - 1e-5) * largest) << n;
    EXPECT_FALSE(judge_rods_of(scene, tensions, reference_laws(), kUnder * largest)) << n;
  }
}

// The bound is one for what moves: beyond it a chain pushed aside by a micrometre is torn out of
// its energy, below it swings.
TEST(LargestStep, TheReportedLimitIsTheActualOne) {
  const double g = 9.81, l = 0.7, ratio = 1e4,
               largest =
                   kRk4Swing / std::sqrt(g / l * (1 + ratio + std::sqrt(ratio * (1 + ratio))));
  for (const double part : {kUnder, kOver}) {
    scene::Scene scene =
        truths::straight_chain({1.0, ratio}, l, -Vector3d::UnitZ(), Vector3d(0, 0, -g));
    scene.bodies[0].velocity_m_s = {1e-6, 0, 0};
    scene.step_s = part * largest;
    scene.duration_s = 2000 * scene.step_s;
    const Trajectory result = run(scene, reference_laws(), 1.0 / scene.step_s);
    double fastest = 0.0;
    for (const Frame& frame : result.frames)
      fastest = std::max(fastest, frame.poses[0].velocity_world.norm());
    if (part < 1)
      EXPECT_LE(fastest, 2e-6);
    else
      EXPECT_GE(fastest, 1e-4);
  }
}

}  // namespace
}  // namespace tumble::testing
