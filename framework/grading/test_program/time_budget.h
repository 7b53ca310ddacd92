/// How long a whole submission may take: loops without end must not cost a night.
///
/// All times are own time (own_time.h). What a test that timed out is charged is its limit, and what an answered one is charged counts in
/// whole tenths of a second only: the same endless loops use up the same budget after the same test, on an idle machine and on a
/// loaded one, and a solution that sleeps a little in each test pays for it.
#pragma once

#include <map>
#include <string>

#include "framework/grading/verdicts/verdict.h"

namespace tumble::grading {

struct TimeRules {
  double budget_s = 60.0;     // of all tests together: right submissions take a few
  int full_timeouts = 2;      // in one function; a third loop of the same function is known sooner
  double suspect_own_s = 1.0;   // of a call to a function that has had them: right calls take microseconds
};

/// The account of one submission.
class TimeBudget {
 public:
  explicit TimeBudget(const TimeRules& rules) : rules_(rules) {}

  /// Charges a test that has run.
  void charge(const TestResult& result);
  /// No further test is run.
  bool is_used_up() const { return spent_s_ >= rules_.budget_s; }
  /// The verdict on a test that is not run any more.
  TestResult not_run(const std::string& test) const;
  /// Functions whose calls end sooner from now on, with their limit [s].
  std::map<std::string, double> suspects() const;

 private:
  TimeRules rules_;
  double spent_s_ = 0.0;
  std::map<std::string, int> timeouts_;   // by function
};

}  // namespace tumble::grading
