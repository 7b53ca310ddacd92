/// Results of the stability battery as plain data: one row per hard case, with measured numbers
/// against thresholds, and plots.
///
/// Methods that are known to fail are measured too, and must fail: this shows that the measures
/// can. A threshold that the project does not reach yet is a known shortfall: it stays red in the
/// table, with its value and reason, and is counted.
#pragma once

#include <string>
#include <vector>

#include "framework/report/plot.h"

namespace tumble::report {

enum class Outcome {
  kHolds,
  kFailsAsItMust,  // a method known to fail has failed
  kNotRun,         // with a reason
  kShort,          // does not hold, and is a known shortfall
  // a method known to fail has not: the measure cannot distinguish right from wrong
  kTooGood,
  kBroken,  // does not hold
};

/// One number against its threshold.
struct Measure {
  std::string what;  // quantity and method
  double value = 0.0, threshold = 0.0;
  std::string unit;          // empty: none
  std::string why;           // the threshold's reason
  bool at_least = false;     // holds when value >= threshold instead of <=
  bool must_fail = false;    // the method is known to fail
  bool is_question = false;  // yes (1) or no (0); the threshold is the right answer
  // known shortfall: why the threshold is not reached; empty: it must be
  std::string shortfall{};
  std::string not_run{};  // why there is no value; empty: there is one
  std::string error{};    // what stopped the run; empty: nothing
};

/// One hard case.
struct BatteryRow {
  int row = 0;  // of the table of hard cases
  std::string name;
  std::string about;  // what it is and what goes wrong in it, in two or three sentences
  std::vector<Measure> measures;
  std::vector<Plot> plots;
  std::string not_part{};  // why the battery does not include this row yet; empty: it does
};

/// Whether the value is on the right side of the threshold; false for NaN.
bool within(const Measure& measure);
Outcome outcome_of(const Measure& measure);
/// How many times better than the threshold; below 1: worse. Infinite for an error of exactly 0;
/// NaN without a value, and for a question.
double margin_of(const Measure& measure);
/// The worst of its measures; kNotRun without any.
Outcome outcome_of(const BatteryRow& row);
/// The measure that decides a row: the worst outcome, and of those the smallest margin. Null
/// without measures.
const Measure* tightest(const BatteryRow& row);

/// "holds", "fails, as it must", "short", ...
std::string word_of(Outcome outcome);
/// "3.1e-12 m", "12", "without bound".
std::string shown(double value, const std::string& unit);
/// The value; "yes" or "no" for a question; "-" where there is none.
std::string shown_value(const Measure& measure);
/// "x 32", "exact".
std::string shown_margin(const Measure& measure);
/// "<= 1e-8 m".
std::string shown_threshold(const Measure& measure);

struct BatteryCount {
  // hard cases, and those not part yet
  int rows = 0, not_part = 0;
  // measures
  int holds = 0, fails_as_it_must = 0, not_run = 0, shortfalls = 0, too_good = 0, broken = 0;
  // known shortfalls that hold
  int reached_now = 0;
  bool good() const { return too_good == 0 && broken == 0; }
};
BatteryCount count_of(const std::vector<BatteryRow>& rows);
/// A summary in one sentence.
std::string sentence_of(const BatteryCount& count);

}  // namespace tumble::report
