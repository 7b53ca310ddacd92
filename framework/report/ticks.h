/// Numbers at an axis, and words broken into lines: what drawings of plots share.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace tumble::report {

enum class Scale { kLinear, kLog };

/// The ticks of an axis: round numbers in [low, high], about as many as `most` says, from four on
/// where it is 6; powers of ten (or some of them) on a logarithmic axis, and numbers between them
/// where there are fewer than three.
/// @pre low < high, finite; positive where logarithmic
std::vector<double> ticks_of(double low, double high, Scale scale, int most = 6);

/// The ticks as text, all in one style: 0.01, 0.1, 1, or, where one of them would be long, 1e-4,
/// 1e-3, 1e-2; on a linear axis with one power, 0.5e6, 1e6, and what rounding left beside 0 is 0.
std::vector<std::string> tick_words(std::vector<double> ticks, Scale scale);

/// The words in lines of at most so many letters, broken at blanks; a longer word is a line of its
/// own. @return at least one line
std::vector<std::string> wrapped(std::string_view words, std::size_t letters);

}  // namespace tumble::report
