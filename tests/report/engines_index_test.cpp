// The comparison of engines as a page: limits of the cost model, the slides' figures beside ours,
// and a scene that failed.
#include "framework/report/engines_index.h"

#include <cmath>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>

#include "framework/core/files.h"
#include "framework/report/engines_model.h"

namespace tumble::testing {
namespace {

using namespace report;

constexpr double kRounding = 1e-12;

EngineRow row_of(const std::string& engine, const std::string& label, int bodies, double cpu_s,
                 std::uint64_t integrations) {
  EngineRow row;
  row.engine = engine;
  row.label = label;
  row.meaning = engine;
  row.bodies = bodies;
  row.simulated_s = 2.0;
  row.step_s = 1.0 / 30.0;
  row.w_h = 0.2;
  row.cpu_s = cpu_s;
  row.counts = {{"integrations", integrations}};
  return row;
}

std::vector<std::vector<EngineRow>> ladder() {
  return {{row_of("rd", "RD-1/30", 100, 3.0, 100000), row_of("ca", "CA", 100, 0.5, 50000),
           row_of("tw", "TW", 100, 0.1, 4000)},
          {row_of("rd", "RD-1/30", 150, 6.0, 300000), row_of("tw", "TW", 150, 0.2, 6000)}};
}

// n (1 + p) / p lambda: one integration per step while discontinuities are rare, two per
// discontinuity where every step contains some.
TEST(ModelOfCost, RetroactiveDetectionHasItsTwoLimits) {
  constexpr double kN = 10, kStep = 0.01, kRare = 1e-9, kOften = 1e6;  // w [1/s]
  EXPECT_NEAR(*modelled_integrations("rd", kN, kRare, kStep), kN / kStep, 1e-9 * kN / kStep);
  EXPECT_NEAR(*modelled_integrations("rd", kN, kOften, kStep), kN * kN * kOften,
              kRounding * kN * kN * kOften);
}

// By hand: lambda = 300 1/s, lambda h = 10.
TEST(ModelOfCost, GivesTheNumbersOfAtoms) {
  EXPECT_NEAR(*modelled_integrations("ca", 100, 6.0, 1.0 / 30.0), 93000.0, kRounding * 93000.0);
  EXPECT_NEAR(*modelled_integrations("tw", 100, 6.0, 1.0 / 30.0), 4800.0, kRounding * 4800.0);
  EXPECT_NEAR(*modelled_integrations("rd", 100, 6.0, 1.0 / 30.0),
              30000.0 * (1.0 + 1.0 / (1.0 - std::exp(-10.0))), 1e-7);
}

TEST(ModelOfCost, TimewarpGrowsWithTheNumberOfBodiesAndTheOthersWithItsSquare) {
  constexpr double kW = 6.0, kStep = 1e9;  // steps so long that only discontinuities count
  const auto growth = [&](const char* engine) {
    return *modelled_integrations(engine, 2e6, kW, kStep) /
           *modelled_integrations(engine, 1e6, kW, kStep);
  };
  EXPECT_NEAR(growth("tw"), 2.0, kRounding);
  EXPECT_NEAR(growth("ca"), 4.0, kRounding);
  EXPECT_NEAR(growth("rd"), 4.0, kRounding);
  EXPECT_FALSE(modelled_integrations("ordered", 1, 1, 1));
}

TEST(TablesOfEngines, PutTheSlidesFiguresWhereSizesAreTheSame) {
  const Table table = table_of_slides(ladder());
  ASSERT_EQ(table.rows.size(), 3U);  // 100 atoms; the slides have no row for 150
  EXPECT_EQ(table.rows[0][2].text, "0.142");
  EXPECT_EQ(table.rows[0][4].text, "0.97");  // 0.142 / 0.147
  EXPECT_EQ(table.rows[0][5].text, "30");    // 3.0 / 0.1
  EXPECT_EQ(table.rows[1][5].text, "5.00");
}

// The page states the source of each figure, and why the ratio for 100 atoms differs from the
// slides'.
TEST(PageOfEngines, StatesTheSourceOfTheModelAndWhyTheSlidesDiffer) {
  const PrivateFolder folder;
  write_engines_index(
      {{}, ladder(), {{row_of("tw", "TW", 1, 0.001, 31)}}, {}, false, "tumble engines"},
      folder.path() / "index.html");
  std::ifstream file(folder.path() / "index.html");
  const std::string page{std::istreambuf_iterator<char>(file), {}};
  EXPECT_EQ(page.find("the slides count integrations"), std::string::npos);
  for (const char* words :
       {"This model is ours", "the sizes are ours", "Why RD / TW of 100 atoms",
        "100 atoms: RD / TW 30.0 in time, 25.0 in integrations, 13 by our model"})
    EXPECT_NE(page.find(words), std::string::npos) << words;
}

TEST(TablesOfEngines, PutTheMeanStepBesideW) {
  EnginesScene often, rare;
  often.name = "often";
  often.rows = ladder().front();
  rare = often;
  rare.name = "rare";
  for (EngineRow& row : rare.rows) row.w_h = 0.1;
  const Table table = table_of_mean_steps({often, rare});
  ASSERT_EQ(table.rows.size(), 2U);
  EXPECT_EQ(table.rows[0][0].text, "rare");  // w ascending
  EXPECT_EQ(table.rows[0][2].text, "3");     // 0.1 over 1/30 s
  EXPECT_EQ(table.rows[1][3].text, "600");   // 100 bodies, 6 1/s each
  EXPECT_EQ(table.rows[1][5].text, "2");     // ms: 100 bodies, 2 s, 100,000 integrations
  EXPECT_EQ(table.rows[1][7].text, "50");    // 4,000 integrations
}

TEST(TablesOfEngines, CountStepsAndWork) {
  const Table table = table_of_ladder(ladder());
  ASSERT_EQ(table.rows.size(), 5U);
  EXPECT_EQ(table.rows[0][3].text, "2");    // ms: 100 bodies, 2 s, 100,000 integrations
  EXPECT_EQ(table.rows[0][4].text, "500");  // integrations per body and second
  EXPECT_EQ(table_of_model(ladder()).rows.size(), 5U);
}

TEST(PageOfEngines, BeginsWithTheFastestAndHowMuchLongerTheOthersTake) {
  const PrivateFolder folder;
  write_engines_page("Atoms", "About.", ladder().front(), {}, "", folder.path() / "index.html");
  std::ifstream in(folder.path() / "index.html");
  const std::string html{std::istreambuf_iterator<char>(in), {}};
  const auto headline = html.find(
      "TW takes the least time in this run: RD-1/30 30 times as long, CA 5 times as long.");
  EXPECT_LT(headline, html.find("About.")) << html;
}

TEST(BarsOfEngines, ShowKeptAndUndoneWorkAndTime) {
  std::vector<EngineRow> rows = ladder().front();
  rows[2].counts = {{"integrations", 4000}, {"undone_integrations", 1000}, {"pair_checks", 70}};
  rows[0].stopped_by = "it takes more than 60 s";
  const auto bars = bars_of_work(rows);
  ASSERT_EQ(bars.size(), 3U);
  for (const StackedBars& of : bars) ASSERT_EQ(of.rows.size(), 2U) << "a stopped run has no bar";
  EXPECT_EQ(bars[0].rows[1].values, (std::vector<double>{3000, 1000}));
  EXPECT_EQ(bars[1].rows[1].values, std::vector<double>{70});
  EXPECT_EQ(bars[2].rows[1].values, std::vector<double>{100});  // 0.1 s in ms
}

TEST(BarsOfEngines, ShowTheTimeOfRunsThatWereLongEnough) {
  std::vector<EngineRow> rows = ladder().front();
  EXPECT_TRUE(bars_of_time(rows).rows.empty());
  rows[1].time_parts = {{"contacts", 0.75}, {"scheduling", 0.25}};
  rows[1].physics = 0.75;
  const StackedBars bars = bars_of_time(rows);
  ASSERT_EQ(bars.rows.size(), 1U);
  EXPECT_EQ(bars.rows[0].values, (std::vector<double>{75, 25}));
  EXPECT_NE(bars.caption.find("75 % of CA's"), std::string::npos) << bars.caption;
  EXPECT_NE(bars.caption.find("Too short to measure: RD-1/30, TW."), std::string::npos)
      << bars.caption;
}

TEST(PageOfEngines, ShowsEachSceneAndWhatFailed) {
  EnginesScene fine;
  fine.name = "atoms";
  fine.title = "Atoms & molecules";
  fine.rows = ladder().front();
  fine.rows[0].agreement = "first 5 collisions of each body within 1e-9 s";
  EnginesScene failed;
  failed.name = "big_cars";
  failed.problem = "a wheel came off";
  const PrivateFolder folder;
  write_engines_index({{fine, failed},
                       ladder(),
                       {{row_of("tw", "TW", 1, 0.001, 31)}, {row_of("tw", "TW", 200, 0.001, 1500)}},
                       {},
                       false,
                       "tumble engines"},
                      folder.path() / "index.html");
  std::ifstream file(folder.path() / "index.html");
  const std::string page{std::istreambuf_iterator<char>(file), {}};
  for (const char* words : {"Atoms &amp; molecules", "id=\"atoms\"", "a wheel came off",
                            "Average integration step", "The model of cost", "first 5 collisions",
                            "--full", "TW, ignoring each other", "timewarp does 1/"})
    EXPECT_NE(page.find(words), std::string::npos) << words;
  EXPECT_NE(
      page.find(">Pong by size</a> <a href=\"#atoms\">Atoms</a> <a href=\"#big_cars\">Big cars<"),
      std::string::npos)
      << page.substr(page.find("<nav>"), 600);
  const Table table = table_of_scenes({fine, failed});
  EXPECT_EQ(table.rows[0][5].text, "30");
  EXPECT_EQ(table.rows[0][6].text, "25");  // integrations, beside what the model expects of them
  EXPECT_EQ(table.columns[7].name, "by the model");
  for (const auto& row : table.rows) EXPECT_EQ(row.size(), table.columns.size());
}

// By hand: 100 bodies of 6 discontinuities a second, h = 1/30 s: lambda h = 10, so RD's model is
// 100 * 300 * 2 = 60,000 a second, and 100,000 in 2 s were counted: 0.83.
TEST(TablesOfEngines, SayOnWhichSideOfTheModelTheEnginesLie) {
  const std::vector<EngineRow> below = {row_of("rd", "RD-1/30", 100, 0.2, 100000)};
  std::vector<EngineRow> above = {row_of("rd", "RD-1/30", 100, 0.2, 150000)};
  EXPECT_EQ(place_beside_model({below}), " Counted over model here: RD 0.83, below it.");
  EXPECT_EQ(place_beside_model({above}), " Counted over model here: RD 1.25, above it.");
  EXPECT_EQ(place_beside_model({below, above}),
            " Counted over model here: RD 0.83 to 1.25, on both sides of it.");
  EXPECT_EQ(place_beside_model({}), "");
}

}  // namespace
}  // namespace tumble::testing
