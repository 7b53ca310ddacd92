#include "framework/grading/grades/own_test_names.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

namespace tumble::grading {
namespace {

constexpr std::array<std::string_view, 5> kMacros = {"TEST", "TEST_F", "TEST_P", "TYPED_TEST",
                                                     "TYPED_TEST_P"};

bool is_of_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

void skip_blanks(const std::string& text, std::size_t& at) {
  while (at < text.size() && std::isspace(static_cast<unsigned char>(text[at])) != 0) ++at;
}

// The identifier behind blanks; empty: there is none.
std::string take_word(const std::string& text, std::size_t& at) {
  skip_blanks(text, at);
  const std::size_t first = at;
  while (at < text.size() && is_of_word(text[at])) ++at;
  return text.substr(first, at - first);
}

bool take(const std::string& text, std::size_t& at, char wanted) {
  skip_blanks(text, at);
  if (at >= text.size() || text[at] != wanted) return false;
  ++at;
  return true;
}

}  // namespace

std::vector<std::string> names_of_tests(const std::string& text) {
  std::vector<std::string> names;
  for (std::size_t at = 0; at < text.size();) {
    if (!is_of_word(text[at])) {
      ++at;
      continue;
    }
    const std::string word = take_word(text, at);
    if (std::find(kMacros.begin(), kMacros.end(), word) == kMacros.end()) continue;
    std::size_t inside = at;
    if (!take(text, inside, '(')) continue;
    const std::string suite = take_word(text, inside);
    if (suite.empty() || !take(text, inside, ',')) continue;
    const std::string name = take_word(text, inside);
    if (!name.empty() && take(text, inside, ')')) names.push_back(suite + '.' + name);
  }
  return names;
}

std::string name_in_file(const std::string& reported, const std::vector<std::string>& in_file) {
  const std::size_t dot = reported.find('.');
  if (dot == std::string::npos) return kUnnamedTest;
  const std::string name = reported.substr(dot + 1, reported.find('/', dot) - dot - 1);
  // "Instance/Suite" of TEST_P, "Suite/0" of TYPED_TEST
  for (std::size_t first = 0; first <= dot;) {
    const std::size_t end = std::min(reported.find('/', first), dot);
    const std::string whole = reported.substr(first, end - first) + '.' + name;
    if (std::find(in_file.begin(), in_file.end(), whole) != in_file.end()) return whole;
    first = end + 1;
  }
  return kUnnamedTest;
}

}  // namespace tumble::grading
