/// Numbers at an axis, and words broken into lines: what drawings of plots share.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "framework/report/plot.h"

namespace tumble::report {

/// The ticks as text, all in one style: 0.01, 0.1, 1, or, where one of them would be long, 1e-4,
/// 1e-3, 1e-2; on a linear axis with one power, 0.5e6, 1e6, and what rounding left beside 0 is 0.
std::vector<std::string> tick_words(std::vector<double> ticks, Scale scale);

/// The words in lines of at most so many letters, broken at blanks; a longer word is a line of its
/// own. @return at least one line
std::vector<std::string> wrapped(std::string_view words, std::size_t letters);

}  // namespace tumble::report
