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

// What a story calls likely, without what is right; empty: nothing.
std::string likely_in(const std::string& story) {
  constexpr std::string_view kMark = "\n  likely:   ";
  const std::size_t at = story.find(kMark);
  if (at == story.npos) return "";
  const std::size_t begin = at + kMark.size();
  return parts_of_mistake(story.substr(begin, story.find('\n', begin) - begin)).mistake;
}

// What is called likely under each heading: first what most tests name.
std::map<std::string, std::vector<std::string>> likely_under(
    const std::vector<TestResult>& results, const std::vector<std::string>& headings) {
  std::map<std::string, std::vector<std::pair<std::string, int>>> counts;
  for (std::size_t i = 0; i < results.size(); ++i) {
    const std::string words = likely_in(results[i].story);
    if (words.empty()) continue;
    auto& all = counts[headings[i]];
    auto one =
        std::find_if(all.begin(), all.end(), [&](const auto& x) { return x.first == words; });
    if (one == all.end()) one = all.insert(all.end(), {words, 0});
    ++one->second;
  }
  std::map<std::string, std::vector<std::string>> likely;
  for (auto& [heading, all] : counts) {
    std::stable_sort(all.begin(), all.end(),
                     [](const auto& a, const auto& b) { return a.second > b.second; });
    for (const auto& [words, tests] : all) likely[heading].push_back(words);
  }
  return likely;
}

std::vector<std::string> with_likely(const std::vector<TestResult>& results,
                                     std::vector<std::string> headings) {
  constexpr std::size_t kNamed = 2;
  const auto likely = likely_under(results, headings);
  for (std::string& heading : headings) {
    const auto all = likely.find(heading);
    if (all == likely.end()) continue;
    heading += "; likely: " + all->second.front();
    for (std::size_t k = 1; k < std::min(kNamed, all->second.size()); ++k)
      heading += "; or: " + all->second[k];
  }
  return headings;
}

// How much a test says of the mistake: 0 names it, 2 fails for any mistake of the function.
int rank_of(const TestResult& result) {
  if (!likely_in(result.story).empty()) return 0;
  return result.test.ends_with(".KeepsNothingBetweenCalls") ? 2 : 1;
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

MistakeParts parts_of_mistake(const std::string& words) {
  constexpr std::string_view kBetween = ": ";
  const std::size_t at = words.find(kBetween);
  if (at == words.npos) return {words, ""};
  return {words.substr(0, at), words.substr(at + kBetween.size())};
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

std::vector<HeadingGroup> in_order_of_mending(const std::vector<TestResult>& results,
                                              const std::vector<std::string>& headings,
                                              const std::vector<double>& points) {
  struct Weighed {
    HeadingGroup group;
    std::string likely;
    bool is_first = false;   // kept tests from running
    double of_slip = 0.0;    // points under all headings with this slip
    std::size_t family = 0;  // of headings with one slip: they stay together
  };
  const bool used_up = !what_used_the_time(results).empty();
  const auto likely = likely_under(results, headings);
  std::vector<Weighed> all;
  for (std::size_t i = 0; i < results.size(); ++i) {
    if (headings[i].empty()) continue;
    auto one = std::find_if(all.begin(), all.end(),
                            [&](const Weighed& x) { return x.group.heading == headings[i]; });
    if (one == all.end()) {
      one = all.insert(all.end(), Weighed{});
      one->group.heading = headings[i];
      one->group.is_attempted = results[i].verdict != Verdict::kNotAttempted;
      if (const auto named = likely.find(headings[i]); named != likely.end())
        one->likely = named->second.front();
    }
    one->group.tests.push_back(i);
    one->group.points += points[i];
    one->is_first = one->is_first || (used_up && is_cut_off(results[i]));
  }
  for (std::size_t k = 0; k < all.size(); ++k) {
    Weighed& one = all[k];
    one.family = k;
    one.of_slip = one.group.points;
    for (std::size_t m = 0; m < all.size() && !one.likely.empty(); ++m) {
      if (m == k || all[m].likely != one.likely) continue;
      one.of_slip += all[m].group.points;
      one.family = std::min(one.family, m);
    }
    std::stable_sort(
        one.group.tests.begin(), one.group.tests.end(),
        [&](std::size_t a, std::size_t b) { return rank_of(results[a]) < rank_of(results[b]); });
  }
  std::stable_sort(all.begin(), all.end(), [](const Weighed& a, const Weighed& b) {
    if (a.group.is_attempted != b.group.is_attempted) return a.group.is_attempted;
    if (a.is_first != b.is_first) return a.is_first;
    if (a.of_slip != b.of_slip) return a.of_slip > b.of_slip;
    if (a.likely.empty() != b.likely.empty()) return b.likely.empty();
    if (a.family != b.family) return a.family < b.family;
    return a.group.points > b.group.points;
  });
  std::vector<HeadingGroup> groups;
  for (Weighed& one : all) groups.push_back(std::move(one.group));
  return groups;
}

}  // namespace tumble::grading
