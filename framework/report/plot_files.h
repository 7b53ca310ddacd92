/// Plots of pages as stand-alone documents, for handouts, slides and papers.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace tumble::report {

struct PlotDocument {
  std::string title;  // of the plot
  std::string name;   // of a file: lower-case letters, digits and underscores; unique
  std::string svg;    // a complete document with its style and a white background
};

/// Every plot (svg_of) of a page, in the page's order.
/// @param page  its HTML
std::vector<PlotDocument> plots_in(std::string_view page);

}  // namespace tumble::report
