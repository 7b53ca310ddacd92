// The files of reference values in this folder with the reference modules; a wrong law must fail;
// invalid files are refused with the position.
#include <fstream>

#include <gtest/gtest.h>

#include "tests/support/places.h"
#include "framework/core/error.h"
#include "framework/core/not_implemented.h"
#include "tests/truths/truths.h"

namespace tumble::testing {
namespace {

using truths::Verdict;

TEST(TruthFiles, EveryOneIsKnownAndRight) {
  const Reference reference;
  int right = 0, skipped = 0;
  for (const auto& file :
       cli::find_truths(std::filesystem::path(test::source_dir()) / "tests/truths")) {
    const auto lines = reference.compare(cli::read_truth(file));
    if (lines.empty()) {
      ++skipped;
      continue;
    }
    EXPECT_EQ(truths::verdict_of(lines), Verdict::kRight) << file.filename() << failures(lines);
    right += truths::verdict_of(lines) == Verdict::kRight;
  }
  EXPECT_EQ(right, 92);
  EXPECT_EQ(skipped, 0);
}

TEST(TruthFiles, AnImpulseOfTheWrongSignIsWrong) {
  Reference spoilt;
  const auto right_impulse = spoilt.a1.collision_impulse;
  spoilt.a1.collision_impulse = [=](const Contact& c, const Body& a, const Body& b, double e) {
    return -right_impulse(c, a, b, e);
  };
  for (const char* name : {"impulse_random__random20", "impulse_rod_ball__tip_e1",
                           "bouncing_ball__e0.5", "newtons_cradle__5balls_1moving_e0.9"})
    EXPECT_EQ(truths::verdict_of(spoilt.compare(truth_named(name))), Verdict::kWrong) << name;
}

TEST(TruthFiles, AStageUsedTwiceByRk4IsWrong) {
  Reference spoilt;
  const auto right_step = spoilt.a2.rk4_step;
  spoilt.a2.rk4_step = [=](const OdeFunction& f, double t, const VectorXd& y, double h) {
    int call = 0;
    VectorXd second;
    const OdeFunction repeating = [&](double at, const VectorXd& state) -> VectorXd {
      if (++call == 3) return second;
      const VectorXd rate = f(at, state);
      if (call == 2) second = rate;
      return rate;
    };
    return right_step(repeating, t, y, h);
  };
  for (const char* name : {"logistic__lecture_a6_b0.007_dt0.5", "free_top_symmetric__rod_prolate",
                           "free_top_asymmetric__generic_123", "spring_mass__critical"})
    EXPECT_EQ(truths::verdict_of(spoilt.compare(truth_named(name))), Verdict::kWrong) << name;
}

TEST(TruthFiles, DampingOfTheWrongSignAndARodWithoutItsVelocityProductAreWrong) {
  Reference spoilt;
  const auto right_force = spoilt.a3.spring_force;
  spoilt.a3.spring_force = [=](const Spring& spring, const AnchorState& a, const AnchorState& b) {
    Spring driven = spring;
    driven.damping = -spring.damping;
    return right_force(driven, a, b);
  };
  const auto right_row = spoilt.a3.rod_row;
  spoilt.a3.rod_row = [=](const Body& a, const Vector3d& point_a, const Body& b,
                          const Vector3d& point_b, double length) {
    ConstraintRow row = right_row(a, point_a, b, point_b, length);
    row.velocity_product = 0.0;
    return row;
  };
  for (const char* name : {"spring_mass__critical", "two_body_spring__damped_k20_c0.5",
                           "double_pendulum__rest_horizontal_equal"})
    EXPECT_EQ(truths::verdict_of(spoilt.compare(truth_named(name))), Verdict::kWrong) << name;
}

TEST(TruthFiles, AStubIsNotAttempted) {
  Reference stub;
  stub.a2.rk4_step = [](const OdeFunction&, double, const VectorXd&, double) -> VectorXd {
    throw NotImplemented("rk4_step", "handout");
  };
  stub.a1.collision_impulse = [](const Contact&, const Body&, const Body&, double) -> double {
    throw NotImplemented("collision_impulse", "handout");
  };
  stub.a3.spring_force = [](const Spring&, const AnchorState&, const AnchorState&) -> Vector3d {
    throw NotImplemented("spring_force", "handout");
  };
  for (const char* name :
       {"logistic__lecture_to_T2", "free_top_symmetric__rod_prolate", "impulse_rod_ball__tip_e1",
        "bouncing_ball__e0.5", "spring_mass__overdamped"})
    EXPECT_EQ(truths::verdict_of(stub.compare(truth_named(name))), Verdict::kNotAttempted) << name;
}

/// The message for a logistic case in which one piece of its text is replaced.
std::string complaint(const std::string& from, const std::string& to) {
  std::ifstream source(std::filesystem::path(test::source_dir()) /
                       "tests/truths/logistic__lecture_to_T2.json");
  std::string text(std::istreambuf_iterator<char>(source), {});
  text.replace(text.find(from), from.size(), to);
  const auto file = std::filesystem::path(::testing::TempDir()) / "odd_truth.json";
  std::ofstream(file) << text;
  try {
    Reference().compare(cli::read_truth(file));
  } catch (const UserError& error) {
    EXPECT_NE(error.where().find("odd_truth.json"), std::string::npos) << error.what();
    return error.what();
  }
  return "nothing";
}

TEST(TruthFiles, OddOnesAreRefusedWithFileAndPointer) {
  EXPECT_NE(complaint("\"y0\"", "\"y1\"").find("has no 'y0'"), std::string::npos);
  EXPECT_NE(complaint("\"family\"", "\"famly\"").find("has no 'family'"), std::string::npos);
  EXPECT_NE(complaint("\"10\"", "\"NaN\"").find("/inputs/y0/value"), std::string::npos);
  EXPECT_NE(complaint("\"10\"", "\"ten\"").find("found 'ten'"), std::string::npos);
  EXPECT_NE(complaint("\"10\"", "[1]").find("found a list"), std::string::npos);
  EXPECT_NE(complaint("{", "").find("is not JSON"), std::string::npos);
  const auto empty = std::filesystem::path(::testing::TempDir()) / "no_truths";
  std::filesystem::create_directories(empty);
  EXPECT_THROW(cli::find_truths(empty), UserError);
}

}  // namespace
}  // namespace tumble::testing
