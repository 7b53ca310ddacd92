// Hidden: what breaks root finders. Slopes that lie, roots of higher order, ends that touch,
// tolerances of 0.
#include "tests/a2_integration/a2_fixtures.h"

namespace tumble::a2_testing {
namespace {

constexpr double kRoundOffTime = 1e-15;  // s: a few eps of the gap's terms over its slope

RootResult bisect(const Approach& approach, double tolerance, Looks& looks) {
  return a2_module().impact_time_bisection(noting(looks, approach.gap), approach.t_low,
                                           approach.t_high, tolerance);
}

RootResult newton(const Approach& approach, double tolerance, Looks& looks) {
  return a2_module().impact_time_newton(noting(looks, approach.gap), approach.gap_rate,
                                        approach.t_low, approach.t_high, tolerance);
}

void expect_few(const Looks& looks, int most, const std::string& scene, const std::string& slip) {
  expect_true(looks.calls <= most, "at most " + std::to_string(most) + " calls of the gap",
              std::to_string(looks.calls) + " calls",
              {.scene = scene, .slip = slip, .handout = equation(12)});
}

// The conventions of (A2.10), which both finders share.
void expect_conventions(const Finder& find) {
  const auto line = [](double offset) {
    Approach approach{"gap = " + show(offset) + " - t in [0, 2] s",
                      [offset](double t) { return offset - t; },
                      [](double) { return -1.0; },
                      0.0,
                      2.0,
                      offset};
    return approach;
  };
  Looks overlap, away, low, high, touch;
  expect_no_impact(find(line(-1), 1e-6, overlap), overlap, line(-1).scene,
                   "overlap from the start is not an impact: there is no open side");
  Approach leaving = line(1);
  leaving.scene = "gap = t - 1 in [0, 2] s";
  leaving.gap = [](double t) { return t - 1; };
  leaving.gap_rate = [](double) { return 1.0; };
  expect_no_impact(find(leaving, 1e-6, away), away, leaving.scene,
                   "overlap from the start is not an impact: there is no open side");
  expect_impact(find(line(0), 1e-6, low), line(0), low, 0.0, 0.0,
                "a gap of exactly 0 at t_low is an impact there", 10);
  // Whatever it does later: t_low is tested first.
  Looks opening_looks, returning_looks;
  Approach opening = line(0), returning = line(0);
  opening.scene = "gap = t in [0, 2] s";
  opening.gap = [](double t) { return t; };
  opening.gap_rate = [](double) { return 1.0; };
  returning.scene = "gap = t (1 - t) in [0, 2] s";
  returning.gap = [](double t) { return t * (1 - t); };
  returning.gap_rate = [](double t) { return 1 - 2 * t; };
  expect_impact(find(opening, 1e-6, opening_looks), opening, opening_looks, 0.0, 0.0,
                "a gap of exactly 0 at t_low is an impact there, though it opens afterwards", 10);
  expect_impact(find(returning, 1e-6, returning_looks), returning, returning_looks, 0.0, 0.0,
                "a gap of exactly 0 at t_low is an impact there, and not where it closes again",
                10);
  expect_impact(find(line(2), 1e-6, high), line(2), high, 0.0, 0.0,
                "a gap of exactly 0 at t_high is an impact there, where no other was seen", 10);
  // Both ends: t_low decides, whether by its sign or by its 0.
  Looks arriving_looks, both_looks;
  Approach both = line(0);
  both.scene = "gap = t (2 - t) in [0, 2] s, 0 at both ends";
  both.gap = [](double t) { return t * (2 - t); };
  both.gap_rate = [](double t) { return 2 - 2 * t; };
  const Approach arriving{"gap = t - 2 in [0, 2] s, which overlaps until the gap is 0 at t_high",
                          [](double t) { return t - 2; },
                          [](double) { return 1.0; },
                          0.0,
                          2.0,
                          kUnset};
  expect_impact(find(both, 1e-6, both_looks), both, both_looks, 0.0, 0.0,
                "t_low is tested first: a gap of exactly 0 there is the impact", 10);
  expect_no_impact(find(arriving, 1e-6, arriving_looks), arriving_looks, arriving.scene,
                   "g(t_low) < 0 is overlap from the start, whatever g(t_high) is");
}

// At 2^20 s doubles are 2^-32 s apart, more than the tolerance: the bracket ends at two neighbours,
// after 33 halvings of 2 s. @param most  calls, the two ends included, by the header's bound
void expect_last_bracket(const Finder& find, int most) {
  const double start = 0x1p20, spacing = 0x1p-32;
  const Approach late{
      "gap = 0.3 - (t - 2^20) in [2^20, 2^20 + 2] s, where doubles are 2.3e-10 s "
      "apart",
      [start](double t) { return 0.3 - (t - start); },
      [](double) { return -1.0; },
      start,
      start + 2,
      start + std::floor(0.3 / spacing) * spacing};
  Looks looks;
  const std::string slip =
      "the tolerance is below the distance of two doubles: stop when no double lies inside the "
      "bracket, not only when the bracket is small enough";
  expect_impact(find(late, 1e-12, looks), late, looks, 0.0, 0.0, slip, 10);
  expect_few(looks, most, late.scene, slip);
}

TEST(ImpactTimeBisection, KeepsTheConventionsOfTheEnds) { expect_conventions(bisect); }
TEST(ImpactTimeNewton, KeepsTheConventionsOfTheEnds) { expect_conventions(newton); }

TEST(ImpactTimeBisection, EndsAtTheLastBracketForTolerance0) {
  for (const Approach& approach : {dropped_ball(), thrown_ball(), spinning_rod()}) {
    Looks looks;
    expect_impact(bisect(approach, 0.0, looks), approach, looks, 0.0, kRoundOffTime,
                  "tolerance 0: stop when the middle is one of the ends", 11);
    expect_few(looks, 70, approach.scene, "tolerance 0: stop when the middle is one of the ends");
  }
  expect_last_bracket(bisect, 44);
}

TEST(ImpactTimeNewton, FindsTheLastDigitForTolerance0) {
  for (const Approach& approach : {dropped_ball(), thrown_ball(), spinning_rod()}) {
    Looks looks;
    expect_impact(
        newton(approach, 0.0, looks), approach, looks, 0.0, kRoundOffTime,
        "tolerance 0: go on until no double lies inside the bracket, and return its open end", 12);
    // Bisection needs some 56 looks, and the header allows 10 + 4 times that.
    expect_few(looks, 234, approach.scene,
               "tolerance 0: stop when no double lies inside the bracket, and bisect where it does "
               "not shrink");
  }
  expect_last_bracket(newton, 10 + 4 * 35);
}

TEST(ImpactTimeNewton, DoesNotCycle) {
  // From t = 0 Newton jumps to 1, and from 1 to 0, for ever; from elsewhere it wanders.
  const ScalarFunction g = [](double t) { return -(t * t * t - 2 * t + 2); },
                       rate = [](double t) { return -(3 * t * t - 2); };
  for (const auto& [low, high] : {std::pair{-3.0, 0.0}, {-3.0, 1.0}, {-2.0, 1.5}}) {
    const Approach approach{"gap = -(t^3 - 2 t + 2), looked for in [" + show(low) + ", " +
                                show(high) + "] s, where Newton cycles between 0 and 1",
                            g,
                            rate,
                            low,
                            high,
                            -1.7692923542386314152};
    Looks looks;
    expect_impact(newton(approach, 1e-10, looks), approach, looks, 1e-10, kRoundOffTime,
                  "no safeguard: cycling; bisect where the bracket does not shrink", 12);
    // Bisection needs 37 looks, and the header allows 10 + 4 times that: this gap turns twice, so
    // that its ends are no neighbourhood of the root.
    expect_few(looks, 158, approach.scene, "cycling: bisect where the bracket does not shrink");
  }
}

TEST(ImpactTimeNewton, SurvivesRootsOfHigherOrderAndSlopesThatLie) {
  const ScalarFunction cube = [](double t) { return -std::pow(t - 1, 3); };
  const ScalarFunction step = [](double t) { return t < 1 ? 1.0 : -1e-9; };
  const ScalarFunction line = [](double t) { return 1 - t; };
  const Approach approaches[] = {
      {"gap = -(t - 1)^3 in [0, 3.3] s: a triple root", cube,
       [](double t) { return -3 * (t - 1) * (t - 1); }, 0.0, 3.3, 1.0},
      {"a gap that jumps from 1 to -1e-9 at t = 1 s, in [0, 3.3] s, slope 0", step,
       [](double) { return 0.0; }, 0.0, 3.3, 1.0},
      {"gap = 1 - t in [0, 3.3] s with a slope of the wrong sign", line, [](double) { return 1.0; },
       0.0, 3.3, 1.0},
      {"gap = 1 - t in [0, 3.3] s with a slope 1000 times too steep", line,
       [](double) { return -1000.0; }, 0.0, 3.3, 1.0},
      {"gap = 1 - t in [0, 3.3] s with an infinite slope", line, [](double) { return -INFINITY; },
       0.0, 3.3, 1.0},
      {"gap = 1 - t in [0, 3.3] s with NaN as slope", line, [](double) { return std::nan(""); },
       0.0, 3.3, 1.0}};
  for (const Approach& approach : approaches) {
    Looks looks;
    expect_impact(
        newton(approach, 1e-9, looks), approach, looks, 1e-9, kRoundOffTime,
        "no safeguard: bisect where Newton's steps are no number, or do not shrink the bracket",
        12);
    // Bisection needs 2 + 32; the header allows 10 + 4 times that.
    expect_few(looks, 146, approach.scene, "the bracket does not shrink: bisect");
  }
}

TEST(ImpactTimeNewton, SeesAGrazeWhereTheEndsShowIt) {
  // A double root, dipped by 1e-12 m: the slope at the root is 2e-6, so rounding of the gap moves
  // it by 1e-10 s.
  const ScalarFunction dip = [](double t) { return (t - 1) * (t - 1) - 1e-12; },
                       touch = [](double t) { return (t - 1) * (t - 1); };
  const ScalarFunction rate = [](double t) { return 2 * (t - 1); };
  const Approach grazing{"gap = (t - 1)^2 - 1e-12 in [0, 1] s", dip, rate, 0.0, 1.0, 1 - 1e-6};
  const Approach touching{"gap = (t - 1)^2 in [0, 1] s, 0 at its end", touch, rate, 0.0, 1.0, 1.0};
  Looks looks, touch_looks, both_open;
  expect_impact(newton(grazing, 1e-12, looks), grazing, looks, 1e-12, 1e-10,
                "slope nearly 0: bisect", 12);
  expect_impact(newton(touching, 1e-12, touch_looks), touching, touch_looks, 1e-12, 0.0,
                "a gap of exactly 0 at t_high is an impact there", 10);
  const Approach missed{
      "gap = (t - 1)^2 - 1e-12 in [0, 3] s: open at both ends", dip, rate, 0.0, 3.0, kUnset};
  expect_no_impact(newton(missed, 1e-12, both_open), both_open, missed.scene,
                   "no status for a missing sign change");
}

TEST(ImpactTimeNewton, MeetsFiftyThrownBalls) {
  Random random(55);
  int calls = 0;
  for (int i = 0; i < 50; ++i) {
    const double height = random.between(0.5, 20), speed = random.between(-10, 10),
                 g = random.between(1, 25);
    const double root = (speed + std::sqrt(speed * speed + 2 * g * height)) / g;
    const Approach approach{"a ball at " + show(height) + " m, thrown up at " + show(speed) +
                                " m/s, g = " + show(g) + " m/s^2",
                            [=](double t) { return height + (speed - g / 2 * t) * t; },
                            [=](double t) { return speed - g * t; },
                            0.0,
                            1.7 * root,
                            root};
    Looks looks;
    // Rounding: 10 eps of the largest term, at most 80 m here, over an impact speed of at least 1
    // m/s.
    const double tolerance = 1e-12 * approach.t_high;  // so that bisection needs 42
    expect_impact(newton(approach, tolerance, looks), approach, looks, tolerance, 2e-13,
                  "t - g / g', and its safeguard", 12);
    calls += looks.calls;
  }
  // Together, not each: where rounding leads Newton's last step nowhere, a safeguard may well halve
  // the bracket from there.
  expect_true(calls <= 30 * 50, "at most 30 calls of the gap a ball, on average",
              show(calls / 50.0) + " calls",
              {.scene = "fifty thrown balls, tolerance 1e-12 of the interval",
               .slip = "the search goes on when the root is found, or the slope is not used",
               .handout = equation(12)});
}

}  // namespace
}  // namespace tumble::a2_testing
