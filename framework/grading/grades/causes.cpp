#include "framework/grading/grades/causes.h"

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <map>
#include <set>
#include <sstream>

#include <fmt/format.h>

#include "framework/core/code_text.h"
#include "framework/grading/verdicts/mend_order.h"

namespace tumble::grading {
namespace {

bool is_failure(Verdict verdict) {
  return verdict == Verdict::kWrong || verdict == Verdict::kCrashed ||
         verdict == Verdict::kOutOfResources;
}

const ScoredTest* test_called(const std::vector<ScoredTest>& tests, const std::string& name) {
  const auto it = std::find_if(tests.begin(), tests.end(),
                               [&](const ScoredTest& test) { return test.item.test == name; });
  return it == tests.end() ? nullptr : &*it;
}

const AuditedSlip* slip_called(const std::vector<AuditedSlip>& known, const std::string& name) {
  const auto it = std::find_if(known.begin(), known.end(),
                               [&](const AuditedSlip& slip) { return slip.name == name; });
  return it == known.end() ? nullptr : &*it;
}

Cause cause_of(const LikelySlip& likely, const std::vector<AuditedSlip>& known) {
  Cause cause;
  cause.kind = Cause::Kind::kSlip;
  const AuditedSlip& slip = *slip_called(known, likely.name);
  cause.says = slip.says;
  if (!likely.with.empty()) {
    cause.and_also = slip_called(known, likely.with)->says;
    cause.by_both = likely.by_both;
    std::copy(std::begin(likely.alone), std::end(likely.alone), cause.alone);
  }
  for (const std::string& other : likely.equals) {
    const AuditedSlip* equal = slip_called(known, other);
    if (equal->says != slip.says && equal->says != cause.and_also)
      cause.or_else.push_back(equal->says);
  }
  cause.tests = likely.tests;
  cause.same_numbers = likely.same_numbers;
  cause.functions = likely.functions;
  return cause;
}

// What a function did in all tests of a group, where no slip explains it.
Cause cause_without_slip(Verdict verdict, const std::string& function) {
  Cause cause;
  const std::string name = function.empty() ? "The submission" : function;
  if (!function.empty()) cause.functions = {function};
  switch (verdict) {
    case Verdict::kCrashed:
      cause.kind = Cause::Kind::kCrash;
      cause.says = name + " crashes";
      break;
    case Verdict::kOutOfResources:
      cause.kind = Cause::Kind::kOutOfResources;
      cause.says = name + " takes too much time or memory";
      break;
    case Verdict::kNotAttempted:
      cause.kind = Cause::Kind::kNotWritten;
      cause.says = name + " is not written yet";
      break;
    default:
      cause.kind = Cause::Kind::kUnknown;
      cause.says = name + " gives wrong answers, and no known mistake explains them";
  }
  return cause;
}

std::vector<TestResult> results_of(const std::vector<ScoredTest>& tests) {
  std::vector<TestResult> results;
  for (const ScoredTest& test : tests) results.push_back(test.result);
  return results;
}

// The rest: one cause a function and verdict, in the order of the tests. A test that was not run
// belongs to the function that used up the time. A wrong answer that no slip explains belongs to
// the cause of the function that it probably follows from.
void add_rest(const std::vector<ScoredTest>& tests, const std::string& source,
              std::vector<Cause>& causes) {
  std::set<std::string> explained;
  std::map<std::string, std::size_t> cause_of_function;  // the first; slips before all others
  for (std::size_t i = 0; i < causes.size(); ++i) {
    explained.insert(causes[i].tests.begin(), causes[i].tests.end());
    for (const std::string& function : causes[i].functions) cause_of_function.emplace(function, i);
  }
  const std::vector<TestResult> results = results_of(tests);
  const std::string used_up = what_used_the_time(results);
  const auto follows = what_follows(results, source);
  std::map<std::pair<Verdict, std::string>, std::size_t> place;
  const auto without_slip = [&](Verdict verdict, const std::string& function) -> Cause& {
    const auto [it, is_new] = place.emplace(std::make_pair(verdict, function), causes.size());
    if (is_new) causes.push_back(cause_without_slip(verdict, function));
    if (is_new && !function.empty()) cause_of_function.emplace(function, it->second);
    return causes[it->second];
  };
  std::vector<const ScoredTest*> followers;
  for (const ScoredTest& test : tests) {
    const TestResult& result = test.result;
    if (explained.contains(test.item.test)) continue;
    if (is_cut_off(result)) {
      const auto its = cause_of_function.find(used_up);
      (its != cause_of_function.end() ? causes[its->second] : without_slip(result.verdict, used_up))
          .not_run.push_back(test.item.test);
    } else if (result.verdict == Verdict::kWrong && follows.contains(result.last_call)) {
      followers.push_back(&test);
    } else if (is_failure(result.verdict) || result.verdict == Verdict::kNotAttempted) {
      without_slip(result.verdict, result.last_call).tests.push_back(test.item.test);
    }
  }
  for (const ScoredTest* test : followers) {
    const auto root = cause_of_function.find(follows.at(test->result.last_call));
    if (root != cause_of_function.end())
      causes[root->second].following.push_back(test->item.test);
    else  // a slip explains that function's tests, and names another
      without_slip(test->result.verdict, test->result.last_call).tests.push_back(test->item.test);
  }
}

constexpr int kMostLines = 40;  // of a function that is shown
constexpr std::size_t kMostColumns = 160;
constexpr int kLinesBeside = 3;  // before and after the line of a crash

// "   12  text"; the marked line has an arrow.
std::string numbered_lines(const std::string& source, int first, int last, int marked) {
  std::istringstream in(source);
  std::string text, line;
  for (int number = 1; std::getline(in, line) && number <= last; ++number)
    if (number >= first) {
      if (line.ends_with('\r')) line.pop_back();  // of a file from Windows
      text += fmt::format("{}{:>4}  {}{}\n", number == marked ? "->" : "  ", number,
                          line.substr(0, kMostColumns), line.size() > kMostColumns ? "..." : "");
    }
  return text;
}

// "a1_impulse.cpp:26" of a crash in the function, as its story says; empty: none does.
std::string place_of_crash(const Cause& cause, const std::string& function,
                           const std::vector<ScoredTest>& tests) {
  if (cause.kind != Cause::Kind::kCrash) return "";
  const std::string words = ", in " + function + ", ";
  for (const std::string& name : cause.tests) {
    const ScoredTest* test = test_called(tests, name);
    const std::string story = test == nullptr ? "" : test->result.story;
    if (const std::size_t at = story.find(words); at != story.npos) {
      const std::size_t begin = at + words.size();
      return story.substr(begin, story.find_first_of(" \n", begin) - begin);
    }
  }
  return "";
}

// A known slip, or two, that a cause was recognised by; none where no number agreed.
std::vector<const AuditedSlip*> slips_of(const Cause& cause,
                                         const std::vector<AuditedSlip>& known) {
  std::vector<const AuditedSlip*> slips;
  if (cause.kind != Cause::Kind::kSlip || cause.same_numbers == 0) return slips;
  for (const AuditedSlip& slip : known)
    if (slip.says == cause.says || (!cause.and_also.empty() && slip.says == cause.and_also))
      slips.push_back(&slip);
  return slips;
}

// Whether a slip fails this test, in one of the functions that the cause names.
bool fails_also(const AuditedSlip& slip, const Cause& cause, const std::string& test) {
  return std::any_of(slip.fails.begin(), slip.fails.end(), [&](const Failure& failure) {
    return failure.test == test && std::find(cause.functions.begin(), cause.functions.end(),
                                             failure.function) != cause.functions.end();
  });
}

void add_also_needed(std::vector<Cause>& causes, const std::vector<AuditedSlip>& known) {
  for (std::size_t other = 0; other < causes.size(); ++other)
    for (const auto slips = slips_of(causes[other], known); Cause & cause : causes) {
      if (&cause == &causes[other]) continue;
      const auto n =
          std::count_if(cause.tests.begin(), cause.tests.end(), [&](const std::string& test) {
            return std::any_of(slips.begin(), slips.end(), [&](const AuditedSlip* slip) {
              return fails_also(*slip, causes[other], test);
            });
          });
      if (n > 0) cause.also_needed.emplace_back(other, static_cast<std::size_t>(n));
    }
}

// Whether a slip gives the answer that came in this test.
bool gives_answer(const AuditedSlip& slip, const Failure& came) {
  return std::any_of(slip.fails.begin(), slip.fails.end(), [&](const Failure& fails) {
    return fails.test == came.test && fails.verdict == came.verdict && !fails.found.empty() &&
           is_same_answer(fails.found, came.found);
  });
}

// A mistake in one function shows in others that use it. One answer alone, which many mistakes
// give, is too little to explain a test by it; beside other evidence of the same mistake it counts.
void add_may_follow(std::vector<Cause>& causes, const std::vector<AuditedSlip>& known,
                    const std::vector<Failure>& failures) {
  for (std::size_t other = 0; other < causes.size(); ++other)
    for (const auto slips = slips_of(causes[other], known); Cause & cause : causes) {
      if (&cause == &causes[other] || !cause.has_no_known_answer()) continue;
      const auto n = std::count_if(failures.begin(), failures.end(), [&](const Failure& came) {
        return std::find(cause.tests.begin(), cause.tests.end(), came.test) != cause.tests.end() &&
               std::any_of(slips.begin(), slips.end(),
                           [&](const AuditedSlip* slip) { return gives_answer(*slip, came); });
      });
      if (n > 0) cause.may_follow.emplace_back(other, static_cast<std::size_t>(n));
    }
}

}  // namespace

std::string lines_of_function(const std::string& source, int line) {
  const std::string code = code_of(source);
  std::size_t at = 0;
  for (int i = 1; i < line && at != std::string::npos; ++i) at = code.find('\n', at) + 1;
  at = code.find('{', at);
  int depth = 0, last = line;
  for (; at < code.size(); ++at) {
    if (code[at] == '{') ++depth;
    if (code[at] == '}' && --depth == 0) break;
  }
  if (at < code.size())
    last =
        1 + static_cast<int>(std::count(code.begin(), code.begin() + static_cast<long>(at), '\n'));
  return numbered_lines(source, line, std::min(last, line + kMostLines - 1), 0) +
         (last >= line + kMostLines ? "       ...\n" : "");
}

std::string lines_around(const std::string& source, int line) {
  return numbered_lines(source, line - kLinesBeside, line + kLinesBeside, line);
}

double points_lost(const Cause& cause, const std::vector<ScoredTest>& tests) {
  double lost = 0.0;
  for (const auto& names : {cause.tests, cause.following, cause.not_run})
    for (const std::string& name : names)
      if (const ScoredTest* test = test_called(tests, name))
        lost += test->item.points - test->score;
  return lost;
}

std::vector<Cause> causes_of(const std::vector<ScoredTest>& tests,
                             const std::vector<AuditedSlip>& known, const std::string& file,
                             const std::string& source) {
  std::vector<Failure> failures;
  std::map<std::string, std::string> passed;
  for (const ScoredTest& test : tests) {
    if (is_failure(test.result.verdict) && !is_cut_off(test.result))
      failures.push_back(failure_of(test.result));
    if (test.result.verdict == Verdict::kRight) passed[test.item.test] = test.result.last_call;
  }
  std::vector<Cause> causes;
  for (const LikelySlip& likely : likely_slips(failures, passed, known))
    causes.push_back(cause_of(likely, known));
  add_rest(tests, source, causes);
  for (Cause& cause : causes)
    for (const std::string& function : cause.functions) {
      const int line = line_of_definition(source, function);
      const std::string crash = place_of_crash(cause, function, tests);
      cause.places.push_back(!crash.empty() ? crash
                             : line > 0     ? fmt::format("{}:{}", file, line)
                                            : "");
      const int crashed =
          crash.starts_with(file + ":") ? std::atoi(crash.c_str() + file.size() + 1) : 0;
      cause.code.push_back(cause.kind == Cause::Kind::kNotWritten ? ""
                           : crashed > 0                          ? lines_around(source, crashed)
                           : line > 0                             ? lines_of_function(source, line)
                                                                  : "");
    }
  std::stable_sort(causes.begin(), causes.end(), [&](const Cause& a, const Cause& b) {
    if (a.not_run.empty() != b.not_run.empty()) return b.not_run.empty();
    return points_lost(a, tests) > points_lost(b, tests);
  });
  add_also_needed(causes, known);
  add_may_follow(causes, known, failures);
  return causes;
}

}  // namespace tumble::grading
