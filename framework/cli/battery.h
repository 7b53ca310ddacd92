/// The stability battery: types that the verb, the test and the cases share.
///
/// A case builds its scenes, runs them by the given laws, and measures. Its reference values come
/// from closed forms or files, never from this project's own results.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "framework/dynamics/laws.h"
#include "framework/truths/truth_case.h"
#include "framework/modules/registry.h"
#include "framework/report/battery_row.h"

namespace tumble::battery {

/// Input of a case.
struct Given {
  Laws laws;  // laws without a provider are empty
  // the durations of the table; else short ones, for daily use
  bool is_long = false;
  // a file of reference values: "chain/links8_horizontal"
  std::function<truths::Case(const std::string& id)> truth;
  // modules whose functions are no laws, by id; without those that nothing provides
  std::map<std::string, modules::AnyModule> modules{};
  // called with each measure when it is found, because long rows take minutes; may be empty
  std::function<void(const report::Measure&)> on_measure{};
};

/// Collects the measures of a case.
class Findings {
 public:
  /// @param on_measure  as Given::on_measure
  Findings(report::BatteryRow& row, std::function<void(const report::Measure&)> on_measure)
      : row_(row), on_measure_(std::move(on_measure)) {}

  void at_most(const std::string& what, double value, double threshold, const std::string& unit,
               const std::string& why);
  void at_least(const std::string& what, double value, double threshold, const std::string& unit,
                const std::string& why);
  /// As at_most, for a method that is known to violate it: the measure must fail.
  void must_fail(const std::string& what, double value, double threshold, const std::string& unit,
                 const std::string& why);
  /// A condition that must be true.
  void is_true(const std::string& what, bool answer, const std::string& why);
  void not_run(const std::string& what, const std::string& reason);
  void plot(report::Plot plot) { row_.plots.push_back(std::move(plot)); }

  /// Runs a part of a case. An exception gives a line of its own: "not run" for a missing function,
  /// else an error.
  void part(const std::string& what, const std::function<void()>& measure);

 private:
  void add(report::Measure measure);

  report::BatteryRow& row_;
  std::function<void(const report::Measure&)> on_measure_;
};

/// One row of the table of hard cases.
struct Case {
  int row;
  std::string name, about;
  // laws needed besides integration: "", "a1", "a3", "a1 a3"
  std::string needs;
  // empty: not part of the battery yet, for the reason in `not_part`
  std::function<void(const Given&, Findings&)> run;
  std::string not_part{};
};

/// Every case, in the order of the table. Defined with the cases, in tests/stability.
std::vector<Case> cases();

/// Runs one case and marks its known shortfalls. Defined with the cases.
report::BatteryRow run(const Case& the_case, const Given& given);

}  // namespace tumble::battery
