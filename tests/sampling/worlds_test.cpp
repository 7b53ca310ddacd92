// From the numbers of a chain to worlds: what is set, what the prior draws, what is violated, and
// what a scene file may not say.
#include "framework/sampling/worlds.h"

#include <cmath>
#include <filesystem>

#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/sampling/overlay.h"
#include "framework/scene/load_sampling.h"
#include "framework/scene/load_scene.h"
#include "tests/support/places.h"

namespace tumble::sampling {
namespace {

SampledScene thrown_ball(const std::string& perturbed, const std::string& asked) {
  const std::string text =
      R"({"title": "a ball", "duration_s": 1, "bodies": [
  {"name": "ball", "shape": {"sphere": {"radius_m": 0.1}}, "mass_kg": 1, "velocity_m_s": [1, 2, 3]},
  {"name": "die", "shape": {"box": {"size_m": [1, 1, 1]}}, "mass_kg": 1, "position_m": [5, 0, 0]},
  {"name": "slab", "shape": {"box": {"size_m": [1, 1, 1]}}, "immovable": true, "position_m": [0, 0, -5]}],
  "sampling": {"perturbed": [)" +
      perturbed + R"(], "asked": [)" + asked + "]}}\n";
  const scene::Scene scene = scene::parse_scene(text, "thrown_ball.json");
  return {scene, scene::parse_sampling(text, scene).value()};
}

const std::string kPlace =
    R"({"body": "ball", "place": {"low_m": [1, null, null], "high_m": [2, 4, null], "softness_m": 0.5}})";
const std::string kLean =
    R"({"body": "die", "lean": {"axis_body": [0, 0, -2], "most_deg": 30, "softness_deg": 15}})";
const std::string kSpeed =
    R"({"body": "ball", "what": "velocity_y_m_s", "normal": {"mean": 2, "deviation": 0.5}})";

TEST(World, HasTheNumbersOfItsPoint) {
  const SampledScene scene = thrown_ball(
      kSpeed + R"(, {"body": "slab", "what": "turn_y_rad", "uniform": {"low": -1, "high": 1}},
      {"body": "slab", "what": "restitution", "normal": {"mean": 0.5, "deviation": 0.1}},
      {"body": "die", "what": "position_x_m", "normal": {"mean": 5, "deviation": 0.1}},
      {"body": "die", "what": "angular_velocity_z_rad_s", "normal": {"mean": 0, "deviation": 1}})",
      kPlace);
  VectorXd x(5);
  x << 2.5, 0.25, 0.75, 5.5, 7;
  const scene::Scene world = world_of(scene, x);
  EXPECT_EQ(world.bodies[0].velocity_m_s, Vector3d(1, 2.5, 3));
  // A turn by 0.25 about y takes z to (sin, 0, cos).
  const Vector3d up = world.bodies[2].world_from_body * Vector3d::UnitZ();
  EXPECT_NEAR((up - Vector3d(std::sin(0.25), 0, std::cos(0.25))).norm(), 0, 1e-15);
  EXPECT_EQ(world.bodies[2].restitution, 0.75);
  EXPECT_EQ(world.bodies[1].position_m, Vector3d(5.5, 0, 0));
  EXPECT_EQ(world.bodies[1].omega_world_rad_s, Vector3d(0, 0, 7));
  // What is not named stays.
  EXPECT_EQ(world.bodies[0].position_m, scene.scene.bodies[0].position_m);
}

TEST(World, OfThePriorIsDrawnByIt) {
  const SampledScene scene = thrown_ball(kSpeed + R"(, {"body": "slab", "what": "restitution",
      "normal": {"mean": 0.9, "deviation": 0.2, "low": 0.8}})",
                                         kPlace);
  const std::vector<Prior> priors = priors_of(scene);
  EXPECT_EQ(priors[1].low, 0.8);
  EXPECT_EQ(priors[1].high, 1.0);  // of a restitution
  Random random(1);
  constexpr int kDraws = 4000;
  double mean = 0, square = 0;
  int below = 0;
  for (int i = 0; i < kDraws; ++i) {
    const VectorXd x = drawn_from_prior(priors, random);
    mean += x[0] / kDraws;
    square += (x[0] - 2) * (x[0] - 2) / kDraws;
    ASSERT_GE(x[1], 0.8);
    ASSERT_LE(x[1], 1.0);
    below += x[1] < 0.9 ? 1 : 0;
  }
  // Errors of means of 4000: 0.5 / 63 = 0.008 and 0.25 sqrt(2) / 63 = 0.0056; four times these.
  EXPECT_NEAR(mean, 2, 0.032);
  EXPECT_NEAR(square, 0.25, 0.023);
  // Symmetric about 0.9: half, with an error of 32.
  EXPECT_NEAR(below, kDraws / 2, 128);
}

struct Moments {
  double mean = 0, variance = 0;
};
constexpr int kMany = 4000;

/// Of how far the draws are from the bound.
Moments excess(const Prior& prior, double bound) {
  Random random(1);
  Moments moments;
  double square = 0;
  for (int i = 0; i < kMany; ++i) {
    const double x = drawn_from_prior({prior}, random)[0];
    EXPECT_TRUE(x >= prior.low && x <= prior.high) << x;
    moments.mean += std::abs(x - bound) / kMany;
    square += (x - bound) * (x - bound) / kMany;
  }
  moments.variance = square - moments.mean * moments.mean;
  return moments;
}

// The tail of a normal distribution beyond a >> 1 deviations s is nearly exponential. Exact of the
// excess over a s: mean s (1/a - 2/a^3 + 10/a^5 - ...), variance s^2 (1/a^2 - 6/a^4 + ...).
TEST(World, OfAPriorCutFarFromItsMeanIsDrawnFromItsTail) {
  constexpr double kInfinite = scene::kNoBound;
  struct Tail {
    Prior prior;
    double bound;
  };
  for (const auto& [prior, bound] :
       {Tail{{PriorKind::kNormal, 0, 0.1, 5, 6}, 5}, Tail{{PriorKind::kNormal, 0, 0.1, -6, -5}, -5},
        Tail{{PriorKind::kNormal, 1, 0.1, 2, kInfinite}, 2},
        Tail{{PriorKind::kNormal, 1, 0.1, -kInfinite, 0}, 0}}) {
    SCOPED_TRACE(bound);
    const double a = std::abs(bound - prior.mean) / prior.deviation;
    const double mean = 0.1 * (1 / a - 2 / std::pow(a, 3) + 10 / std::pow(a, 5));
    const Moments found = excess(prior, bound);
    // The mean of 4000 errs by mean / 63; their variance by sqrt(8) variance / 63. Four times these.
    EXPECT_NEAR(found.mean, mean, 4 * mean / 63);
    EXPECT_NEAR(found.variance, mean * mean, 0.25 * mean * mean);
  }
}

// Two ways to the same number meet at 30 deviations. The ranges begin 1e-9 apart, and equal streams
// give draws no further apart than that and the roundings of 30.
TEST(World, OfATailIsDrawnAlikeOnBothSidesOfThirtyDeviations) {
  Random near(7), far(7);
  for (int i = 0; i < 100; ++i) {
    const double low = 30 - 1e-9,
                 x = drawn_from_prior({{PriorKind::kNormal, 0, 1, low, 31}}, near)[0],
                 y = drawn_from_prior({{PriorKind::kNormal, 0, 1, 30, 31}}, far)[0];
    EXPECT_NEAR(x, y, 3e-9);
  }
}

Frame frame_with(const Vector3d& ball, const Quaterniond& die) {
  Frame frame{};
  frame.poses = {{ball, Quaterniond::Identity(), Vector3d::Zero(), Vector3d::Zero()},
                 {Vector3d(5, 0, 0), die, Vector3d::Zero(), Vector3d::Zero()},
                 {Vector3d(0, 0, -5), Quaterniond::Identity(), Vector3d::Zero(), Vector3d::Zero()}};
  return frame;
}

TEST(Violation, IsTheDistanceFromWhatIsAskedInItsSoftness) {
  const Quaterniond upright = Quaterniond::Identity(),
                    over(Eigen::AngleAxisd(M_PI, Vector3d::UnitX())),
                    nearly(Eigen::AngleAxisd(M_PI - M_PI / 4, Vector3d::UnitX()));
  const SampledScene place = thrown_ball(kSpeed, kPlace), lean = thrown_ball(kSpeed, kLean),
                     both = thrown_ball(kSpeed, kPlace + ", " + kLean);
  EXPECT_EQ(violation_of(place, frame_with({1.5, -9, 7}, upright)), 0);
  // 3 m short in x and 4 m too far in y: 5 m, of 0.5 m.
  EXPECT_NEAR(violation_of(place, frame_with({-2, 8, 0}, upright)), 10, 1e-13);
  // The axis is the body's -z: it points up where the die is turned over.
  EXPECT_EQ(violation_of(lean, frame_with({0, 0, 0}, over)), 0);
  EXPECT_NEAR(violation_of(lean, frame_with({0, 0, 0}, nearly)), 15.0 / 15, 1e-12);
  EXPECT_NEAR(violation_of(lean, frame_with({0, 0, 0}, upright)), 150.0 / 15, 1e-12);
  EXPECT_NEAR(violation_of(both, frame_with({-2, 8, 0}, nearly)), std::hypot(10, 1), 1e-12);
}

TEST(Violation, IsOfThePointThatThePlaceIsAskedOf) {
  // A corner of the die: turned by 90 degrees about y, its body's (0, 0, 0.5) points along x.
  const SampledScene scene = thrown_ball(
      kSpeed,
      R"({"body": "die", "place": {"point_body_m": [0, 0, 0.5], "low_m": [6, null, null],
          "high_m": [7, null, null], "softness_m": 0.1}})");
  const Quaterniond over(Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitY()));
  // The die is at x = 5: upright the point is there too, 1 m short; turned it is 0.5 m short.
  EXPECT_NEAR(violation_of(scene, frame_with({0, 0, 0}, Quaterniond::Identity())), 10, 1e-12);
  EXPECT_NEAR(violation_of(scene, frame_with({0, 0, 0}, over)), 5, 1e-12);
}

TEST(Violation, IsOfTheAngleToTheDirectionThatIsAsked) {
  // "Fell along x": its z within 20 degrees of the world's x, given at another length.
  const SampledScene scene = thrown_ball(
      kSpeed,
      R"({"body": "die", "lean": {"direction": [3, 0, 0], "most_deg": 20, "softness_deg": 10}})");
  const auto tilted = [](double degrees, const Vector3d& axis) {
    return Quaterniond(Eigen::AngleAxisd(degrees * M_PI / 180, axis));
  };
  EXPECT_EQ(violation_of(scene, frame_with({0, 0, 0}, tilted(90, Vector3d::UnitY()))), 0);
  EXPECT_NEAR(violation_of(scene, frame_with({0, 0, 0}, Quaterniond::Identity())), 7, 1e-12);
  EXPECT_NEAR(violation_of(scene, frame_with({0, 0, 0}, tilted(-90, Vector3d::UnitY()))), 16,
              1e-12);
}

TEST(Overlay, HoldsWhatMovesOnceForEachRun) {
  const SampledScene scene = thrown_ball(kSpeed, kPlace);
  Trajectory first;
  first.frames = {frame_with({1, 0, 0}, Quaterniond::Identity())};
  Trajectory second = first;
  second.frames[0].poses[0].com_world = Vector3d(2, 0, 0);
  const Overlay overlay =
      overlay_of(scene.scene, {{first, Vector3d(1, 0, 0)}, {second, Vector3d(0, 1, 0)}});
  ASSERT_EQ(overlay.scene.bodies.size(), 5u);
  ASSERT_EQ(overlay.run.frames[0].poses.size(), 5u);
  EXPECT_EQ(overlay.scene.bodies[3].name, "ball 2");
  EXPECT_EQ(overlay.run.frames[0].poses[0].com_world, Vector3d(1, 0, 0));
  EXPECT_EQ(overlay.run.frames[0].poses[3].com_world, Vector3d(2, 0, 0));
}

// ---- What a file may not say ----

std::string refusal(const std::string& perturbed, const std::string& asked) {
  try {
    thrown_ball(perturbed, asked);
  } catch (const UserError& error) {
    return error.what();
  }
  return "nothing was refused";
}
void expect_refused(const std::string& told, const std::string& words) {
  EXPECT_NE(told.find(words), std::string::npos) << told;
}

TEST(SamplingEntry, IsRefusedWithItsPlace) {
  expect_refused(
      refusal(R"({"body": "bal", "what": "friction", "uniform": {"low": 0, "high": 1}})", kPlace),
      "/sampling/perturbed/0/body");
  expect_refused(
      refusal(
          R"({"body": "slab", "what": "velocity_x_m_s", "normal": {"mean": 0, "deviation": 1}})",
          kPlace),
      "immovable and has no velocity");
  expect_refused(
      refusal(R"({"body": "ball", "what": "restitution", "uniform": {"low": 0.5, "high": 1.5}})",
              kPlace),
      "outside its range");
  expect_refused(
      refusal(R"({"body": "ball", "what": "friction", "uniform": {"low": 2, "high": 1}})", kPlace),
      "not below its upper one");
  expect_refused(refusal(R"({"body": "ball", "what": "friction"})", kPlace), "neither");
  expect_refused(
      refusal(R"({"body": "ball", "what": "colour", "uniform": {"low": 0, "high": 1}})", kPlace),
      "/sampling/perturbed/0/what");
  expect_refused(refusal(
                     R"({"body": "ball", "what": "velocity_x_m_s", "proposal": "multiply",
              "normal": {"mean": 0, "deviation": 1}})",
                     kPlace),
                 "must be positive");
  expect_refused(refusal(kSpeed, R"({"body": "ball"})"), "neither");
  expect_refused(
      refusal(
          kSpeed,
          R"({"body": "die", "lean": {"direction": [0, 0, 0], "most_deg": 9, "softness_deg": 1}})"),
      "/sampling/asked/0/lean/direction");
  expect_refused(refusal(kSpeed + ", " + kSpeed, kPlace), "perturbed already");
  expect_refused(
      refusal(R"({"body": "ball", "what": "friction", "uniform": {"low": 0, "high": 1}})", kPlace),
      "persistent contact only");
  expect_refused(
      refusal(
          R"({"body": "ball", "what": "velocity_x_m_s", "normal": {"mean": 0, "deviation": 1e-9, "low": 1}})",
          kPlace),
      "no probability");
  expect_refused(
      refusal(kSpeed,
              R"({"body": "ball", "place": {"high_m": [null, null, null], "softness_m": 1}})"),
      "no bound");
  expect_refused(refusal(kSpeed, R"({"body": "die", "lean": {"softness_deg": 1}})"),
                 "every direction");
  expect_refused(refusal(kSpeed, R"({"body": "cube", "place": {"softness_m": 1}})"),
                 "/sampling/asked/0/body");
}

// ---- What the course has ----

TEST(EverySampledScene, SaysInWhatItsWorldsDifferAndIsItselfOneOfThem) {
  const std::filesystem::path folder =
      std::filesystem::path(test::source_dir()) / "assignments/a5_plausible/scenes";
  int scenes = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    SCOPED_TRACE(entry.path().filename().string());
    const scene::Scene scene = scene::load_scene(entry.path());
    const auto spec = scene::load_sampling(scene);
    ASSERT_TRUE(spec.has_value());
    const SampledScene sampled{scene, *spec};
    EXPECT_GE(spec->perturbed.size(), 2u);
    EXPECT_GE(spec->asked.size(), 1u);
    // The world that the file shows is the one at the prior's means.
    VectorXd means(static_cast<Eigen::Index>(spec->perturbed.size()));
    for (std::size_t i = 0; i < spec->perturbed.size(); ++i) {
      ASSERT_TRUE(spec->perturbed[i].is_normal);
      means[static_cast<Eigen::Index>(i)] = spec->perturbed[i].mean;
    }
    const scene::Scene world = world_of(sampled, means);
    for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
      EXPECT_EQ(world.bodies[b].position_m, scene.bodies[b].position_m) << scene.bodies[b].name;
      EXPECT_EQ(world.bodies[b].velocity_m_s, scene.bodies[b].velocity_m_s);
      EXPECT_EQ(world.bodies[b].omega_world_rad_s, scene.bodies[b].omega_world_rad_s);
      EXPECT_EQ(world.bodies[b].restitution, scene.bodies[b].restitution);
    }
    ++scenes;
  }
  EXPECT_GE(scenes, 4);
}

}  // namespace
}  // namespace tumble::sampling
