/// Plots of pages as documents of their own: for handouts, slides and papers, where a page cannot go.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace tumble::report {

struct PlotDocument {
  std::string title;   // of the plot
  std::string name;    // of a file: small letters, digits and underscores, no two alike
  std::string svg;     // a document that stands alone, with its style, on a white ground
};

/// Every plot (svg_of) of a page, in the page's order.
/// @param page  its HTML; of a page without plots comes nothing
std::vector<PlotDocument> plots_in(std::string_view page);

}  // namespace tumble::report
