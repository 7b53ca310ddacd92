// Time of impact by bisection (A2.11) and by safeguarded Newton-Raphson (A2.12).
#include "tests/a2_integration/a2_fixtures.h"

namespace tumble::a2_testing {
namespace {

// Rounding inside the gap (a few eps of 5 m) divided by its slope (some 7 m/s or more) moves the
// root by this at most.
constexpr double kRoundOffTime = 1e-15;  // s
constexpr double kTolerance = 1e-6;      // s

RootResult bisect(const Approach& approach, double tolerance, Looks& looks) {
  return a2_module().impact_time_bisection(noting(looks, approach.gap), approach.t_low,
                                           approach.t_high, tolerance);
}

RootResult newton(const Approach& approach, double tolerance, Looks& looks) {
  return a2_module().impact_time_newton(noting(looks, approach.gap), approach.gap_rate,
                                        approach.t_low, approach.t_high, tolerance);
}

TEST(ImpactTimeBisection, FindsTheFallOfABall) {
  Looks looks;
  const Approach ball = dropped_ball();
  const RootResult found = bisect(ball, kTolerance, looks);
  expect_impact(found, ball, looks, kTolerance, kRoundOffTime,
                "the half that is kept: g(m) >= 0 means that the impact is later than m", 11);
}

TEST(ImpactTimeBisection, ReturnsTheSideWhereTheGapIsStillOpen) {
  // Every tolerance ends the search at another bracket: a function that returns its far end or its
  // middle fails.
  for (const double tolerance : {0.3, 1e-2, 1e-4, 1e-9}) {
    Looks looks;
    const Approach ball = thrown_ball();
    expect_impact(bisect(ball, tolerance, looks), ball, looks, tolerance, kRoundOffTime,
                  "the bracket must be smaller than the tolerance, and its open end returned", 11);
  }
}

TEST(ImpactTimeBisection, StopsWhenTheBracketIsSmallEnough) {
  if (!bisection_finds_something()) return;
  Looks looks;
  bisect(thrown_ball(), kTolerance, looks);
  // 3 s / 1e-6 s is 2^21.5: 22 halvings, 2 ends, and 2 calls for a function that evaluates an end
  // twice.
  expect_true(looks.calls <= 26, "at most 26 calls of the gap",
              std::to_string(looks.calls) + " calls",
              {.scene = "an interval of 3 s, tolerance 1e-6 s",
               .slip = "the search goes on when the bracket is small enough, or the gap is asked "
                       "twice for the same time",
               .handout = equation(11)});
}

TEST(ImpactTimeBisection, SaysSoWhenTheGapStaysOpen) {
  if (!bisection_finds_something()) return;
  Looks looks;
  const RootResult found = a2_module().impact_time_bisection(
      noting(looks, [](double t) { return 1 + (t - 1) * (t - 1); }), 0, 3, kTolerance);
  expect_no_impact(found, looks, "a ball that passes at 1 m: gap = 1 + (t - 1)^2 in [0, 3] s",
                   "no status for a missing sign change: look at both ends before the search");
}

TEST(ImpactTimeBisection, RefusesOverlapFromTheStart) {
  if (bisection_finds_something()) expect_finder_refuses_overlap(bisect);
}
TEST(ImpactTimeBisection, NoticesAGapThatIsNoNumber) { expect_finder_notices_nan(bisect); }
// 3 s / 1e-9 s is 2^31.5: 32 halvings, and the 4 that the header allows.
TEST(ImpactTimeBisection, LooksAtTheBracketNotAtTheGap) {
  expect_finder_looks_at_the_bracket(bisect, 36);
}

TEST(ImpactTimeNewton, FindsTheThrownBallInFewSteps) {
  Looks looks;
  const Approach ball = thrown_ball();
  expect_impact(newton(ball, 1e-12, looks), ball, looks, 1e-12, kRoundOffTime,
                "each step: t - g / g', kept inside a bracket whose ends have different signs", 12);
  // Newton doubles the digits with each step: from t = 3 s the error is 1.8, 0.6, 0.1, 6e-3, 2e-5,
  // 1e-10 s. Sometimes rounding makes the last step return to its start, and a safeguard that then
  // halves the bracket takes as long as bisection: so balls are counted together.
  int calls = 0;
  constexpr int kBalls = 10;
  for (int i = 0; i < kBalls; ++i) {
    const double height = 0.5 + 0.7 * i, g = 9.81,
                 root = (2.0 + std::sqrt(4.0 + 2 * g * height)) / g;
    const Approach thrown{"",
                          [=](double t) { return height + (2.0 - g / 2 * t) * t; },
                          [=](double t) { return 2.0 - g * t; },
                          0.0,
                          1.7 * root,
                          root};
    Looks some;
    newton(thrown, 1e-12 * thrown.t_high, some);
    calls += some.calls;
  }
  expect_true(
      calls <= 30 * kBalls, "at most 30 calls of the gap a ball, on average",
      show(calls / static_cast<double>(kBalls)) + " calls",
      {.scene = "ten balls thrown up at 2 m/s from 0.5 to 6.8 m, tolerance 1e-12 of the interval",
       .slip = calls >= 40 * kBalls ? "this is bisection: the slope is not used"
                                    : "the search goes on when the root is found, or the bracket "
                                      "never closes from the other side",
       .handout = equation(12)});
}

TEST(ImpactTimeNewton, SurvivesSlopeZero) {
  Looks looks;
  const Approach ball = dropped_ball();
  expect_impact(newton(ball, 1e-12, looks), ball, looks, 1e-12, kRoundOffTime,
                "no safeguard: slope 0 at the start of a fall divides by zero; bisect instead", 12);
  Looks flat_looks;
  Approach flat = ball;
  flat.scene = ball.scene + ", and a rate that answers 0 at all times";
  flat.gap_rate = [](double) { return 0.0; };
  expect_impact(newton(flat, kTolerance, flat_looks), flat, flat_looks, kTolerance, kRoundOffTime,
                "no safeguard: slope 0 divides by zero; bisect instead", 12);
}

TEST(ImpactTimeNewton, StaysInTheInterval) {
  // From t = 0 the tangent leads to t = 96.6; beyond t = 2.3 this gap is not defined.
  const Approach approach{"gap = 1 - exp(10 (t - 1)) + 1e-2 (1 - t), looked for in [0, 2.3] s",
                          [](double t) { return 1 - std::exp(10 * (t - 1)) + 1e-2 * (1 - t); },
                          [](double t) { return -10 * std::exp(10 * (t - 1)) - 1e-2; },
                          0.0,
                          2.3,
                          1.0};
  Looks looks;
  expect_impact(newton(approach, 1e-9, looks), approach, looks, 1e-9, kRoundOffTime,
                "no safeguard: the tangent leads out of the interval; bisect instead", 12);
  expect_true(looks.earliest >= 0 && looks.latest <= 2.3, "no look outside [0, 2.3] s",
              "looks from " + show(looks.earliest) + " to " + show(looks.latest) + " s",
              {.scene = approach.scene,
               .slip = "leaving the interval: the tangent leads out of it; bisect instead",
               .handout = equation(12)});
}

TEST(ImpactTimeNewton, SaysSoWhenTheGapStaysOpen) {
  if (!newton_finds_something()) return;
  Looks looks;
  const RootResult found = a2_module().impact_time_newton(
      noting(looks, [](double t) { return 1 + (t - 1) * (t - 1); }),
      [](double t) { return 2 * (t - 1); }, 0, 3, kTolerance);
  expect_no_impact(found, looks, "a ball that passes at 1 m: gap = 1 + (t - 1)^2 in [0, 3] s",
                   "no status for a missing sign change: look at both ends before the search");
}

TEST(ImpactTimeNewton, RefusesOverlapFromTheStart) {
  if (newton_finds_something()) expect_finder_refuses_overlap(newton);
}
TEST(ImpactTimeNewton, NoticesAGapThatIsNoNumber) { expect_finder_notices_nan(newton); }
// The header's bound for any gap: 10 + 4 times bisection's 34.
TEST(ImpactTimeNewton, LooksAtTheBracketNotAtTheGap) {
  expect_finder_looks_at_the_bracket(newton, 146);
}

TEST(ImpactTimeNewton, StopsABulletBeforeAThinWall) {
  // 1000 m/s, steps of 10 ms: 10 m per step, through a wall of 1 mm. The distance to both sides of
  // the wall is positive before and after the step; the distance to the nearer face changes sign,
  // and is the right gap.
  const Approach bullet{
      "a bullet of radius 5 mm at 1000 m/s, 10.5 m before a 1 mm wall, in a step from 10 to 20 ms: "
      "gap = 10.5 - 1000 t",
      [](double t) { return 10.5 - 1000 * t; },
      [](double) { return -1000.0; },
      0.01,
      0.02,
      0.0105};
  Looks looks;
  // Rounding of 10.5 m moves the root by 2e-18 s; time itself is spaced by 1.7e-18 s here.
  expect_impact(newton(bullet, 1e-12, looks), bullet, looks, 1e-12, 1e-17,
                "t - g / g', and the open side", 12);
  // tunnelling, as a step sees it
  const auto distance_to_wall = [](double t) { return std::abs(10.5055 - 1000 * t) - 0.0055; };
  Looks unsigned_looks;
  const RootResult unseen = a2_module().impact_time_newton(
      noting(unsigned_looks, distance_to_wall), [](double) { return -1000.0; }, 0.01, 0.02, 1e-12);
  expect_no_impact(
      unseen, unsigned_looks,
      bullet.scene + "; asked for the distance to the wall, which is open at both ends",
      "an impact is reported where both ends are open");
}

}  // namespace
}  // namespace tumble::a2_testing
