#include "framework/grading/test_program/test_words.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>

#include "framework/core/error.h"
#include "framework/core/nearest_word.h"
#include "framework/core/text.h"

namespace tumble::grading {
namespace {

bool matches(const char* pattern, const char* text) {
  if (*pattern == '*')
    return matches(pattern + 1, text) || (*text != '\0' && matches(pattern, text + 1));
  if (*pattern == '\0') return *text == '\0';
  return *text != '\0' && (*pattern == '?' || *pattern == *text) && matches(pattern + 1, text + 1);
}

// Distance of a mistyped pattern, without its wildcards, from a test's suite or name, whichever is
// nearer.
std::size_t distance_of(const std::string& test, std::string pattern) {
  std::erase_if(pattern, [](char c) { return c == '*' || c == '?'; });
  while (pattern.ends_with('.')) pattern.pop_back();
  const std::size_t dot = test.find('.');
  const std::string wanted = lowercase(pattern);
  if (!wanted.empty() && lowercase(test).find(wanted) != std::string::npos) return 0;
  return std::min({edit_distance(lowercase(test), wanted),
                   edit_distance(lowercase(test.substr(0, dot)), wanted),
                   edit_distance(lowercase(test.substr(dot + 1)), wanted)});
}

}  // namespace

std::vector<std::string> chosen_tests(const std::vector<std::string>& tests,
                                      const std::string& filter) {
  std::vector<std::string> found;
  for (const std::string& test : tests)
    if (chosen(test, filter)) found.push_back(test);
  if (!found.empty()) return found;
  constexpr std::size_t kShown = 5;
  std::vector<std::string> nearest = tests;
  const std::string first = filter.substr(0, filter.find(':'));
  std::stable_sort(nearest.begin(), nearest.end(), [&](const auto& a, const auto& b) {
    return distance_of(a, first) < distance_of(b, first);
  });
  std::string shown;
  for (std::size_t i = 0; i < std::min(kShown, nearest.size()); ++i)
    shown += (i > 0 ? ", " : "") + nearest[i];
  throw UserError(filter, "no test has this name",
                  "Nearest: " + shown + ". A pattern may hold '*' and '?', such as '" +
                      tests.front().substr(0, tests.front().find('.')) + ".*'.");
}

std::string value_after(int argc, char** argv, int& i) {
  if (i + 1 >= argc) throw UserError(argv[i], "needs a value");
  return argv[++i];
}

double number_word(const std::string& flag, const std::string& word) {
  char* rest = nullptr;
  const double number = std::strtod(word.c_str(), &rest);
  if (word.empty() || *rest != '\0' || !(number > 0.0))
    throw UserError(flag + " " + word, "is not a number of seconds above 0");
  return number;
}

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
