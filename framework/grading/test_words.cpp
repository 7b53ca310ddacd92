#include "framework/grading/test_words.h"

#include <algorithm>

namespace tumble::grading {
namespace {

bool matches(const char* pattern, const char* text) {
  if (*pattern == '*') return matches(pattern + 1, text) || (*text != '\0' && matches(pattern, text + 1));
  if (*pattern == '\0') return *text == '\0';
  return *text != '\0' && (*pattern == '?' || *pattern == *text) && matches(pattern + 1, text + 1);
}

}  // namespace

bool chosen(const std::string& test, const std::string& filter) {
  if (filter.empty()) return true;
  for (std::size_t from = 0; from <= filter.size();) {
    const std::size_t to = std::min(filter.find(':', from), filter.size());
    if (matches(filter.substr(from, to - from).c_str(), test.c_str())) return true;
    from = to + 1;
  }
  return false;
}

}  // namespace tumble::grading
