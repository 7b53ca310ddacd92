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

std::string without_wildcards(std::string word) {
  std::erase_if(word, [](char c) { return c == '*' || c == '?'; });
  while (word.ends_with('.')) word.pop_back();
  return word;
}

// How far a word is from the nearest run of as many words of a title: "two wals" is near "Impulse
// of two walls".
std::size_t distance_in(const std::string& title, const std::string& wanted) {
  const auto count = 1 + std::count(wanted.begin(), wanted.end(), ' ');
  std::size_t nearest = edit_distance(title, wanted);
  for (std::size_t begin = 0; begin < title.size();) {
    std::size_t end = begin;
    for (long k = 0; k < count && end < title.size(); ++k)
      end = std::min(title.find(' ', end + (k > 0 ? 1 : 0)), title.size());
    nearest = std::min(nearest, edit_distance(title.substr(begin, end - begin), wanted));
    begin = std::min(title.find(' ', begin), title.size()) + 1;
  }
  return nearest;
}

struct Named {
  std::string test, title;  // the title may be empty
  // lower case; from a word without wildcards to the nearest of suite, name, both and title
  std::size_t distance(const std::string& wanted) const {
    const std::string name = lowercase(test);
    const std::size_t dot = name.find('.');
    std::size_t nearest =
        std::min({edit_distance(name, wanted), edit_distance(name.substr(0, dot), wanted),
                  edit_distance(name.substr(dot + 1), wanted)});
    return title.empty() ? nearest : std::min(nearest, distance_in(lowercase(title), wanted));
  }
  bool holds(const std::string& wanted) const {
    return lowercase(test).find(wanted) != std::string::npos ||
           lowercase(title).find(wanted) != std::string::npos;
  }
};

[[noreturn]] void refuse(const std::string& word, const std::vector<Named>& tests,
                         const std::vector<std::string>& functions) {
  constexpr std::size_t kShown = 3;
  const std::string wanted = lowercase(without_wildcards(word));
  std::vector<std::pair<std::size_t, std::string>> near;
  for (const Named& one : tests)
    near.emplace_back(one.distance(wanted),
                      one.title.empty() ? one.test : "'" + one.title + "' (" + one.test + ")");
  for (const std::string& function : functions)
    near.emplace_back(edit_distance(function, wanted), function);
  std::stable_sort(near.begin(), near.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  // what is much farther than the nearest, or shares little with the word, is no guess
  std::string shown;
  for (std::size_t i = 0; i < std::min(kShown, near.size()); ++i)
    if (near[i].first <= near.front().first + near.front().first / 4 &&
        2 * near[i].first <= wanted.size())
      shown += (i > 0 ? ", " : "") + near[i].second;
  throw UserError(word, "is no part of a test's title or name, and no function",
                  (shown.empty() ? "All titles: --all without a word" : "Nearest: " + shown) +
                      ". A pattern may hold '*' and '?', such as '" +
                      tests.front().test.substr(0, tests.front().test.find('.')) + ".*'.");
}

}  // namespace

TestChoice::TestChoice(const std::vector<std::string>& words, const std::vector<std::string>& tests,
                       const Rubric& rubric, const std::vector<std::string>& functions) {
  std::vector<Named> all;
  for (const std::string& test : tests) {
    const RubricItem* item = rubric.find(test);
    all.push_back({test, item != nullptr ? item->title : ""});
  }
  const auto choose = [&](const auto& is_chosen) {
    bool is_any = false;
    for (const Named& one : all)
      if (is_chosen(one)) tests_.insert(one.test), is_any = true;
    return is_any;
  };
  const auto choose_part = [&](const std::string& part) {
    const std::string wanted = lowercase(part);
    return choose([&](const Named& one) { return one.holds(wanted); });
  };
  std::string together;
  for (const std::string& word : words) together += (together.empty() ? "" : " ") + word;
  if (words.empty() || (words.size() > 1 && choose_part(together))) {
    if (words.empty()) tests_.insert(tests.begin(), tests.end());
  } else {
    for (const std::string& word : words) {
      if (word.empty()) throw UserError("''", "chooses no test", "Leave it out.");
      if (choose([&](const Named& one) { return chosen(one.test, word); })) continue;
      if (std::find(functions.begin(), functions.end(), word) != functions.end())
        functions_.insert(word);
      else if (!choose_part(word))
        refuse(word, all, functions);
    }
  }
  for (const std::string& test : tests)
    if (!functions_.empty() || tests_.contains(test)) to_run_.push_back(test);
}

bool TestChoice::has(const TestResult& result) const {
  return tests_.contains(result.test) || functions_.contains(result.last_call) ||
         (!functions_.empty() && is_cut_off(result));
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
