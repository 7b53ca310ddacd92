#include "framework/core/terminal.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>

namespace tumble {
namespace {

constexpr std::size_t kUsualColumns = 80;
constexpr std::size_t kFewestColumns =
    40;  // below that, lines that the terminal breaks read better

// Bytes that continue a code point have no column of their own.
std::size_t columns_of(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;
  }));
}

std::string wrapped_line(const std::string& line, std::size_t columns, std::size_t indent) {
  if (columns_of(line) <= columns) return line;
  // Leading spaces belong to the first word.
  std::size_t end_of_margin = std::min(line.find_first_not_of(' '), line.size());
  std::string done, current = line.substr(0, end_of_margin);
  bool is_empty = true;
  while (end_of_margin < line.size()) {
    const std::size_t end = std::min(line.find(' ', end_of_margin), line.size());
    const std::string word = line.substr(end_of_margin, end - end_of_margin);
    const std::size_t begin = std::min(line.find_first_not_of(' ', end), line.size());
    if (!is_empty && columns_of(current) + columns_of(word) > columns) {
      done += current.substr(0, current.find_last_not_of(' ') + 1) + '\n';
      current.assign(indent, ' ');
    }
    current += word + line.substr(end, begin - end);
    is_empty = false;
    end_of_margin = begin;
  }
  return done + current;
}

}  // namespace

bool shows_colours(int descriptor) {
  const char* refused = std::getenv("NO_COLOR");
  const char* kind = std::getenv("TERM");
  const bool is_dumb = kind == nullptr || std::strcmp(kind, "dumb") == 0;
  return (refused == nullptr || *refused == '\0') && !is_dumb && ::isatty(descriptor) == 1;
}

std::size_t terminal_columns(int descriptor) {
  winsize size{};
  if (::ioctl(descriptor, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return kUsualColumns;
  return std::max<std::size_t>(size.ws_col, kFewestColumns);
}

std::string wrapped(const std::string& text, std::size_t columns, std::size_t indent) {
  std::string all;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    all += wrapped_line(text.substr(begin, end - begin), columns, indent);
    if (end < text.size()) all += '\n';
    begin = end + 1;
  }
  return all;
}

}  // namespace tumble
