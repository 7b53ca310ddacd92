/// Makes text from students (names, output of their code) safe to show in terminals, tables and
/// JSON.
///
/// Characters that are invisible or reorder their neighbours are replaced by their code points:
/// control characters, direction overrides (the "Trojan source" set), invisible characters, bytes
/// that are not UTF-8. Different names stay different.
#pragma once

#include <string>
#include <string_view>

namespace tumble::grading {

/// One line: line ends, tabs and backslashes are escaped too, so that no two texts become equal.
std::string plain_name(std::string_view text);

/// Several lines: line ends, tabs and backslashes stay, terminal colours are dropped.
std::string plain_text(std::string_view text);

/// A quoted argument for a command line that the user pastes into a shell: always exactly one
/// argument, never a command.
std::string shell_word(std::string_view text);

}  // namespace tumble::grading
