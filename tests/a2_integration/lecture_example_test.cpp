// The lecture's worked example, y' = 6 y - 0.007 y^2, y(0) = 10, one step of 0.5: the table of the
// handout, number by number.
#include "tests/a2_integration/a2_fixtures.h"

namespace tumble::a2_testing {
namespace {

const std::string kReadExample = "handouts/a2_integration.md#worked-example";
// relative; the floors of these values are 1 eps, the example amplifies none
constexpr double kExampleRoundoff = 100 * kEps;

TEST(LectureExample, EulerGives39Point65) {
  const double found = a2_module().euler_step(logistic, 0.0, vector({10}), 0.5)[0];
  expect_near(found, 39.65, kExampleRoundoff * 39.65, "",
              {.scene = "y' = 6 y - 0.007 y^2, y = 10, h = 0.5",
               .slip = likely(found,
                              Slips<double>{{29.65, "the old y is missing"},
                                            {69.3, "the slope is not multiplied by h"}},
                              "y + h f(t, y)"),
               .handout = kReadExample});
}

TEST(LectureExample, Rk4Gives141Point63) {
  const double found = a2_module().rk4_step(logistic, 0.0, vector({10}), 0.5)[0];
  expect_near(found, 141.630290046212432779611631247, kExampleRoundoff * 141.63, "",
              {.scene = "y' = 6 y - 0.007 y^2, y = 10, h = 0.5; the exact solution is at 164.2768",
               .slip = rk4_slip(likely(found,
                                       Slips<double>{{39.65, "this is Euler's method"},
                                                     {82.3180178125, "this is the midpoint method"},
                                                     {10.0, "y stays as it is"}},
                                       "the times of the stages, or h")),
               .handout = kReadExample});
}

TEST(LectureExample, StagesAreThoseOfTheHandoutNotOfTheSlide) {
  Diary diary;
  a2_module().rk4_step(noting(diary, logistic), 0.0, vector({10}), 0.5);
  expect_near(static_cast<double>(diary.calls()), 4.0, 0.0, "calls of the derivative",
              {.scene = "one step", .slip = "four slopes", .handout = kReadExample});
  if (diary.calls() != 4) return;
  // y of the stage, and the slope there. The slide prints 263.0 for k3, but continues with 141.0 =
  // 10 + 0.5 * 262.04.
  const double stages[4][2] = {{10, 59.3},
                               {24.825, 144.636035625},
                               {46.15900890625, 262.0394747150491322509765625},
                               {141.01973735752456612548828125, 706.912459874450928853386449959}};
  for (std::size_t i = 0; i < 4; ++i) {
    const Story story{.scene = "stage " + std::to_string(i + 1) + " of the lecture's step",
                      .slip = "the stage before, or h/2",
                      .handout = kReadExample};
    expect_near(diary.states[i], vector({stages[i][0]}), kExampleRoundoff * stages[i][0], "",
                story);
    expect_near(logistic(0, diary.states[i]), vector({stages[i][1]}),
                kExampleRoundoff * stages[i][1], "", story);
  }
}

TEST(LectureExample, TableOfConvergenceIsTheHandouts) {
  struct Row {
    int steps;
    double euler, rk4;
  };
  const Row rows[] = {{1, 39.65, 141.6302900462124327796},
                      {2, 60.98400890625, 160.2176363904532076203},
                      {4, 88.73873070294001691515, 163.8383715363258744458},
                      {8, 115.9717839182280996077, 164.2406431215225962016},
                      {16, 136.4810807418924634774, 164.2741593103863709451},
                      {32, 149.303566678242350697, 164.2765785517316330756},
                      {64, 156.4985449940377754689, 164.2767410646114239907}};
  for (const Row& row : rows) {
    const Story story{
        .scene = "the lecture's equation to t = 0.5",
        .steps = row.steps == 1 ? "1 step" : std::to_string(row.steps) + " equal steps",
        .slip = "one step is wrong: see the tests above",
        .handout = kReadExample};
    expect_near(integrate(a2_module().euler_step, logistic, 0, vector({10}), 0.5, row.steps)[0],
                row.euler, kExampleRoundoff * row.euler, "(Euler)", story);
    const double by_rk4 =
        integrate(a2_module().rk4_step, logistic, 0, vector({10}), 0.5, row.steps)[0];
    if (!(std::abs(by_rk4 - row.rk4) <= kExampleRoundoff * row.rk4))
      expect_near(by_rk4, row.rk4, kExampleRoundoff * row.rk4, "(RK4)",
                  with_slip(story, rk4_slip(story.slip)));
  }
}

}  // namespace
}  // namespace tumble::a2_testing
