// The battery's rows and page: what holds, what is a shortfall, what must fail, and how each is
// reported.
#include "framework/report/battery_page.h"

#include <cmath>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>

#include "framework/core/files.h"

namespace tumble::testing {
namespace {

using namespace report;

Measure at_most(double value, double threshold) {
  Measure m;
  m.what = "drift";
  m.value = value;
  m.threshold = threshold;
  m.unit = "m";
  return m;
}

TEST(BatteryRows, MarginIsHowManyTimesBetter) {
  EXPECT_EQ(margin_of(at_most(1e-6, 1e-3)), 1e-3 / 1e-6);
  EXPECT_EQ(shown_margin(at_most(0.0, 1e-3)), "exact");
  EXPECT_EQ(shown_margin(at_most(0.0, 0.0)), "exact");
  EXPECT_EQ(shown_margin(at_most(1e-13, 1e-6)), "x 1e7");  // as axes write it, not 1e+07
  EXPECT_EQ(shown_margin(at_most(4.7e-10, 7e-8)), "x 150");
  EXPECT_EQ(shown_threshold(at_most(5e-11, 1e-6)), "<= 1e-6 m");
  Measure gap = at_most(-1e-5, 0.0);
  gap.at_least = true;
  EXPECT_EQ(outcome_of(gap), Outcome::kBroken);
  EXPECT_EQ(margin_of(gap), 0.0);
}

TEST(BatteryRows, AreDecidedByTheWorstMeasure) {
  BatteryRow row;
  EXPECT_EQ(outcome_of(row), Outcome::kNotRun);
  EXPECT_EQ(tightest(row), nullptr);
  row.measures = {at_most(1e-9, 1e-3), at_most(1e-4, 1e-3)};
  EXPECT_EQ(outcome_of(row), Outcome::kHolds);
  EXPECT_EQ(tightest(row), &row.measures[1]);
  row.measures.push_back(at_most(std::nan(""), 1e-3));
  EXPECT_EQ(outcome_of(row), Outcome::kBroken);
  EXPECT_EQ(tightest(row), &row.measures[2]);
  row.measures[2].shortfall = "known";
  EXPECT_EQ(outcome_of(row), Outcome::kShort);
  EXPECT_TRUE(count_of({row}).good());
}

TEST(BatteryRows, StoppingAMethodThatMustFailIsItsFailure) {
  Measure m = at_most(std::nan(""), std::nan(""));
  m.must_fail = true;
  m.error = "runaway energy";
  EXPECT_EQ(outcome_of(m), Outcome::kFailsAsItMust);
}

TEST(BatteryRows, ShortfallThatHoldsIsReported) {
  BatteryRow row;
  row.measures = {at_most(1e-9, 1e-3)};
  row.measures[0].shortfall = "was not reached";
  EXPECT_EQ(outcome_of(row), Outcome::kHolds);
  EXPECT_NE(sentence_of(count_of({row})).find("1 listed as shortfalls hold here"),
            std::string::npos);
}

TEST(BatteryPage, ShowsEveryCaseWithItsReasons) {
  BatteryRow holds{1, "stack", "Boxes <one> on another.", {at_most(1e-9, 1e-3)}, {}},
      pending{2, "timewarp", "Rollback.", {}, {}, "there is no timewarp yet"};
  holds.measures.push_back(at_most(1.0, 1e-3));
  holds.measures[1].shortfall = "edges have no normal";
  holds.plots.push_back({"plot", {"x"}, {"y"}, {{"c", {1, 2}, {1, 2}}}, {}});
  const PrivateFolder folder;
  write_battery_page({holds, pending}, "short runs", "tumble battery",
                     folder.path() / "battery.html");
  std::ifstream file(folder.path() / "battery.html");
  const std::string html(std::istreambuf_iterator<char>(file), {});
  for (const char* words : {"SHORT", "edges have no normal", "there is no timewarp yet",
                            "Boxes &lt;one&gt; on another.", "<svg", "short runs", "tumble battery",
                            "href=\"#case-1\"", "id=\"case-1\""})
    EXPECT_NE(html.find(words), std::string::npos) << words;
}

}  // namespace
}  // namespace tumble::testing
