#include "framework/grading/verdicts/what_changed.h"

#include <algorithm>
#include <array>
#include <map>

#include "framework/core/text.h"

namespace tumble::grading {
namespace {

constexpr std::size_t kNamedAtMost = 3;  // titles in a line; the table above it has all

std::string title_of(const std::string& test, const Rubric& rubric) {
  const RubricItem* item = rubric.find(test);
  return item == nullptr ? test : item->title;
}

std::string listed(const std::vector<std::string>& titles) {
  std::string text;
  for (std::size_t i = 0; i < std::min(titles.size(), kNamedAtMost); ++i)
    text += (i > 0 ? ", " : "") + titles[i];
  if (titles.size() > kNamedAtMost)
    text += " and " + std::to_string(titles.size() - kNamedAtMost) + " more";
  return text;
}

// The place of the test's level, then of the test in the rubric.
std::pair<std::size_t, std::size_t> place_of(const std::string& test, const Rubric& rubric) {
  constexpr std::array kLevels = {"basic", "intermediate", "advanced"};
  const RubricItem* item = rubric.find(test);
  if (item == nullptr) return {kLevels.size(), 0};
  const auto level = std::find(kLevels.begin(), kLevels.end(), item->level);
  return {static_cast<std::size_t>(level - kLevels.begin()),
          static_cast<std::size_t>(item - rubric.items.data())};
}

}  // namespace

std::string what_changed(const std::vector<TestResult>& before, const std::vector<TestResult>& now,
                         const Rubric& rubric) {
  std::map<std::string, Verdict> earlier;
  for (const TestResult& result : before)
    if (!is_cut_off(result)) earlier[result.test] = result.verdict;
  std::vector<std::string> gained, lost, other;
  std::size_t not_run = 0;
  for (const TestResult& result : now) {
    if (is_cut_off(result)) {  // it may be right: nothing has been seen of it
      ++not_run;
      continue;
    }
    const auto found = earlier.find(result.test);
    if (found == earlier.end() || found->second == result.verdict) continue;
    const std::string title = title_of(result.test, rubric);
    if (result.verdict == Verdict::kRight)
      gained.push_back(title);
    else if (found->second == Verdict::kRight)
      lost.push_back(title + " (" + words(result.verdict) + ")");
    else
      other.push_back(title + " (" + words(result.verdict) + ")");
  }
  std::string text;
  const auto add = [&](const char* head, const std::vector<std::string>& titles) {
    if (!titles.empty()) text += (text.empty() ? "" : "; ") + std::string(head) + listed(titles);
  };
  add("now right: ", gained);
  add("no longer right: ", lost);
  add("now: ", other);
  if (text.empty()) text = "no verdict has changed";
  return not_run == 0 ? text
                      : text + "; " + counted(not_run, "test") + " not run, for want of time";
}

std::string what_comes_next(const std::vector<TestResult>& results, const Rubric& rubric) {
  const TestResult* next = nullptr;
  const auto rank = [&](const TestResult& result) {
    const int kind = is_cut_off(result) ? 2 : result.verdict == Verdict::kNotAttempted ? 1 : 0;
    return std::pair{kind, place_of(result.test, rubric)};
  };
  for (const TestResult& result : results)
    if (result.verdict != Verdict::kRight && (next == nullptr || rank(result) < rank(*next)))
      next = &result;
  if (next == nullptr) return "";
  return title_of(next->test, rubric) + " [" + next->test + "]: " + words(next->verdict);
}

}  // namespace tumble::grading
