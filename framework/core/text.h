/// Small helpers for strings.
#pragma once

#include <cstddef>
#include <string>

namespace tumble {

/// ASCII letters in lower case; other bytes stay.
std::string lowercase(std::string text);

/// "1 test", "3 tests".
std::string counted(std::size_t n, const std::string& noun);

/// At most `width` bytes: a longer text loses its middle, "begin..end".
std::string without_middle(const std::string& text, std::size_t width);

}  // namespace tumble
