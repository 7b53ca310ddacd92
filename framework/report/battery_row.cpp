#include "framework/report/battery_row.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "framework/core/text.h"

namespace tumble::report {

bool within(const Measure& measure) {
  if (measure.is_question) return measure.value == measure.threshold;
  return measure.at_least ? measure.value >= measure.threshold : measure.value <= measure.threshold;
}

Outcome outcome_of(const Measure& measure) {
  if (!measure.not_run.empty()) return Outcome::kNotRun;
  if (measure.must_fail)
    return measure.error.empty() && within(measure) ? Outcome::kTooGood : Outcome::kFailsAsItMust;
  if (measure.error.empty() && within(measure)) return Outcome::kHolds;
  return measure.shortfall.empty() ? Outcome::kBroken : Outcome::kShort;
}

double margin_of(const Measure& measure) {
  if (!measure.not_run.empty() || !measure.error.empty() || measure.is_question)
    return std::numeric_limits<double>::quiet_NaN();
  const double above = measure.at_least ? measure.value : measure.threshold,
               below = measure.at_least ? measure.threshold : measure.value;
  if (below <= 0.0) return above >= below ? std::numeric_limits<double>::infinity() : 0.0;
  return std::max(above, 0.0) / below;
}

Outcome outcome_of(const BatteryRow& row) {
  Outcome worst = Outcome::kHolds;
  bool any = false;
  for (const Measure& measure : row.measures) {
    const Outcome outcome = outcome_of(measure);
    if (outcome == Outcome::kFailsAsItMust || outcome == Outcome::kHolds) any = true;
    if (outcome > Outcome::kNotRun) worst = std::max(worst, outcome), any = true;
  }
  return any ? worst : Outcome::kNotRun;
}

const Measure* tightest(const BatteryRow& row) {
  const auto rank = [](const Measure& m) {
    const Outcome outcome = outcome_of(m);
    // expected
    return outcome == Outcome::kFailsAsItMust || outcome == Outcome::kNotRun
               ? -1
               : static_cast<int>(outcome);
  };
  const auto closer = [](const Measure& a, const Measure& b) {
    return margin_of(a) < margin_of(b) || (std::isnan(margin_of(b)) && !std::isnan(margin_of(a)));
  };
  const Measure* found = nullptr;
  for (const Measure& measure : row.measures) {
    if (found == nullptr || rank(measure) > rank(*found) ||
        (rank(measure) == rank(*found) && closer(measure, *found)))
      found = &measure;
  }
  return found;
}

std::string word_of(Outcome outcome) {
  switch (outcome) {
    case Outcome::kHolds: return "holds";
    case Outcome::kFailsAsItMust: return "fails, as it must";
    case Outcome::kNotRun: return "not run";
    case Outcome::kShort: return "SHORT";
    case Outcome::kTooGood: return "HOLDS, AND MUST NOT";
    case Outcome::kBroken: return "BROKEN";
  }
  return "";
}

std::string shown(double value, const std::string& unit) {
  const std::string space = unit.empty() ? "" : " " + unit;
  if (std::isnan(value)) return "no number";
  if (std::isinf(value)) return value > 0 ? "without bound" : "-inf";
  const bool plain = value == std::round(value) && std::abs(value) < 1e6;
  return (plain                                             ? fmt::format("{:.0f}", value)
          : std::abs(value) >= 0.1 && std::abs(value) < 1e4 ? fmt::format("{:.4g}", value)
                                                            : few_digits(value)) +
         space;
}

std::string shown_value(const Measure& measure) {
  if (!measure.not_run.empty() || !measure.error.empty()) return "-";
  if (measure.is_question) return measure.value == 1.0 ? "yes" : "no";
  return shown(measure.value, measure.unit);
}

std::string shown_margin(const Measure& measure) {
  const double margin = margin_of(measure);
  if (std::isnan(margin)) return "-";
  if (std::isinf(margin)) return "exact";
  return margin >= 0.1 && margin < 1e4 ? "x " + few_digits(margin) : "x " + few_digits(margin, 1);
}

std::string shown_threshold(const Measure& measure) {
  if (!measure.not_run.empty() || std::isnan(measure.threshold)) return "-";
  if (measure.is_question) return measure.threshold == 1.0 ? "yes" : "no";
  return (measure.at_least ? ">= " : "<= ") + shown(measure.threshold, measure.unit);
}

BatteryCount count_of(const std::vector<BatteryRow>& rows) {
  BatteryCount count;
  for (const BatteryRow& row : rows) {
    ++count.rows;
    count.not_part += row.not_part.empty() ? 0 : 1;
    for (const Measure& measure : row.measures) {
      switch (outcome_of(measure)) {
        case Outcome::kHolds: ++count.holds; break;
        case Outcome::kFailsAsItMust: ++count.fails_as_it_must; break;
        case Outcome::kNotRun: ++count.not_run; break;
        case Outcome::kShort: ++count.shortfalls; break;
        case Outcome::kTooGood: ++count.too_good; break;
        case Outcome::kBroken: ++count.broken; break;
      }
      if (outcome_of(measure) == Outcome::kHolds && !measure.shortfall.empty()) ++count.reached_now;
    }
  }
  return count;
}

std::string sentence_of(const BatteryCount& count) {
  std::string words = fmt::format(
      "{} hard cases ({} of them not part of the battery yet): {} measures hold, {} of methods "
      "that cannot hold fail as they must, {} known shortfalls",
      count.rows, count.not_part, count.holds, count.fails_as_it_must, count.shortfalls);
  if (count.not_run > 0) words += fmt::format(", {} not run", count.not_run);
  words += fmt::format(", {} broken", count.broken);
  if (count.too_good > 0) words += fmt::format(", {} hold that must not", count.too_good);
  if (count.reached_now > 0)
    words += fmt::format("; {} listed as shortfalls hold here", count.reached_now);
  return words + ".";
}

}  // namespace tumble::report
