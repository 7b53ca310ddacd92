// The page on the cost of accuracy: which curves share an axis.
#include "framework/report/cost_page.h"

#include <fstream>
#include <iterator>

#include <gtest/gtest.h>

#include "framework/core/files.h"

namespace tumble::testing {
namespace {

using namespace report;

/// A curve of two runs with this counted quantity.
CostCurve counting(const std::string& name, const std::string& counted) {
  CostCurve curve;
  curve.name = name;
  curve.counted = counted;
  curve.points = {{"1/60 s", 1.0 / 60.0, 1e-2, 0.1, 100.0, ""},
                  {"1/120 s", 1.0 / 120.0, 1e-3, 0.2, 200.0, ""}};
  return curve;
}

CostPage page_of(std::vector<CostCurve> curves) {
  CostPage page;
  page.title = "Fall";
  page.floor = 1e-12;
  page.scale = 1.0;
  page.curves = std::move(curves);
  return page;
}

std::vector<std::string> drawn_in(const Plot& plot) {
  std::vector<std::string> names;
  for (const Curve& curve : plot.curves)
    if (!curve.x.empty()) names.push_back(curve.name);
  return names;
}

TEST(CostPage, NamesTheCommonCountedQuantity) {
  const std::vector<Plot> plots = plots_of_evaluations(
      page_of({counting("sweeps", "contact sweeps"), counting("newton", "contact sweeps")}));
  ASSERT_EQ(plots.size(), 1u);
  EXPECT_EQ(plots[0].x.name, "contact sweeps");
  EXPECT_EQ(drawn_in(plots[0]), (std::vector<std::string>{"sweeps", "newton"}));
}

TEST(CostPage, DrawsOnePlotPerCountedQuantity) {
  const std::vector<Plot> plots =
      plots_of_evaluations(page_of({counting("RK4", ""), counting("bisection", "gaps looked at"),
                                    counting("Euler", "derivatives asked for")}));
  ASSERT_EQ(plots.size(), 2u);
  // the page's quantity, unless a curve has its own
  EXPECT_EQ(plots[0].x.name, "derivatives asked for");
  EXPECT_EQ(drawn_in(plots[0]), (std::vector<std::string>{"RK4", "Euler"}));
  EXPECT_EQ(plots[1].x.name, "gaps looked at");
  EXPECT_EQ(drawn_in(plots[1]), (std::vector<std::string>{"bisection"}));
}

TEST(CostPage, DrawsNoPlotWithoutEvaluations) {
  CostCurve closed_form = counting("closed form", "");
  for (CostPoint& point : closed_form.points) point.evaluations = 0.0;
  EXPECT_TRUE(plots_of_evaluations(page_of({closed_form})).empty());
}

std::string written(const CostPage& page) {
  const PrivateFolder folder;
  write_cost_page(page, folder.path() / "index.html");
  std::ifstream in(folder.path() / "index.html");
  return {std::istreambuf_iterator<char>(in), {}};
}

// What a logarithmic axis cannot show as it is, the caption says.
TEST(CostPage, SaysWhereErrorsBelowTheReferencesAndOfZeroAreDrawn) {
  CostPage page = page_of({counting("RK4", "")});
  EXPECT_EQ(plot_of_price(page).caption.find("smaller than that of the reference"),
            std::string::npos);
  page.curves[0].points[1].error = 0.1 * page.floor;
  EXPECT_NE(plot_of_price(page).caption.find("smaller than that of the reference"),
            std::string::npos);

  page.curves[0].times = {0.0, 1.0};
  page.curves[0].energy_errors = {0.0, 1e-9};
  EXPECT_NE(written(page).find("A difference of 0 is drawn at "), std::string::npos);
}

// Lines of a text are wrapped in the column of a phone, where nobody reads them any more.
TEST(CostPage, ListsEveryRunInATable) {
  CostPage page = page_of({counting("RK4", "")});
  page.error_unit = "m";
  page.marks = {1e-3};
  page.curves[0].points.push_back({"1/2 s", 0.5, 0.0, 0.0, 0.0, "body 'A' is lost"});
  const std::string html = written(page), runs = html.substr(html.find("Every run"));
  EXPECT_EQ(runs.find("<pre"), std::string::npos) << runs;
  EXPECT_NE(runs.find(">0.01</td>"), std::string::npos) << runs;
  EXPECT_NE(runs.find(">body &#39;A&#39; is lost</td>"), std::string::npos) << runs;
}

TEST(CostPage, ListsWhatWasNotRunAndWhy) {
  CostPage page = page_of({counting("RK4", "")});
  EXPECT_EQ(written(page).find("Not run: "), std::string::npos);
  page.not_run = {"tw: bodies fall asleep", "Euler: the budget is used up"};
  const std::string html = written(page);
  EXPECT_NE(html.find("Not run: tw: bodies fall asleep."), std::string::npos);
  EXPECT_NE(html.find("Not run: Euler: the budget is used up."), std::string::npos);
}

TEST(CostPage, ShowsSharesOfTheTimeInPercent) {
  CostCurve curve = counting("RK4", "");
  curve.times = {0.0, 1.0};
  curve.energy_errors = {0.0, 1e-6};
  curve.stage_seconds = {{"detect", 0.03}, {"integrate", 0.01}, {"impulses", 0.0}};
  const std::string html = written(page_of({curve}));
  EXPECT_NE(html.find(">75<"), std::string::npos);
  EXPECT_NE(html.find(">25<"), std::string::npos);
  EXPECT_EQ(html.find(">impulses<"), std::string::npos);  // a stage without time is left out
  EXPECT_EQ(html.find("Recording keeps"), std::string::npos);
}

// A share of 1 % has no number in its bar.
TEST(CostPage, SaysWhichShareOfCpuTimeRecordingTakes) {
  CostCurve curve = counting("RK4", "");
  curve.times = {0.0, 1.0};
  curve.energy_errors = {0.0, 1e-6};
  curve.stage_seconds = {{"integration", 0.099}, {"recording", 0.001}};
  EXPECT_NE(written(page_of({curve})).find("Every CPU time on this page holds it: 1 % of these"),
            std::string::npos);
  CostCurve other = curve;
  other.stage_seconds = {{"integration", 0.04}, {"recording", 0.06}};
  EXPECT_NE(written(page_of({curve, other})).find("holds it: 1 to 60 % of these runs."),
            std::string::npos);
}

}  // namespace
}  // namespace tumble::testing
