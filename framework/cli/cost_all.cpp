#include "framework/cli/cost_all.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <limits>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "framework/cli/cost_measure.h"
#include "framework/cli/find_scene.h"
#include "framework/cli/json_output.h"
#include "framework/cli/record.h"
#include "framework/core/error.h"
#include "framework/core/not_implemented.h"
#include "framework/core/text.h"
#include "framework/report/html.h"
#include "framework/report/peer_rows.h"
#include "framework/report/tables_json.h"

namespace tumble::cli {
namespace {

namespace fs = std::filesystem;
using report::Cell;
using report::Look;
using report::PeerRow;

constexpr double kMarks[] = {1e-3, 1e-6, 1e-9};  // m
constexpr double kBudget = 4.0;                  // s per scene: sixty scenes take some minutes
const std::string kOurs = "Tumble";

struct SceneLine {
  std::string scene;
  std::string problem;  // the error that prevented the measurement; empty: none
  bool is_unwritten;    // the problem: a function that the scene asks is a stub
  std::optional<MeasuredCost> cost;
};

/// The reason why no run reaches an error.
std::string why_not(const report::CostPage& page, double mark) {
  if (page.floor > mark) return fmt::format("truth known to {} m", few_digits(page.floor, 1));
  double least = std::numeric_limits<double>::infinity();
  const report::CostCurve* best = page.curves.empty() ? nullptr : &page.curves.front();
  for (const report::CostCurve& curve : page.curves)
    for (const report::CostPoint& point : curve.points) {
      if (!point.stopped_by.empty() || !(point.error < least)) continue;
      least = point.error;
      best = &curve;
    }
  if (page.error_unit.empty()) return best == nullptr ? "nothing was run" : best->reading;
  return std::isfinite(least) ? fmt::format("least {} m", few_digits(least))
                              : "nothing gets through";
}

/// The least cost of an error, and its method.
Cell cell_of(const report::CostPage& page, double mark) {
  const report::CostCurve* curve = cheapest_curve(page, mark);
  if (curve == nullptr) return {"\u2013 (" + why_not(page, mark) + ")", "", Look::kMuted};
  const report::CostPoint* point = report::cheapest(*curve, mark);
  return {fmt::format("{}: {}, {}", report::price_of(point->cpu_s), curve->name, point->fineness)};
}

/// One row per scene with a cell for each error; a scene without a reference solution shows the
/// cost of a right run.
report::Table table_of(const std::vector<SceneLine>& lines) {
  report::Table table;
  table.caption =
      "CPU time for an error of at most 1e-3, 1e-6, 1e-9 m, and the method. \u2013: no run reaches "
      "it, with the reason.";
  table.columns = {{"Scene"}, {"Looked at"}, {"1e-3 m"}, {"1e-6 m"}, {"1e-9 m"}};
  for (const SceneLine& line : lines) {
    const Cell name{
        line.cost && !line.cost->size.empty() ? line.scene + ", " + line.cost->size : line.scene,
        line.cost ? line.scene + "/index.html" : ""};
    if (!line.cost) {
      table.rows.push_back({name,
                            {line.is_unwritten ? "not written" : "failed", "",
                             line.is_unwritten ? Look::kMuted : Look::kBad},
                            {line.problem, "", Look::kMuted},
                            {""},
                            {""}});
      continue;
    }
    const report::CostPage& page = line.cost->page;
    const bool whole = line.cost->duration_s >= (1.0 - 1e-9) * line.cost->asked_s;
    std::vector<Cell> cells{
        name,
        {whole ? fmt::format("{:.3g} s", line.cost->asked_s)
               : fmt::format("{:.3g} of {:.3g} s", line.cost->duration_s, line.cost->asked_s),
         "", Look::kMuted}};
    if (page.error_unit.empty()) {
      const Cell right = cell_of(page, 1.0);
      cells.push_back({"right by its numbers: " + right.text, "", right.look});
      cells.insert(cells.end(),
                   {{"no reference solution", "", Look::kMuted}, {"", "", Look::kMuted}});
    } else {
      for (const double mark : kMarks) cells.push_back(cell_of(page, mark));
    }
    table.rows.push_back(std::move(cells));
  }
  return table;
}

std::string peer_cell(const PeerRow* row) {
  return fmt::format("{} {}", row->engine, report::price_of(row->cpu_s));
}

/// The smallest error of rows that do not reach the required one.
std::string least_of(const std::vector<PeerRow>& rows, const std::string& bench, bool of_others) {
  double least = std::numeric_limits<double>::infinity();
  for (const PeerRow& row : rows)
    if (row.bench == bench && (row.engine == kOurs) != of_others && row.done)
      least = std::min(least, row.error);
  return std::isfinite(least) ? fmt::format("\u2013 (least {})", few_digits(least, 1))
                              : "\u2013 (does not finish)";
}

/// @param page  of the peers, as a link relative to this page
report::Table table_of_peers(const report::PeerRows& measured, const std::string& page) {
  report::Table table;
  table.caption =
      "Beside other engines: the CPU time of Tumble for an error of at most 1e-3, 1e-6, 1e-9 (of "
      "the scene's own kind), and of the cheapest peer that reaches it.";
  table.columns = {{"Scene"},     {"1e-3"}, {"best peer"}, {"1e-6"},
                   {"best peer"}, {"1e-9"}, {"best peer"}};
  std::set<std::string> benches;
  for (const PeerRow& row : measured.rows) benches.insert(row.bench);
  for (const std::string& bench : benches) {
    std::vector<Cell> cells{{bench, page + "#" + bench}};
    for (const double mark : kMarks) {
      const PeerRow *ours = report::cheapest_row(measured.rows, bench, kOurs, false, mark),
                    *theirs = report::cheapest_row(measured.rows, bench, kOurs, true, mark);
      const bool wins = ours != nullptr && (theirs == nullptr || ours->cpu_s <= theirs->cpu_s);
      cells.push_back(
          {ours == nullptr ? least_of(measured.rows, bench, false) : report::price_of(ours->cpu_s),
           "",
           wins              ? Look::kGood
           : ours == nullptr ? Look::kMuted
                             : Look::kBad});
      cells.push_back({theirs == nullptr ? least_of(measured.rows, bench, true) : peer_cell(theirs),
                       "", theirs == nullptr ? Look::kMuted : Look::kPlain});
    }
    table.rows.push_back(std::move(cells));
  }
  return table;
}

/// Columns as wide as their widest cell, counted in characters, not bytes.
void print(const report::Table& table) {
  const auto letters = [](const std::string& text) {
    return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
      return (static_cast<unsigned char>(c) & 0xC0) != 0x80;
    }));
  };
  std::vector<std::size_t> widths;
  for (const report::Column& column : table.columns) widths.push_back(letters(column.name));
  for (const auto& row : table.rows)
    for (std::size_t i = 0; i < row.size(); ++i)
      widths[i] = std::max(widths[i], letters(row[i].text));
  const auto line = [&](const auto& text_of, std::size_t n) {
    std::string text;
    for (std::size_t i = 0; i < n; ++i)
      text += text_of(i) + std::string(widths[i] - letters(text_of(i)) + 2, ' ');
    fmt::print("{}\n", text.substr(0, text.find_last_not_of(' ') + 1));
  };
  fmt::print("{}\n", table.caption);
  line([&](std::size_t i) { return table.columns[i].name; }, table.columns.size());
  for (const auto& row : table.rows) line([&](std::size_t i) { return row[i].text; }, row.size());
  fmt::print("\n");
}

SceneLine line_of(const Context& context, const CostWords& words, const std::string& scene) {
  CostWords own = words;
  own.scene = scene;
  own.budget_s = words.budget_s.value_or(kBudget);
  SceneLine line{scene, "", false, std::nullopt};
  try {
    line.cost = measure_cost(context, own);
    report::write_cost_page(line.cost->page, fs::path(words.out) / scene / "index.html");
  } catch (const NotImplemented& error) {
    line.problem = error.what();
    line.is_unwritten = true;
  } catch (const std::exception& error) {  // an error in one scene is shown in its row
    line.problem = error.what();
  }
  return line;
}

void write_page(const Context& context, const std::vector<report::Table>& tables,
                const CostWords& words, bool has_peers, const std::string& missing = "") {
  report::Page page("What accuracy costs, scene by scene",
                    "Every scene over its methods, steps, tolerances and engines");
  page.paragraph(
      "Each scene has a page of its own, with curves. Costs are CPU times of this machine in this "
      "run: only ratios matter. Where the reference solution holds for a part of a scene only, "
      "runs were compared over that part.");
  if (!missing.empty()) page.paragraph(missing, Look::kWarning);
  for (const report::Table& table : tables) page.table(table);
  if (!has_peers)
    page.paragraph(
        "Other engines are not included: tests/bench/peers/run.sh measures those that are "
        "installed.",
        Look::kMuted);
  page.record(record_of(context));
  page.write(fs::path(words.out) / "index.html");
}

}  // namespace

void cost_of_all(Context& context, const CostWords& words, KeptAtStop& stop) {
  if (words.n || words.duration_s || !words.on.empty())
    throw UserError("tumble cost all", "sizes, durations and --on belong to one scene",
                    "Leave --n, --duration-s and --on out, or name a scene.");
  // What each scene would fail for is refused before the first.
  words.steps_s();
  check_known(words);
  expect_module_files(context, parse_module_words(words.modules, context.registry));
  const std::vector<std::string> scenes = scene_names(context);
  const auto begun = std::chrono::steady_clock::now();
  std::vector<SceneLine> lines;
  for (std::size_t k = 0; k < scenes.size(); ++k) {
    const double spent =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
    fmt::print(stderr, "[{}/{}] {}{}\n", k + 1, scenes.size(), scenes[k],
               k == 0 ? ""
                      : fmt::format(" · about {:.0f} min left",
                                    std::ceil(spent / static_cast<double>(k) *
                                              static_cast<double>(scenes.size() - k) / 60.0)));
    lines.push_back(line_of(context, words, scenes[k]));
    if (!lines.back().problem.empty()) context.exit = ExitCode::kCheckFailed;
    stop.keep(lines.size(), scenes.size(), (fs::path(words.out) / "index.html").string(), [&] {
      const bool is_all = lines.size() == scenes.size();
      write_page(context, {table_of(lines)}, words, false,
                 is_all ? ""
                        : fmt::format("Only {} of {} scenes: the command has not come "
                                      "to its end.",
                                      lines.size(), scenes.size()));
    });
  }
  std::vector<report::Table> tables{table_of(lines)};
  const fs::path rows = fs::path("out") / "peers" / "rows";
  const bool has_peers = fs::is_directory(rows);
  if (has_peers)
    tables.push_back(table_of_peers(report::read_peer_rows(rows), "../peers/index.html"));
  write_page(context, tables, words, has_peers);
  if (words.json) {
    nlohmann::ordered_json all = nlohmann::ordered_json::array();
    for (const report::Table& table : tables) all.push_back(report::json_of(table));
    return print_json(context, {{"tables", std::move(all)},
                                {"page", (fs::path(words.out) / "index.html").string()}});
  }
  for (const report::Table& table : tables) print(table);
  fmt::print("{}\n", (fs::path(words.out) / "index.html").string());
}

}  // namespace tumble::cli
