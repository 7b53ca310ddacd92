// Methods of integration to compare with: each is of the order that it promises, or keeps to the
// tolerance that it is given.
#include <cmath>

#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/core/not_implemented.h"
#include "framework/dynamics/methods.h"
#include "framework/dynamics/split_ode.h"

namespace tumble::testing {
namespace {

// y'' = -y from (1, 0): (cos t, -sin t).
const OdeFunction kSwing = [](double, const VectorXd& y) -> VectorXd {
  return Eigen::Vector2d(y[1], -y[0]);
};

double error_at_1(const StepFunction& step, int steps) {
  VectorXd y = Eigen::Vector2d(1.0, 0.0);
  for (int k = 0; k < steps; ++k) y = step(kSwing, static_cast<double>(k) / steps, y, 1.0 / steps);
  return (y - Eigen::Vector2d(std::cos(1.0), -std::sin(1.0))).norm();
}

TEST(Methods, OfFixedStepsHaveTheOrderTheyPromise) {
  for (const Method& method : methods()) {
    if (method.controlled) continue;
    const StepFunction step = step_of(method, kUnset);
    // The next term of the error is smaller by the step, 1/64: of the order that is 0.05 at most. A
    // wrong stage costs a whole order.
    // Beyond order 4 such steps are at rounding: 2 and 4 of them, and the next term is smaller by
    // the square of the step.
    const int steps = method.order > 4 ? 2 : 64;
    EXPECT_NEAR(std::log2(error_at_1(step, steps) / error_at_1(step, 2 * steps)), method.order,
                0.05)
        << method.name;
  }
}

TEST(Methods, ThatAreSymplecticAskForAccelerationsOnceForEachChangeOfVelocities) {
  for (const auto& [word, kicks] : {std::pair{"symplectic", 1}, {"verlet", 2}}) {
    int whole = 0, places = 0;
    const OdeFunction split = SplitOde{[&](double t, const VectorXd& y) {
                                         ++whole;
                                         return kSwing(t, y);
                                       },
                                       [&](double, const VectorXd& y) -> VectorXd {
                                         ++places;
                                         return Vector2d(y[1], kUnset);
                                       }};
    const StepFunction step = step_of(method_named(word), kUnset);
    const VectorXd y = Vector2d(0.6, -0.8);
    EXPECT_EQ(step(split, 0.0, y, 0.1), step(kSwing, 0.0, y, 0.1)) << word << ", to the last bit";
    EXPECT_EQ(whole, kicks) << word;
    EXPECT_EQ(places, 1) << word;
  }
}

TEST(Methods, ThatControlTheirErrorKeepToTheTolerance) {
  for (const Method& method : methods()) {
    if (!method.controlled) continue;
    double last = 1.0;
    for (const double tolerance : {1e-4, 1e-7, 1e-10}) {
      const double error = error_at_1(step_of(method, tolerance), 1);
      // The tolerance is of a step; in one radian there are tens of them at most, with a method of
      // order 4 at 1e-10 some hundred.
      EXPECT_LT(error, 200 * tolerance) << method.name << ", tolerance " << tolerance;
      EXPECT_LT(error, last) << method.name << ": a smaller tolerance must make a smaller error";
      last = error;
    }
  }
}

TEST(Methods, ImplicitOneTakesStepsThatStabilityForbidsOthers) {
  // y' = -1e6 (y - cos t): explicit methods need steps below 3e-6, a stiff one follows the cosine.
  int calls = 0;
  const OdeFunction stiff = [&calls](double t, const VectorXd& y) -> VectorXd {
    ++calls;
    return VectorXd::Constant(1, -1e6 * (y[0] - std::cos(t)));
  };
  const VectorXd end =
      step_of(method_named("rosenbrock4"), 1e-6)(stiff, 0.0, VectorXd::Constant(1, 1.0), 1.0);
  // ten times the tolerance; the solution lags by 1e-6 sin t
  EXPECT_NEAR(end[0], std::cos(1.0), 1e-5);
  // at least 1e6 / 3 steps of more than one call for an explicit method
  EXPECT_LT(calls, 20000);
}

TEST(Methods, OfGaussKeepsTheEnergyOfSwingsThatItsStepDoesNotFollow) {
  // y'' = -w^2 y with w h = 30: explicit methods end at w h = 3, here the swing keeps its size, to
  // the rounding of w h in each of 1000 steps.
  constexpr double w = 3000.0, h = 0.01;
  const OdeFunction swing = [](double, const VectorXd& y) -> VectorXd {
    return Vector2d(y[1], -w * w * y[0]);
  };
  const auto energy = [](const VectorXd& y) { return y[1] * y[1] + w * w * y[0] * y[0]; };
  VectorXd y = Vector2d(1.0, 0.0);
  const double before = energy(y);
  for (int k = 0; k < 1000; ++k) y = step_of(method_named("gauss6"), kUnset)(swing, 0.0, y, h);
  EXPECT_NEAR(energy(y) / before, 1.0, 1e-10);
}

TEST(Methods, OfGaussHalvesAStepWhoseStagesHaveNoSolutionNearby) {
  // y' = 1e4 cos(1e3 y): Newton's method from one root of the stages wanders to others, whose turns
  // stand 3e-3 apart; y never leaves the band between two of them.
  const OdeFunction waves = [](double, const VectorXd& y) -> VectorXd {
    return VectorXd::Constant(1, 1e4 * std::cos(1e3 * y[0]));
  };
  const VectorXd y = step_of(method_named("gauss6"), kUnset)(waves, 0.0, VectorXd::Zero(1), 1e-5);
  // closed form: tan(1e3 y / 2 + pi / 4) = exp(1e7 t) from tan(pi / 4)
  EXPECT_NEAR(1e3 * y[0], 2.0 * std::atan(std::exp(100.0)) - M_PI / 2, 1e-3);
}

// y' = -1000 ln y from t = 1/2 on, nothing before: y falls from 2 to 1 and is positive all the way.
// A trial across the edge, as long as stillness lets it be, leads below 0, where there is no
// logarithm.
VectorXd fall_to_one(double t, const VectorXd& y) {
  return VectorXd::Constant(1, t < 0.5 ? 0.0 : -1000.0 * std::log(y[0]));
}

TEST(Methods, ThatControlTheirErrorTakeBackATrialThatGoesWrong) {
  constexpr double kTolerance = 1e-6;
  for (const Method& method : methods()) {
    if (!method.controlled) continue;
    for (const bool throws : {false, true}) {
      int wrong = 0;
      const OdeFunction f = [&](double t, const VectorXd& y) -> VectorXd {
        VectorXd slope = fall_to_one(t, y);
        if (!slope.allFinite()) ++wrong;
        if (throws && !slope.allFinite()) throw std::runtime_error("no logarithm");
        return slope;
      };
      // At the end explicit methods go to and fro about 1 by what the tolerance lets them.
      EXPECT_NEAR(step_of(method, kTolerance)(f, 0.0, VectorXd::Constant(1, 2.0), 1.0)[0], 1.0,
                  100 * kTolerance)
          << method.name;
      EXPECT_GT(wrong, 0) << method.name << ": the case does not try what it is about";
    }
  }
}

TEST(Methods, WhereNoStepWillDoSayWhenAndWhy) {
  for (const Method& method : methods()) {
    if (!method.controlled) continue;
    for (const bool throws : {false, true}) {
      const OdeFunction broken = [&](double t, const VectorXd& y) -> VectorXd {
        if (t > 0.5 && throws) throw std::runtime_error("the rope is torn");
        return t > 0.5 ? VectorXd::Constant(1, kUnset) : VectorXd(-y);
      };
      try {
        step_of(method, 1e-6)(broken, 0.0, VectorXd::Constant(1, 1.0), 1.0);
        ADD_FAILURE() << method.name << " went on";
      } catch (const std::runtime_error& error) {
        const std::string words = error.what();
        const std::size_t at = words.find("no step is short enough at t = ");
        ASSERT_NE(at, std::string::npos) << method.name << ": " << words;
        // differences for an implicit method's Jacobian look 6e-6 s ahead
        EXPECT_NEAR(std::stod(words.substr(at + 31)), 0.5, 2e-5) << method.name;
        EXPECT_NE(words.find(throws ? "the rope is torn" : "not a number"), std::string::npos)
            << method.name << ": " << words;
      }
    }
  }
}

// Parts of a step end where the step does but for a rounding of t, and what is left is a part too.
TEST(Methods, GoOnFarFromTheBeginningOfTime) {
  const OdeFunction swing = [](double, const VectorXd& y) -> VectorXd {
    return Vector2d(y[1], -50.0 * y[0]);
  };
  for (const Method& method : methods()) {
    if (!method.controlled) continue;
    for (const double tolerance : {1e-8, 3e-11, 1e-11, 3e-12}) {
      // of fourth order, with differences: some thousand parts a step
      if (method.word == std::string("rosenbrock4") && tolerance < 1e-8) continue;
      VectorXd y = Vector2d(0.0, 1.0);
      for (int k = 0; k < 60; ++k)
        ASSERT_NO_THROW(y = step_of(method, tolerance)(swing, 4.0 + k / 60.0, y, 1.0 / 60.0))
            << method.name << ", tolerance " << tolerance << ", step " << k;
      // some hundred parts, each to the tolerance of what sums to 60 of them
      EXPECT_NEAR(y[1], std::cos(std::sqrt(50.0)), 1e4 * tolerance) << method.name;
    }
  }
}

// The first part that is tried is the shorter the greater the slope: no reason to refuse it.
TEST(Methods, BearSlopesOfAnySize) {
  const OdeFunction weight = [](double, const VectorXd& y) -> VectorXd {
    return VectorXd::Constant(1, -6e25 + 0.0 * y[0]);
  };
  for (const Method& method : methods())
    if (method.controlled) {
      EXPECT_NEAR(step_of(method, 1e-9)(weight, 0.0, VectorXd::Zero(1), 0.01)[0] / -6e23, 1.0,
                  1e-12)
          << method.name;
    }
}

// A time limit that is hit within a trial is no trial too long; nor is a module whose process has
// died.
TEST(Methods, WhatStaysSoEndsAStepAtOnce) {
  struct TimeIsUp : std::runtime_error, Final {
    TimeIsUp() : std::runtime_error("time is up") {}
  };
  for (const Method& method : methods())
    for (const int at : {1, 2, 5, 9}) {
      int calls = 0;
      const OdeFunction limited = [&](double, const VectorXd& y) -> VectorXd {
        if (++calls == at) throw TimeIsUp();
        return -y;
      };
      const auto a_second = [&] {
        for (int k = 0; k < 10; ++k)
          step_of(method, 1e-6)(limited, 0.1 * k, VectorXd::Constant(1, 1.0), 0.1);
      };
      EXPECT_THROW(a_second(), TimeIsUp) << method.name;
      EXPECT_EQ(calls, at) << method.name;
    }
}

TEST(Methods, WhatIsNotWrittenYetIsNoMatterOfTheStep) {
  const OdeFunction stub = [](double, const VectorXd&) -> VectorXd {
    throw NotImplemented("state_derivative", "handouts/a2_integration.md");
  };
  for (const Method& method : methods())
    EXPECT_THROW(step_of(method, 1e-6)(stub, 0.0, VectorXd::Constant(1, 1.0), 1.0), NotImplemented)
        << method.name;
}

TEST(Methods, UnknownNameIsRefusedWithTheNearest) {
  EXPECT_THROW(
      {
        try {
          method_named("rk5");
        } catch (const UserError& error) {
          EXPECT_NE(std::string(error.what()).find("rk4"), std::string::npos) << error.what();
          throw;
        }
      },
      UserError);
}

}  // namespace
}  // namespace tumble::testing
