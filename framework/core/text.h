/// Small helpers for strings.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace tumble {

/// ASCII letters in lower case; other bytes stay.
std::string lowercase(std::string text);

/// "1 test", "3 tests".
std::string counted(std::size_t n, const std::string& noun);

/// At most `width` bytes: a longer text loses its middle, "begin..end".
std::string without_middle(const std::string& text, std::size_t width);

/// "int a, std::map<int, int> b" -> two parts: commas inside brackets divide nothing.
std::vector<std::string> at_commas(const std::string& text);

}  // namespace tumble
