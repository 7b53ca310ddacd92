/// The code of a C++ source, without what only people read.
#pragma once

#include <cstddef>
#include <string>

namespace tumble {

/// The same text with comments and preprocessor lines blanked: places stay. Text between quotes is
/// kept.
std::string code_of(std::string text);

/// The place behind the round bracket that closes the one at `open`; npos where none does within
/// what is long for a list of parameters.
std::size_t behind_bracket(const std::string& code, std::size_t open);

}  // namespace tumble
