#include "framework/grading/test_program/time_budget.h"

#include <cmath>

#include <cstdio>

namespace tumble::grading {

void TimeBudget::charge(const TestResult& result) {
  if (!is_final_verdict(result.verdict)) return;  // it will be run again
  if (result.timed_out_s > 0.0) {
    spent_s_ += result.timed_out_s;
    if (!result.last_call.empty()) ++timeouts_[result.last_call];
  } else {
    constexpr double kTenths = 10.0;  // 1/s: right tests take a few hundredths of a second
    spent_s_ += std::floor(result.charged_s * kTenths) / kTenths;
  }
}

std::map<std::string, double> TimeBudget::suspects() const {
  std::map<std::string, double> limits;
  for (const auto& [function, count] : timeouts_)
    if (count >= rules_.full_timeouts) limits[function] = rules_.suspect_own_s;
  return limits;
}

TestResult TimeBudget::not_run(const std::string& test) const {
  TestResult result;
  result.test = test;
  result.verdict = Verdict::kOutOfResources;
  result.not_run = true;
  char budget[32];
  std::snprintf(budget, sizeof budget, "%g", rules_.budget_s);
  result.story = std::string("not run: the time budget of all tests together, ") + budget +
                 " s, was used up by the tests before it";
  std::string where;
  for (const auto& [function, count] : timeouts_)
    where += (where.empty() ? "" : ", ") + function + " (" + std::to_string(count) +
             (count == 1 ? " test)" : " tests)");
  if (!where.empty()) result.story += "; functions that ran out of time: " + where;
  return result;
}

}  // namespace tumble::grading
