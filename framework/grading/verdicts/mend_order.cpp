#include "framework/grading/verdicts/mend_order.h"

#include <algorithm>
#include <set>
#include <string_view>
#include <utility>

#include "framework/grading/verdicts/own_functions.h"

namespace tumble::grading {
namespace {

constexpr std::size_t kLeastShare = 4;  // a quarter of its own tests: fewer are a case of its own

bool fails(const TestResult& result) {
  return !result.not_run &&
         (result.verdict == Verdict::kWrong || result.verdict == Verdict::kCrashed ||
          result.verdict == Verdict::kOutOfResources);
}

struct Count {
  std::size_t failing = 0, all = 0;
  bool is_seen_in_its_own_tests() const { return failing > 0 && kLeastShare * failing >= all; }
};

std::map<std::string, Count> counts_by_function(const std::vector<TestResult>& results) {
  std::map<std::string, Count> counts;
  for (const TestResult& result : results) {
    if (result.last_call.empty() || result.not_run) continue;
    Count& count = counts[result.last_call];
    ++count.all;
    if (fails(result)) ++count.failing;
  }
  return counts;
}

// What a story calls likely; empty: nothing.
std::string likely_in(const std::string& story) {
  constexpr std::string_view kMark = "\n  likely:   ";
  const std::size_t at = story.find(kMark);
  if (at == story.npos) return "";
  const std::size_t begin = at + kMark.size();
  return story.substr(begin, story.find('\n', begin) - begin);
}

// Where all that is called likely under a heading is the same, the heading says it.
std::vector<std::string> with_likely(const std::vector<TestResult>& results,
                                     std::vector<std::string> headings) {
  std::map<std::string, std::set<std::string>> likely;
  for (std::size_t i = 0; i < results.size(); ++i)
    if (const std::string words = likely_in(results[i].story); !words.empty())
      likely[headings[i]].insert(words);
  for (std::string& heading : headings)
    if (const auto all = likely.find(heading); all != likely.end() && all->second.size() == 1)
      heading += "; likely: " + *all->second.begin();
  return headings;
}

}  // namespace

std::map<std::string, std::string> what_follows(const std::vector<TestResult>& results,
                                                const std::string& source) {
  const auto counts = counts_by_function(results);
  std::set<std::string> functions;
  for (const auto& [function, count] : counts) functions.insert(function);
  const auto asked = functions_asked(source, functions);
  // By failing function: those that it asks, that fail, and that do not ask it.
  std::map<std::string, std::set<std::string>> below;
  for (const auto& [function, count] : counts) {
    const auto its = asked.find(function);
    if (count.failing == 0 || its == asked.end()) continue;
    for (const std::string& other : its->second) {
      const auto fails_too = counts.find(other);
      if (fails_too == counts.end() || !fails_too->second.is_seen_in_its_own_tests()) continue;
      if (!asked.at(other).contains(function)) below[function].insert(other);
    }
  }
  std::map<std::string, std::string> follows;
  for (const auto& [function, others] : below) {
    std::string first;
    for (const std::string& other : others)
      if (!below.contains(other) &&
          (first.empty() || counts.at(other).failing > counts.at(first).failing))
        first = other;
    if (!first.empty()) follows[function] = first;
  }
  return follows;
}

std::string exact_place_of(const TestResult& result) {
  const std::string words = ", in " + result.last_call + ", ";
  const std::size_t at = result.story.find(words);
  if (at == result.story.npos || at > result.story.find('\n')) return "";
  const std::size_t begin = at + words.size();
  const std::string place =
      result.story.substr(begin, result.story.find_first_of(" \n", begin) - begin);
  return place.find(':') != place.npos ? place : "";
}

std::string what_used_the_time(const std::vector<TestResult>& results) {
  std::map<std::string, std::pair<double, int>> used;  // seconds of limits exceeded; tests
  bool is_used_up = false;
  for (const TestResult& result : results) {
    is_used_up = is_used_up || is_cut_off(result);
    if (result.not_run || result.verdict != Verdict::kOutOfResources || result.last_call.empty())
      continue;
    auto& [seconds, tests] = used[result.last_call];
    seconds += result.timed_out_s;
    ++tests;
  }
  if (!is_used_up || used.empty()) return "";
  return std::max_element(used.begin(), used.end(),
                          [](const auto& a, const auto& b) { return a.second < b.second; })
      ->first;
}

std::vector<std::string> headings_of(const std::vector<TestResult>& results,
                                     const std::string& source) {
  const auto follows = what_follows(results, source);
  const std::string used_up = what_used_the_time(results);
  std::set<std::string> first;  // functions that others follow from
  for (const auto& [function, other] : follows) first.insert(other);
  const auto heading_of = [&](const TestResult& result) -> std::string {
    const auto other = follows.find(result.last_call);
    const std::string& function = other != follows.end() ? other->second : result.last_call;
    const std::string verdict = words(result.verdict);
    if (result.verdict == Verdict::kNotAttempted)
      return verdict + (function.empty() ? "" : ": " + function);
    if (result.not_run ? !used_up.empty() : fails(result) && function == used_up)
      return "out of time or memory in " + with_its_line(source, used_up) + ": mend this first";
    if (result.not_run) return "not run: the tests before used up the time of all together";
    if (!fails(result)) return "";
    if (function.empty()) return verdict;
    if (first.contains(function))
      return with_its_line(source, function) +
             ": mend this first; other functions ask it, and probably fail for it";
    const std::string place = exact_place_of(result);
    return verdict + " in " +
           (place.empty() ? with_its_line(source, function) : function + ", " + place);
  };
  std::vector<std::string> headings;
  for (const TestResult& result : results) headings.push_back(heading_of(result));
  return with_likely(results, std::move(headings));
}

}  // namespace tumble::grading
