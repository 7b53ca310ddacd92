// Plots of a page as stand-alone documents.
#include <gtest/gtest.h>

#include "framework/report/html.h"
#include "framework/report/plot.h"
#include "framework/report/plot_files.h"

namespace tumble::testing {
namespace {

using namespace report;

Plot plot(const std::string& title) {
  Plot plot{title, {"time", "s"}, {"energy", "J"}, {}, {}};
  plot.curves.push_back({"E", {0, 1, 2}, {3, 4, 5}});
  return plot;
}

TEST(PlotFiles, AreAllPlotsOfAPageInOrderWithUniqueNames) {
  Page page("Two");
  page.plot(plot("Energy, if w < 1 & \"h\" > 0"));
  page.plot(plot("Energy"));
  page.plot(plot("Energy"));
  const auto plots = plots_in(page.html());
  ASSERT_EQ(plots.size(), 3u);
  EXPECT_EQ(plots[0].title, "Energy, if w < 1 & \"h\" > 0");
  EXPECT_EQ(plots[0].name, "energy_if_w_1_h_0");
  EXPECT_EQ(plots[1].name, "energy");
  EXPECT_EQ(plots[2].name, "energy_2");
}

TEST(PlotFiles, AreCompleteWithSizeStyleAndBackground) {
  Page page("One");
  page.plot(plot("Energy"));
  const std::string svg = plots_in(page.html()).at(0).svg;
  EXPECT_TRUE(svg.starts_with("<?xml"));
  for (const std::string part :
       {"xmlns=\"http://www.w3.org/2000/svg\"", "width=\"640\"", "viewBox=\"0 0 640 ",
        "svg.plot .grid", "fill=\"#fff\"", ">time [s]<", ">energy [J]<", "</svg>"})
    EXPECT_NE(svg.find(part), svg.npos) << part << "\n" << svg;
  EXPECT_EQ(svg.find("var(--"), svg.npos) << "a colour that is defined only in pages";
  EXPECT_EQ(svg.find("<svg", svg.find("<svg") + 1), svg.npos);
}

TEST(PlotFiles, AreAbsentInAPageWithoutPlots) {
  EXPECT_TRUE(plots_in(Page("Empty").html()).empty());
  EXPECT_TRUE(plots_in("").empty());
  EXPECT_TRUE(plots_in("<svg class=\"plot\" viewBox=\"0 0 640 360\" cut short").empty());
}

}  // namespace
}  // namespace tumble::testing
