// The total order of events (A4.1).
#include "tests/a4_timewarp/a4_fixtures.h"

namespace tumble::a4_testing {
namespace {

void expect_before(const Stamp& first, const Stamp& second, const std::string& slip) {
  const Story story{
      .scene = "x: " + show(first) + "; y: " + show(second), .slip = slip, .handout = equation(1)};
  const bool is_first = a4_module().comes_before(first, second),
             is_second = a4_module().comes_before(second, first);
  expect_true(is_first && !is_second, "x before y, and not y before x",
              std::string(is_first ? "x before y" : "not x before y") +
                  (is_second ? ", y before x" : ", not y before x"),
              story);
}

TEST(ComesBefore, TheEarlierTimeIsFirst) {
  const std::string slip =
      "not the order of time: the entry that came into the queue first, or has the lower number, "
      "is not first for that";
  expect_before(impact(0.25, C, D), impact(0.5, A, B), slip);
  expect_before({0.25, 7, WorkKind::kRedraw, -1, -1}, {0.25000001, 0, WorkKind::kCallback, A, -1},
                slip);
}

TEST(ComesBefore, TimesAreComparedAsTheyAre) {
  const std::string slip =
      "a tolerance in the order: it is no order any more (x = y and y = z, but x before z), and "
      "what is committed depends on which two were compared";
  expect_before(impact(just_before(1.0), C, D, 3), impact(1.0, A, B), slip);
  expect_before(impact(1e-12, C, D), impact(2e-12, A, B), slip);
}

TEST(ComesBefore, AtOneInstantTheCauseIsFirst) {
  const std::string slip =
      "the microstep stands before kind and bodies: an effect must not come before its cause";
  expect_before(impact(1.0, C, D, 0), impact(1.0, A, B, 1), slip);
  expect_before({1.0, 1, WorkKind::kRedraw, -1, -1}, {1.0, 2, WorkKind::kCallback, A, -1}, slip);
}

TEST(ComesBefore, TiesGoByKindThenBodies) {
  expect_before(callback(D, 1.0).stamp, impact(1.0, A, B),
                "of one time and microstep, the kinds in the order of WorkKind");
  expect_before(impact(1.0, C, D), {1.0, 0, WorkKind::kGroup, A, -1},
                "of one time and microstep, the kinds in the order of WorkKind");
  expect_before(impact(1.0, A, D), impact(1.0, B, C),
                "of one time, microstep and kind, the lower body_a");
  expect_before(impact(1.0, A, B), impact(1.0, A, C),
                "of one time, microstep, kind and body_a, the lower body_b");
}

TEST(ComesBefore, NothingIsBeforeItself) {
  // otherwise a function that always returns false would pass
  expect_before(impact(1.0, A, B), impact(2.0, A, B), "not the order of time");
  for (const Stamp& stamp : {impact(1.0, A, B), redraw(2.0).stamp, callback(C, 0.0).stamp})
    expect_true(!a4_module().comes_before(stamp, stamp), "not before itself", "before itself",
                {.scene = show(stamp),
                 .slip = "<= in place of <: queues do not survive an order in which equals come "
                         "before each other",
                 .handout = equation(1)});
}

}  // namespace
}  // namespace tumble::a4_testing
