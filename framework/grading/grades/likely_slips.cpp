#include "framework/grading/grades/likely_slips.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <map>
#include <optional>
#include <sstream>
#include <utility>

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

// What a slip says about the open failures of one function, or of all together.
struct Evidence {
  std::vector<std::string> explained;
  std::size_t same_numbers = 0;
  double by_numbers = 0.0, by_tests = 0.0;
};

class Matching {
 public:
  Matching(const std::vector<Failure>& failures, const std::map<std::string, std::string>& passed,
           const std::vector<AuditedSlip>& slips)
      : slips_(slips), passed_(passed) {
    for (const Failure& failure : failures) open_[failure.test] = &failure;
  }

  std::vector<LikelySlip> run() {
    std::vector<LikelySlip> found;
    for (const bool by_numbers : {true, false})
      while (auto next = best(by_numbers)) found.push_back(std::move(*next));
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
      likely.tests.insert(likely.tests.end(), part.explained.begin(), part.explained.end());
      if (!function.empty()) functions.emplace_back(part.explained.size(), function);
    }
    std::stable_sort(functions.begin(), functions.end(),
                     [](const auto& a, const auto& b) { return a.first > b.first; });
    for (const auto& [count, function] : functions)
      if (kLeastShare * count >= functions.front().first) likely.functions.push_back(function);
    return likely;
  }

  std::optional<LikelySlip> best(bool by_numbers) {
    std::optional<LikelySlip> best;
    double most = 0.0;
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
    if (best)
      for (const std::string& test : best->tests) open_.erase(test);
    return best;
  }

  const std::vector<AuditedSlip>& slips_;
  const std::map<std::string, std::string>& passed_;  // test -> function
  std::map<std::string, const Failure*> open_;
  std::map<std::pair<std::string, std::string>, double> worth_;
};

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(" \n"), last = text.find_last_not_of(" \n");
  return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

bool is_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

}  // namespace

std::vector<LikelySlip> likely_slips(const std::vector<Failure>& failures,
                                     const std::map<std::string, std::string>& passed,
                                     const std::vector<AuditedSlip>& slips) {
  return Matching(failures, passed, slips).run();
}

Failure failure_of(const TestResult& result) {
  Failure failure{result.test, result.verdict, "", result.last_call};
  constexpr std::string_view kMark = "found:";
  constexpr std::size_t kLongestAnswer = 160;  // characters: more of a long list tells no more
  std::istringstream lines(result.story);
  for (std::string line; std::getline(lines, line);) {
    line = trimmed(line);
    if (line.empty()) continue;
    if (result.verdict != Verdict::kWrong) {  // "SIGSEGV", "no answer within 2 s"
      failure.found = line.substr(0, line.find_first_of(":,("));
      return failure;
    }
    if (line.starts_with(kMark)) {
      failure.found = trimmed(line.substr(kMark.size())).substr(0, kLongestAnswer);
      return failure;
    }
  }
  return failure;
}

bool is_same_answer(const std::string& a, const std::string& b) {
  constexpr double kSame = 1e-6;  // relative: stories show 12 digits, and round-off differs
  const char *x = a.c_str(), *y = b.c_str();
  while (*x != '\0' && *y != '\0') {
    char *x_end = nullptr, *y_end = nullptr;
    const bool begins = (x == a.c_str() || !is_word(x[-1])) && (y == b.c_str() || !is_word(y[-1]));
    const double u = std::strtod(x, &x_end), v = std::strtod(y, &y_end);
    if (begins && x_end != x && y_end != y) {
      const bool both_nan = std::isnan(u) && std::isnan(v);
      if (!both_nan && u != v && !(std::abs(u - v) <= kSame * std::max(std::abs(u), std::abs(v))))
        return false;
      x = x_end, y = y_end;
      continue;
    }
    if (*x++ != *y++) return false;
  }
  return *x == *y;
}

}  // namespace tumble::grading
