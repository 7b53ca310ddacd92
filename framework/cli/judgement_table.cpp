#include "framework/cli/judgement_table.h"

#include <algorithm>

#include <fmt/format.h>

namespace tumble::cli {
namespace {

constexpr std::size_t kColumns = 110;  // of a line

struct Row {
  std::string verdict, quantity, found, allowed, why;
};

// no "-0"
std::string short_number(double value) { return fmt::format("{:.3g}", value == 0.0 ? 0.0 : value); }

Row row_of(const engines::CheckResult& check) {
  const std::string unit = check.unit.empty() ? "" : ' ' + check.unit;
  Row row;
  row.verdict = check.passed ? "right" : "WRONG";
  row.quantity = check.kind + (check.subject == "all" ? "" : " of " + check.subject);
  row.found = (engines::is_off_by(check) ? "off by " : "") + short_number(check.value) + unit;
  row.allowed = (check.at_least ? ">= " : "<= ") + short_number(check.threshold) + unit;
  row.why = check.why;
  const bool is_telling = !check.passed || check.kind == "flips" || check.kind == "event_count";
  if (is_telling && !check.detail.empty()) row.why = "[" + check.detail + "] " + row.why;
  return row;
}

/// Words of a text in lines of at most `width` columns; a longer word has a line of its own.
std::vector<std::string> wrapped(const std::string& text, std::size_t width) {
  std::vector<std::string> lines(1);
  std::size_t start = 0;
  while (start < text.size()) {
    const std::size_t end = std::min(text.find(' ', start), text.size());
    const std::string word = text.substr(start, end - start);
    start = end + 1;
    if (!lines.back().empty() && lines.back().size() + 1 + word.size() > width)
      lines.emplace_back();
    lines.back() += (lines.back().empty() ? "" : " ") + word;
  }
  return lines;
}

}  // namespace

std::string judgement_table(const std::vector<engines::CheckResult>& checks) {
  if (checks.empty()) return "";
  std::vector<Row> rows = {{"", "quantity", "found", "allowed", "why"}};
  for (const auto& check : checks) rows.push_back(row_of(check));
  const auto width = [&](std::string Row::*column) {
    std::size_t most = 0;
    for (const Row& row : rows) most = std::max(most, (row.*column).size());
    return most;
  };
  const std::size_t quantity = width(&Row::quantity), found = width(&Row::found),
                    allowed = width(&Row::allowed);
  const std::size_t indent = 2 + 7 + quantity + 2 + found + 2 + allowed + 2;
  const std::size_t rest = kColumns > indent + 24 ? kColumns - indent : 24;
  std::string table;
  for (const Row& row : rows) {
    const auto lines = wrapped(row.why, rest);
    table += fmt::format("  {:<7}{:<{}}  {:<{}}  {:<{}}  {}\n", row.verdict, row.quantity, quantity,
                         row.found, found, row.allowed, allowed, lines[0]);
    for (std::size_t i = 1; i < lines.size(); ++i)
      table += std::string(indent, ' ') + lines[i] + '\n';
  }
  const auto right =
      std::count_if(checks.begin(), checks.end(), [](const auto& check) { return check.passed; });
  return table + fmt::format("  {} of {} right\n", right, checks.size());
}

}  // namespace tumble::cli
