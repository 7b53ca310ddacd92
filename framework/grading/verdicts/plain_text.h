/// Text of students (names, what their code printed) made safe to show: in terminals, tables, JSON.
///
/// What cannot be seen, or reorders what stands beside it, is written out as a code point: control characters, direction
/// overrides (the "Trojan source" set), invisible characters, bytes that are not UTF-8. Different names stay different.
#pragma once

#include <string>
#include <string_view>

namespace tumble::grading {

/// One line: line ends and tabs are written out as well, and so is a backslash, so that no two texts become the same.
std::string plain_name(std::string_view text);

/// Several lines: line ends and tabs stay, terminal colours are dropped, a backslash stays what it is.
std::string plain_text(std::string_view text);

/// One word of a command line that a person pastes into a shell: whatever a name holds, it stays that one word and nothing is run.
std::string shell_word(std::string_view text);

}  // namespace tumble::grading
