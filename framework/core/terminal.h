/// What a terminal shows: colours or none, how wide it is, and text broken to that width.
#pragma once

#include <cstddef>
#include <string>

namespace tumble {

/// Whether text written to the descriptor may have colours: it is a terminal that has them
/// ($TERM is not "dumb"), and the user has not asked for none ($NO_COLOR, no-color.org).
bool shows_colours(int descriptor);

/// Columns of the terminal behind the descriptor. 80 where it does not say, and where it is none.
std::size_t terminal_columns(int descriptor);

/// The text with each of its lines broken at spaces to at most `columns` columns; a longer word
/// stays whole. A continued line begins with `indent` spaces. Lines that fit are not changed.
/// Counts code points of UTF-8, each one column wide.
std::string wrapped(const std::string& text, std::size_t columns, std::size_t indent);

}  // namespace tumble
