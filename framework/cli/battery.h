/// The stability battery as cases that can be run: the words that the verb, the test and the cases share.
///
/// A case builds its scenes, runs them by the laws given, and measures. It takes its truths from closed forms or from files, never
/// from what this project computed.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "framework/dynamics/laws.h"
#include "framework/engines/truths/truth_case.h"
#include "framework/modules/registry.h"
#include "framework/report/battery_row.h"

namespace tumble::battery {

/// What a case is run with.
struct Given {
  Laws laws;                                                    // what nobody provides is empty
  bool is_long = false;                                         // the lengths of the table; else short ones, for every day
  std::function<truths::Case(const std::string& id)> truth;     // a file of reference values: "chain/links8_horizontal"
  std::map<std::string, modules::AnyModule> modules{};          // whose functions are no laws, by id; what nobody provides is absent
  std::function<void(const report::Measure&)> on_measure{};     // told of each as it is found: long rows take minutes; may be empty
};

/// Collects what a case measures.
class Findings {
 public:
  /// @param on_measure  as Given::on_measure
  Findings(report::BatteryRow& row, std::function<void(const report::Measure&)> on_measure) : row_(row), on_measure_(std::move(on_measure)) {}

  void at_most(const std::string& what, double value, double threshold, const std::string& unit, const std::string& why);
  void at_least(const std::string& what, double value, double threshold, const std::string& unit, const std::string& why);
  /// The same as at_most by a method known not to hold: it must be seen failing.
  void must_fail(const std::string& what, double value, double threshold, const std::string& unit, const std::string& why);
  /// A question that must be answered with yes.
  void is_true(const std::string& what, bool answer, const std::string& why);
  void not_run(const std::string& what, const std::string& reason);
  void plot(report::Plot plot) { row_.plots.push_back(std::move(plot)); }

  /// Runs a part of a case. What stops it becomes a line of its own: "not run" for what nobody has written yet, else an error.
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
  std::string needs;                                            // which laws beside integration: "", "a1", "a3", "a1 a3"
  std::function<void(const Given&, Findings&)> run;             // empty: not part of the battery yet, for the reason in `not_part`
  std::string not_part{};
};

/// Every case, in the order of the table. Defined with the cases, in tests/stability.
std::vector<Case> cases();

/// Runs one case and marks its known shortfalls. Defined with the cases.
report::BatteryRow run(const Case& the_case, const Given& given);

}  // namespace tumble::battery
