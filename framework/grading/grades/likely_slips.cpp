#include "framework/grading/grades/likely_slips.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <utility>

#include "framework/grading/grades/two_slips.h"

namespace tumble::grading {
namespace {

// Evidence is counted in tests. A number that only one slip gives is worth a test; one that many
// give says little. A passed test that the slip would fail weighs against it.
constexpr double kSharedNumber = 0.25;  // of a number that every slip gives
constexpr double kContradiction = 1.0;
constexpr double kOtherNumber = 0.1;     // against it: another mistake may be in the same test
constexpr double kLeastByNumbers = 0.4;  // evidence: below it the slip is not offered
// A function in which this part of the explained tests end, of those in the first one, is named.
constexpr std::size_t kLeastShare = 4;
constexpr double kLeastByTests = 2.0;  // tests, where no number agrees: one alone proves nothing
constexpr double kSameEvidence = 1e-9;
constexpr std::size_t kMostEquals = 2;
// Two slips explain more than one does, and of thousands of pairs some fit the round numbers of a
// test by chance. They are named where answers of both came in so many tests, where half of what
// they explain has the answer that came, and where their evidence is better by so many tests.
constexpr std::size_t kLeastByBoth = 2;
constexpr double kLeastPartOfTwo = 0.5;
constexpr double kBetterByBoth = 1.0;
// against two slips: only one of them shows in a test that both fail
constexpr double kOneOfTwo = 0.3;

// What a slip says about the open failures of one function, or of all together.
struct Evidence {
  std::vector<std::string> explained;
  std::size_t same_numbers = 0;
  double by_numbers = 0.0, by_tests = 0.0;
  // of two slips
  std::size_t by_both = 0, alone[2] = {0, 0};
};

class Matching {
 public:
  Matching(const std::vector<Failure>& failures, const std::map<std::string, std::string>& passed,
           const std::vector<AuditedSlip>& slips)
      : slips_(slips), passed_(passed) {
    for (const Failure& failure : failures) {
      open_[failure.test] = &failure;
      if (!failure.expected.empty() && !failure.found.empty())
        answers_[failure.test] = {answer_of(failure.expected), answer_of(failure.found)};
    }
    for (const AuditedSlip& slip : slips) {
      auto& answers = answers_of_slips_.emplace_back();
      for (const Failure& fails : slip.fails)
        if (answers_.contains(fails.test)) answers[fails.test] = {&fails, answer_of(fails.found)};
    }
  }

  std::vector<LikelySlip> run() {
    std::vector<LikelySlip> found;
    for (const bool by_numbers : {true, false})
      while (auto next = best(by_numbers)) {
        for (const std::string& test : next->tests) open_.erase(test);
        if (!join_its_pair(*next, found)) found.push_back(std::move(*next));
      }
    return found;
  }

 private:
  // How many slips answer a test in the same way: the more, the less it says.
  double worth(const Failure& of_slip) {
    const auto key = std::make_pair(of_slip.test, of_slip.found);
    if (const auto known = worth_.find(key); known != worth_.end()) return known->second;
    double alike = 0.0;
    for (const AuditedSlip& slip : slips_)
      for (const Failure& other : slip.fails)
        if (other.test == of_slip.test && other.verdict == of_slip.verdict &&
            is_same_answer(other.found, of_slip.found))
          alike += 1.0;
    return worth_[key] = kSharedNumber + (1.0 - kSharedNumber) / std::max(1.0, alike);
  }

  std::map<std::string, Evidence> by_function(const AuditedSlip& slip) {
    std::map<std::string, Evidence> parts;
    for (const Failure& fails : slip.fails) {
      if (const auto right = passed_.find(fails.test); right != passed_.end()) {
        parts[right->second].by_numbers -= kContradiction;
        parts[right->second].by_tests -= kContradiction;
      }
      const auto open = open_.find(fails.test);
      if (open == open_.end() || open->second->verdict != fails.verdict) continue;
      Evidence& part = parts[open->second->function];
      part.explained.push_back(fails.test);
      part.by_tests += 1.0;
      if (fails.found.empty()) continue;
      if (is_same_answer(open->second->found, fails.found)) {
        ++part.same_numbers;
        part.by_numbers += worth(fails);
      } else {
        part.by_numbers -= kOtherNumber;
      }
    }
    return parts;
  }

  // The functions in which the slip was made, by its evidence there.
  static LikelySlip made_in(const AuditedSlip& slip, const std::map<std::string, Evidence>& parts,
                            bool by_numbers, double& worth) {
    LikelySlip likely;
    likely.name = slip.name;
    std::vector<std::pair<std::size_t, std::string>> functions;
    for (const auto& [function, part] : parts) {
      const double of_part = by_numbers ? part.by_numbers : part.by_tests;
      if (of_part < (by_numbers ? kLeastByNumbers : kLeastByTests) || part.explained.empty())
        continue;
      worth += of_part;
      likely.same_numbers += part.same_numbers;
      likely.by_both += part.by_both;
      for (const int k : {0, 1}) likely.alone[k] += part.alone[k];
      likely.tests.insert(likely.tests.end(), part.explained.begin(), part.explained.end());
      if (!function.empty()) functions.emplace_back(part.explained.size(), function);
    }
    std::stable_sort(functions.begin(), functions.end(),
                     [](const auto& a, const auto& b) { return a.first > b.first; });
    const std::size_t most = functions.empty() ? 0 : functions.front().first;
    // that which the slip is inside: more tests may be told by a function that only uses it
    std::stable_partition(functions.begin(), functions.end(),
                          [&](const auto& part) { return part.second == slip.function; });
    for (const auto& [count, function] : functions)
      if (kLeastShare * count >= most || function == slip.function)
        likely.functions.push_back(function);
    return likely;
  }

  // A slip that was named with another one: what else it explains is of these two.
  static bool join_its_pair(const LikelySlip& slip, std::vector<LikelySlip>& found) {
    if (!slip.with.empty()) return false;
    for (LikelySlip& pair : found) {
      if (pair.with.empty() || (pair.name != slip.name && pair.with != slip.name)) continue;
      pair.tests.insert(pair.tests.end(), slip.tests.begin(), slip.tests.end());
      pair.same_numbers += slip.same_numbers;
      pair.alone[pair.name == slip.name ? 0 : 1] += slip.tests.size();
      for (const std::string& function : slip.functions)
        if (std::find(pair.functions.begin(), pair.functions.end(), function) ==
            pair.functions.end())
          pair.functions.push_back(function);
      return true;
    }
    return false;
  }

  struct AnswerOfSlip {
    const Failure* failure;
    Answer answer;
  };

  // What two slips together say about one open failure that either of them fails alone.
  void weigh_together(const Failure& open, const AnswerOfSlip* a, const AnswerOfSlip* b,
                      Together rule, Evidence& part) {
    part.explained.push_back(open.test);
    part.alone[0] += a != nullptr;
    part.alone[1] += b != nullptr;
    const auto& [right, found] = answers_.at(open.test);
    if (a != nullptr && b != nullptr &&
        is_answer_of_both(rule, right, a->answer, b->answer, found)) {
      ++part.same_numbers, ++part.by_both;
      part.by_numbers += 1.0;
      return;
    }
    const auto came = [&](const AnswerOfSlip* one) {
      return one != nullptr && is_same_answer(open.found, one->failure->found);
    };
    if (!came(a) && !came(b)) {
      part.by_numbers -= kOtherNumber;
    } else if (a != nullptr && b != nullptr && came(a) != came(b)) {
      part.by_numbers -= kOneOfTwo;  // the other one would have changed it
    } else {
      ++part.same_numbers;
      part.by_numbers += worth(*(came(a) ? a : b)->failure);
    }
  }

  std::map<std::string, Evidence> by_function(std::size_t a, std::size_t b, Together rule) {
    std::map<std::string, Evidence> parts;
    std::set<std::string> seen;
    for (const std::size_t slip : {a, b})
      for (const Failure& fails : slips_[slip].fails) {
        if (!seen.insert(fails.test).second) continue;
        if (const auto right = passed_.find(fails.test); right != passed_.end())
          parts[right->second].by_numbers -= kContradiction;
        const auto open = open_.find(fails.test);
        if (open == open_.end() || open->second->verdict != fails.verdict) continue;
        Evidence& part = parts[open->second->function];
        const auto of = [&](std::size_t k) {
          const auto it = answers_of_slips_[k].find(fails.test);
          return it == answers_of_slips_[k].end() ? nullptr : &it->second;
        };
        if (answers_.contains(fails.test))
          weigh_together(*open->second, of(a), of(b), rule, part);
        else
          part.explained.push_back(fails.test);
      }
    return parts;
  }

  // Tests that are open and that both slips fail with an answer.
  std::size_t common_tests(std::size_t a, std::size_t b) const {
    std::size_t count = 0;
    for (const auto& [test, answer] : answers_of_slips_[a])
      count += open_.contains(test) && answers_of_slips_[b].contains(test);
    return count;
  }

  // Of all pairs the one with the best evidence.
  std::optional<LikelySlip> best_pair(double& most) {
    std::optional<LikelySlip> best;
    for (std::size_t a = 0; a < slips_.size(); ++a)
      for (std::size_t b = a + 1; b < slips_.size(); ++b) {
        if (common_tests(a, b) < kLeastByBoth) continue;
        for (const Together rule : kAllTogether) {
          double worth = 0.0;
          LikelySlip pair = made_in(slips_[a], by_function(a, b, rule), true, worth);
          const double part = static_cast<double>(pair.same_numbers) /
                              static_cast<double>(std::max<std::size_t>(1, pair.tests.size()));
          if (pair.by_both < kLeastByBoth || part < kLeastPartOfTwo || worth < most - kSameEvidence)
            continue;
          pair.with = slips_[b].name;
          if (best && worth <= most + kSameEvidence) {
            const bool has_its_first = best->name == pair.name && best->tests == pair.tests;
            const bool is_new = best->with != pair.with &&
                                std::find(best->equals.begin(), best->equals.end(), pair.with) ==
                                    best->equals.end();
            if (has_its_first && is_new && best->equals.size() < kMostEquals)
              best->equals.push_back(pair.with);
            continue;
          }
          best = std::move(pair);
          most = worth;
        }
      }
    return best;
  }

  // The slip with the best evidence, or two slips whose evidence is clearly better.
  std::optional<LikelySlip> best(bool by_numbers) {
    double of_one = 0.0;
    auto one = best_slip(by_numbers, of_one);
    double of_two = of_one + kBetterByBoth;
    auto two = by_numbers && answers_.size() >= kLeastByBoth ? best_pair(of_two) : std::nullopt;
    return two ? two : one;
  }

  std::optional<LikelySlip> best_slip(bool by_numbers, double& most) {
    std::optional<LikelySlip> best;
    std::size_t fewest = 0;
    for (const AuditedSlip& slip : slips_) {
      double worth = 0.0;
      LikelySlip likely = made_in(slip, by_function(slip), by_numbers, worth);
      if (likely.tests.empty() || worth < most - kSameEvidence) continue;
      const bool is_as_good = best && worth <= most + kSameEvidence;
      // of two with the same evidence the one that fails fewer tests elsewhere
      if (is_as_good && slip.fails.size() >= fewest) {
        if (likely.tests == best->tests && best->equals.size() < kMostEquals)
          best->equals.push_back(slip.name);
        continue;
      }
      best = std::move(likely);
      most = worth;
      fewest = slip.fails.size();
    }
    return best;
  }

  const std::vector<AuditedSlip>& slips_;
  const std::map<std::string, std::string>& passed_;  // test -> function
  std::map<std::string, const Failure*> open_;
  std::map<std::pair<std::string, std::string>, double> worth_;
  // Of failures whose stories show numbers: the right answer and the one that came. Of each slip:
  // its answers in these tests.
  std::map<std::string, std::pair<Answer, Answer>> answers_;
  std::vector<std::map<std::string, AnswerOfSlip>> answers_of_slips_;
};

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(" \n"), last = text.find_last_not_of(" \n");
  return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

}  // namespace

std::vector<LikelySlip> likely_slips(const std::vector<Failure>& failures,
                                     const std::map<std::string, std::string>& passed,
                                     const std::vector<AuditedSlip>& slips) {
  return Matching(failures, passed, slips).run();
}

Failure failure_of(const TestResult& result) {
  Failure failure{result.test, result.verdict, "", result.last_call};
  constexpr std::string_view kMark = "found:", kRight = "expected:";
  constexpr std::size_t kLongestAnswer = 160;  // characters: more of a long list tells no more
  std::istringstream lines(result.story);
  for (std::string line; std::getline(lines, line);) {
    line = trimmed(line);
    if (line.empty()) continue;
    if (result.verdict != Verdict::kWrong) {  // "SIGSEGV", "no answer within 2 s"
      failure.found = line.substr(0, line.find_first_of(":,("));
      return failure;
    }
    if (line.starts_with(kRight))
      failure.expected = trimmed(line.substr(kRight.size())).substr(0, kLongestAnswer);
    if (line.starts_with(kMark)) {
      failure.found = trimmed(line.substr(kMark.size())).substr(0, kLongestAnswer);
      return failure;
    }
  }
  return failure;
}

bool is_same_answer(const std::string& a, const std::string& b) {
  const char *x = a.c_str(), *y = b.c_str();
  while (*x != '\0' && *y != '\0') {
    double u = 0.0, v = 0.0;
    const char *x_end = number_at(a.c_str(), x, u), *y_end = number_at(b.c_str(), y, v);
    if (x_end != nullptr && y_end != nullptr) {
      if (!is_same_number(u, v)) return false;
      x = x_end, y = y_end;
      continue;
    }
    if (*x++ != *y++) return false;
  }
  return *x == *y;
}

}  // namespace tumble::grading
