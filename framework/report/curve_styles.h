/// Colours, dashes and marks of a plot's curves, by their place in it.
///
/// From dark to light for print, distinguishable to colour-blind readers (after M. Okabe, K. Ito,
/// "Color universal design", 2008). More than eight colours are hard to distinguish: the second
/// eight curves repeat them with other dashes, thinner lines and hollow marks.
#pragma once

#include <cstddef>
#include <string>

namespace tumble::report {

inline constexpr std::size_t kColours = 8;  // and shapes of marks

const char* colour_of(std::size_t place);
double width_of(std::size_t place);

/// An attribute of SVG with a blank before it; empty for a whole line.
std::string dashes_of(std::size_t place);

/// An element of SVG: the mark of a curve around (x, y), in units of the drawing.
std::string mark(double x, double y, std::size_t place);

}  // namespace tumble::report
