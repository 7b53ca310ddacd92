// The classical Runge-Kutta method (A2.2).
#include "tests/a2_integration/a2_fixtures.h"

namespace tumble::a2_testing {
namespace {

const std::string kReadRk4 = equation(2);

// Slopes chosen so that every known mistake gives another result. With h = 0.5 every stage is exact
// in binary.
std::vector<VectorXd> slopes() { return {vector({1}), vector({2}), vector({5}), vector({9})}; }
const std::string kScript =
    "y = 10, h = 0.5 s, and a derivative that answers k1 = 1, k2 = 2, k3 = 5, k4 = 9 whatever it "
    "is asked";

TEST(Rk4Step, AsksForFourSlopes) {
  Diary diary;
  a2_module().rk4_step(scripted(diary, slopes()), 3.0, vector({10}), 0.5);
  expect_near(
      static_cast<double>(diary.calls()), 4.0, 0.0, "calls of the derivative",
      {.scene = "one step",
       .slip = diary.calls() > 4
                   ? "the derivative is called more often than needed: keep k1 to k4 in variables"
               : diary.calls() == 1 ? "this is Euler's method: one slope"
               : diary.calls() == 2 ? "this is a midpoint or Heun method: two slopes"
                                    : "slopes are missing: k1, k2, k3, k4",
       .handout = kReadRk4});
}

TEST(Rk4Step, BuildsEachStageOnTheSlopeBefore) {
  Diary diary;
  a2_module().rk4_step(scripted(diary, slopes()), 3.0, vector({10}), 0.5);
  diary.states.resize(4, vector({kUnset}));
  VectorXd found = VectorXd::Constant(4, kUnset);
  for (std::size_t i = 0; i < std::min<std::size_t>(4, diary.calls()); ++i)
    if (diary.states[i].size() == 1) found[static_cast<Eigen::Index>(i)] = diary.states[i][0];
  const Slips<VectorXd> slips = {
      {vector({10, 10.25, 10.25, 12.5}),
       "k1 used where k2 belongs: the third slope should be taken at y + (h/2) k2"},
      {vector({10, 10.25, 10.5, 11}), "k2 used for k3: the fourth slope is taken at y + h k3"},
      {vector({10, 10.25, 10.5, 10.5}), "k1 used for k3: the fourth slope is taken at y + h k3"},
      {vector({10, 10.25, 10.5, 11.25}),
       "the fourth stage takes half a step: it should be taken at y + h k3"},
      {vector({10, 10.5, 11, 12.5}),
       "whole steps where half steps belong: y + (h/2) k1, y + (h/2) k2"},
      {vector({10, 11, 12, 15}), "the slopes are not multiplied by h"},
      {vector({10, 10, 10, 10}), "all slopes are taken at the start"}};
  expect_near(
      found, vector({10, 10.25, 10.5, 12.5}), 0.0, "(y of the four stages)",
      {.scene = kScript,
       .slip = diary.calls() < 4
                   ? "slopes are missing: this is a simpler method"
                   : likely(found, slips, "the stages y, y + (h/2) k1, y + (h/2) k2, y + h k3"),
       .handout = kReadRk4});
}

TEST(Rk4Step, MovesTimeWithTheStages) {
  Diary diary;
  a2_module().rk4_step(scripted(diary, slopes()), 3.0, vector({10}), 0.5);
  diary.times.resize(4, kUnset);
  const VectorXd found = Eigen::Map<const VectorXd>(diary.times.data(), 4);
  expect_near(
      found, vector({3, 3.25, 3.25, 3.5}), 0.0, "s (times of the four stages)",
      {.scene = "one step from t = 3 s, h = 0.5 s",
       .slip = likely(
           found,
           Slips<VectorXd>{
               {vector({3, 3, 3, 3}),
                "time stands still inside the step: the stages are at t, t + h/2, t + h/2, t + h"},
               {vector({3, 3.25, 3.25, 3.25}), "k4 is taken at t + h/2: it belongs at t + h"},
               {vector({3, 3.25, 3.5, 3.5}), "k3 is taken at t + h: it belongs at t + h/2"},
               {vector({3, 3.5, 3.5, 3.5}),
                "whole steps where half steps belong: k2 and k3 are at t + h/2"}},
           "the stages are at t, t + h/2, t + h/2, t + h"),
       .handout = kReadRk4});
}

TEST(Rk4Step, WeighsTheSlopesAsSimpsonDoes) {
  Diary diary;
  const VectorXd found = a2_module().rk4_step(scripted(diary, slopes()), 3.0, vector({10}), 0.5);
  // 10 + 0.5/6 (1 + 2*2 + 2*5 + 9) = 12.
  expect_near(found, vector({12}), kRoundoff * 12, "",
              {.scene = kScript,
               .slip = rk4_slip(
                   likely(found,
                          Slips<VectorXd>{{vector({2}), "the old y is missing"},
                                          {vector({14}), "the slopes are not multiplied by h"}},
                          "y + (h/6) (k1 + 2 k2 + 2 k3 + k4)")),
               .handout = kReadRk4});
}

TEST(Rk4Step, IsExactForCubicsInTime) {
  // y' = 4 t^3 - 6 t, so y = t^4 - 3 t^2 + c. Simpson's rule is exact up to degree 3.
  const OdeFunction f = [](double t, const VectorXd&) { return vector({4 * t * t * t - 6 * t}); };
  const VectorXd found = a2_module().rk4_step(f, 1.0, vector({-2}), 2.0);
  // 4 * 27 is the largest number in between; weighted, 200
  expect_near(found, vector({54}), kRoundoff * 200, "",
              {.scene = "y' = 4 t^3 - 6 t from y(1) = -2, one step of 2 s to y(3) = 54",
               .slip = rk4_slip(likely(
                   found, Slips<VectorXd>{{vector({-6}), "time stands still inside the step"}},
                   "times of the stages: t, t + h/2, t + h/2, t + h")),
               .handout = kReadRk4});
}

TEST(Rk4Step, IsOfOrderFour) {
  // The orders of the exact method here are 3.95, 3.975, 3.987; every mistake in a stage or weight
  // shows 3 or less.
  const auto found = observed_orders(a2_module().rk4_step, logistic, 0.0, vector({10}), 0.5,
                                     vector({kLogisticAtHalf}), 32, 3);
  expect_orders(
      found, 4.0, 0.1,
      {.scene = "y' = 6 y - 0.007 y^2, y(0) = 10, to t = 0.5 s",
       .steps = "32, 64, 128, 256 steps",
       .slip = rk4_slip(std::abs(found.back() - 1) < 0.1
                            ? "order 1: this is Euler's method, or one slope of four is wrong"
                            : "order 4 needs every stage and every weight of (A2.2)"),
       .handout = "handouts/a2_integration.md#order"});
}

TEST(Rk4Step, SeesAForceThatChangesWithTime) {
  // y' = -2 t y, y = exp(-t^2). Orders of a correct step from 16 to 128 steps: 3.998 to 4.002.
  const OdeFunction f = [](double t, const VectorXd& y) { return VectorXd(-2.0 * t * y); };
  const auto found = observed_orders(a2_module().rk4_step, f, 0.0, vector({1}), 1.0,
                                     vector({std::exp(-1.0)}), 16, 3);
  expect_orders(
      found, 4.0, 0.1,
      {.scene = "y' = -2 t y from y(0) = 1 to t = 1 s, where y = exp(-1)",
       .steps = "16, 32, 64, 128 steps",
       .slip = rk4_slip("time inside the step: the stages are at t, t + h/2, t + h/2, t + h"),
       .handout = "handouts/a2_integration.md#order"});
}

TEST(Rk4Step, FreeTopKeepsEnergyAndAngularMomentumToOrderFour) {
  if (!rk4_moves()) return;
  const Vector3d moments(1, 2, 3), start(0.1, 2, 0.1);
  const auto energy = [&](const VectorXd& w) { return 0.5 * moments.dot(Vector3d(w).cwiseAbs2()); };
  const auto momentum = [&](const VectorXd& w) { return moments.cwiseProduct(Vector3d(w)).norm(); };
  for (const int steps : {100, 200, 400}) {
    const VectorXd w = integrate(a2_module().rk4_step, free_top, 0.0, start, 10.0, steps);
    // Truncation: a correct step drifts by 0.009 to 0.015 h^4 here (measured at the three sizes); a
    // method of order 2 by 17 h^4 or more.
    const double allowed = 0.03 * std::pow(10.0 / steps, 4);
    const Story story{
        .scene =
            "a free top, moments 1, 2, 3 kg m^2, turns about its middle axis and tumbles for 10 s",
        .steps = std::to_string(steps) + " steps",
        .slip =
            rk4_slip("a stage or a weight is wrong, so that the drift does not shrink with h^4"),
        .handout = "handouts/a2_integration.md#order"};
    expect_near(energy(w), energy(start), allowed * energy(start), "J", story);
    expect_near(momentum(w), momentum(start), allowed * momentum(start), "kg m^2/s", story);
  }
}

// Two calls of each function in one process: the first fills a static variable, which makes the
// second wrong.
TEST(Integration, KeepsNothingBetweenCalls) {
  const auto story = [](const std::string& function, int n) {
    return Story{.scene = "two calls of " + function + ", each with other numbers",
                 .slip = function + " itself: see its own tests",
                 .handout = equation(n)};
  };
  const OdeFunction decay = [](double, const VectorXd& y) { return VectorXd(-y); };
  const auto taylor = [](double h) {
    return 1 - h + h * h / 2 - h * h * h / 6 + h * h * h * h / 24;
  };
  const VectorXd e1 = a2_module().euler_step(decay, 0, vector({4}), 0.5),
                 e2 = a2_module().euler_step(decay, 1, vector({8}), 0.25);
  expect_kept_nothing(e1, vector({2}), e2, vector({6}), kRoundoff * 8, "", story("euler_step", 1));
  const VectorXd r1 = a2_module().rk4_step(decay, 0, vector({4}), 0.5),
                 r2 = a2_module().rk4_step(decay, 1, vector({8}), 0.25);
  expect_kept_nothing(r1, vector({4 * taylor(0.5)}), r2, vector({8 * taylor(0.25)}), kRoundoff * 8,
                      "", story("rk4_step", 2));

  const auto derivative = [](const Quaterniond& q, const Inertia& inertia, const Vector3d& L) {
    RigidBodyState state = resting();
    state.world_from_body = q;
    state.angular_momentum_world = L;
    const VectorXd rate = a2_module().rigid_body_derivative(state, inertia, no_wrench());
    return rate.size() == kStateSize ? VectorXd(rate.segment<4>(3))
                                     : VectorXd(VectorXd::Constant(4, kUnset));
  };
  const auto exact = [](const Quaterniond& q, const Inertia& inertia, const Vector3d& L) {
    const Vector3d w = q * Vector3d(inertia.inverse_inertia_body * (q.conjugate() * L));
    const Quaterniond rate = Quaterniond(0, w.x(), w.y(), w.z()) * q;
    return vector({rate.w() / 2, rate.x() / 2, rate.y() / 2, rate.z() / 2});
  };
  const Vector3d L(4, 2, -1), M(-1, 3, 2);
  const VectorXd d1 = derivative(third_turn(), block(), L),
                 d2 = derivative(skew_turn(), bracket(), M);
  expect_kept_nothing(d1, exact(third_turn(), block(), L), d2, exact(skew_turn(), bracket(), M),
                      kRoundoff * 10, "1/s (w x y z)", story("rigid_body_derivative", 4));
}

}  // namespace
}  // namespace tumble::a2_testing
