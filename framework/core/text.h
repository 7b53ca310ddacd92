/// Small helpers for words.
#pragma once

#include <string>

namespace tumble {

/// ASCII letters made small; other bytes stay.
std::string lowercase(std::string text);

/// At most `width` bytes: what is longer loses its middle, "begin..end".
std::string without_middle(const std::string& text, std::size_t width);

}  // namespace tumble
