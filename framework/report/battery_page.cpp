#include "framework/report/battery_page.h"

#include <fmt/format.h>

#include "framework/report/html.h"

namespace tumble::report {
namespace {

constexpr const char* kHowToRead =
    "Each row is a case that is known to break simulations. A value is compared with a threshold "
    "that was derived beforehand; the margin is how many times better it is "
    "than required. Methods that cannot hold are run too, and must fail: this shows that the "
    "measures can fail. A known shortfall is marked SHORT, with the reason.";

Look look_of(Outcome outcome) {
  switch (outcome) {
    case Outcome::kHolds: return Look::kGood;
    case Outcome::kFailsAsItMust: return Look::kWarning;
    case Outcome::kNotRun: return Look::kMuted;
    default: return Look::kBad;
  }
}

// With a sign, for readers who do not see the colour; both stay on one line.
std::string marked(Outcome outcome) {
  std::string sign;
  switch (outcome) {
    case Outcome::kHolds: sign = "\u2713"; break;
    case Outcome::kFailsAsItMust: sign = "\u2717"; break;
    case Outcome::kNotRun: sign = "\u2013"; break;
    default: sign = "\u25a0";
  }
  return sign + "\u00a0" + word_of(outcome);
}

std::string anchor_of(const BatteryRow& row) { return "case-" + std::to_string(row.row); }

void add_overview(const std::vector<BatteryRow>& rows, Page& page) {
  Table table;
  table.columns = {{"#", true},
                   {"Case"},
                   {"Closest to its threshold"},
                   {"Value", true},
                   {"Threshold", true},
                   {"Margin", true},
                   {"Verdict"},
                   {"Must fail"}};
  for (const BatteryRow& row : rows) {
    const Outcome outcome = outcome_of(row);
    const Measure* worst = tightest(row);
    std::vector<Cell> cells{{std::to_string(row.row)}, {row.name, "#" + anchor_of(row)}};
    if (worst == nullptr) {
      cells.insert(cells.end(),
                   {{row.not_part.empty() ? "" : "not part of the battery yet", "", Look::kMuted},
                    {},
                    {},
                    {},
                    {marked(Outcome::kNotRun), "", Look::kMuted},
                    {}});
    } else {
      int failing = 0, meant = 0;
      for (const Measure& m : row.measures) {
        meant += m.must_fail && m.not_run.empty() ? 1 : 0;
        failing += outcome_of(m) == Outcome::kFailsAsItMust ? 1 : 0;
      }
      cells.insert(cells.end(), {{worst->what},
                                 {shown_value(*worst)},
                                 {shown_threshold(*worst)},
                                 {shown_margin(*worst)},
                                 {marked(outcome), "", look_of(outcome)},
                                 {meant == 0 ? "" : fmt::format("{} of {} fail", failing, meant),
                                  "", failing == meant ? Look::kPlain : Look::kBad}});
    }
    table.rows.push_back(std::move(cells));
  }
  page.table(table);
}

void add_case(const BatteryRow& row, Page& page) {
  page.heading(fmt::format("{}. {}", row.row, row.name), 2, anchor_of(row));
  page.paragraph(row.about);
  if (!row.not_part.empty())
    page.paragraph("Not part of the battery yet: " + row.not_part, Look::kMuted);
  if (row.measures.empty()) return;
  Table table;
  table.columns = {{"Measured"},     {"Value", true}, {"Threshold", true},
                   {"Margin", true}, {"Verdict"},     {"Why this threshold"}};
  for (const Measure& m : row.measures) {
    const Outcome outcome = outcome_of(m);
    std::string why = m.why;
    if (!m.not_run.empty()) why = "Not run: " + m.not_run;
    if (!m.error.empty())
      why += (why.empty() ? "" : ". ") + std::string("What happened: ") + m.error;
    if (outcome == Outcome::kShort)
      why += (why.empty() ? "" : ". ") + std::string("Known shortfall: ") + m.shortfall;
    table.rows.push_back({{m.what},
                          {shown_value(m)},
                          {shown_threshold(m)},
                          {shown_margin(m)},
                          {marked(outcome), "", look_of(outcome)},
                          {why}});
  }
  page.table(table);
  for (const Plot& plot : row.plots) page.plot(plot);
}

}  // namespace

void write_battery_page(const std::vector<BatteryRow>& rows, const std::string& subtitle,
                        const std::string& record, const std::filesystem::path& file) {
  const BatteryCount count = count_of(rows);
  Page page("The stability battery", subtitle);
  page.tiles(
      {{"measures hold", {std::to_string(count.holds), "", Look::kGood}},
       {"fail, as they must", {std::to_string(count.fails_as_it_must), "", Look::kWarning}},
       {"known shortfalls",
        {std::to_string(count.shortfalls), "", count.shortfalls > 0 ? Look::kBad : Look::kPlain}},
       {"broken",
        {std::to_string(count.broken + count.too_good), "",
         count.good() ? Look::kPlain : Look::kBad}},
       {"not run", {std::to_string(count.not_run), "", Look::kMuted}}});
  page.paragraph(kHowToRead);
  add_overview(rows, page);
  for (const BatteryRow& row : rows) add_case(row, page);
  page.record(record);
  page.write(file);
}

}  // namespace tumble::report
