#include "framework/core/code_text.h"

#include <algorithm>

namespace tumble {

std::string code_of(std::string text) {
  bool line_begins = true;
  for (std::size_t i = 0; i < text.size();) {
    const auto blank_until = [&](std::size_t end) {
      for (; i < std::min(end, text.size()); ++i)
        if (text[i] != '\n') text[i] = ' ';
    };
    const char c = text[i];
    if (line_begins && c == '#')
      blank_until(text.find('\n', i));
    else if (text.compare(i, 2, "//") == 0)
      blank_until(text.find('\n', i));
    else if (text.compare(i, 2, "/*") == 0)
      blank_until(std::min(text.find("*/", i + 2), text.size() - 2) + 2);
    else if (c == '"') {
      for (++i; i < text.size() && text[i] != '"' && text[i] != '\n'; ++i)
        i += text[i] == '\\' ? 1 : 0;
      ++i, line_begins = false;
    } else {
      line_begins = c == '\n' || (line_begins && (c == ' ' || c == '\t'));
      ++i;
    }
  }
  return text;
}

std::size_t behind_bracket(const std::string& code, std::size_t open) {
  constexpr std::size_t kLongest = 4096;
  int depth = 0;
  for (std::size_t i = open; i < std::min(code.size(), open + kLongest); ++i) {
    if (code[i] == '(') ++depth;
    if (code[i] == ')' && --depth == 0) return i + 1;
  }
  return std::string::npos;
}

}  // namespace tumble
