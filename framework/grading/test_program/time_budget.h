/// The time limit of a whole submission, against many endless loops.
///
/// All times are own time (own_time.h). A test that timed out is charged its limit, and other tests
/// are charged in whole tenths of a second. So the same endless loops use up the budget after the
/// same test on an idle and on a loaded machine, and a solution that sleeps a little in each test
/// is charged for it.
#pragma once

#include <map>
#include <string>

#include "framework/grading/verdicts/verdict.h"

namespace tumble::grading {

struct TimeRules {
  double budget_s = 60.0;  // of all tests together: right submissions take a few seconds
  int full_timeouts = 2;   // per function; later calls of the same function have a shorter limit
  double suspect_own_s = 1.0;  // that shorter limit: right calls take microseconds
};

/// The time account of one submission.
class TimeBudget {
 public:
  explicit TimeBudget(const TimeRules& rules) : rules_(rules) {}

  /// Charges a test that has run.
  void charge(const TestResult& result);
  /// Whether no further test may run.
  bool is_used_up() const { return spent_s_ >= rules_.budget_s; }
  /// The result of a test that is not run because of the budget.
  TestResult not_run(const std::string& test) const;
  /// Functions with a shorter limit of their calls from now on [s].
  std::map<std::string, double> suspects() const;

 private:
  TimeRules rules_;
  double spent_s_ = 0.0;
  std::map<std::string, int> timeouts_;  // by function
};

}  // namespace tumble::grading
