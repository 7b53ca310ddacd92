#include "framework/cli/truths_table.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>

#include "framework/core/text.h"

namespace tumble::cli {
namespace {

using truths::Line;
using truths::Verdict;

// Columns: 40 case, 21 output, 3 x 8 numbers, 13 verdict, with blanks between: 100.
constexpr std::size_t kCaseWidth = 40, kOutputWidth = 20, kNoteWidth = 94;
constexpr std::size_t kMostFailures = 8;  // of one case; --each shows all

std::string show(double x) {
  if (std::isnan(x)) return "-";
  char text[32];
  std::snprintf(text, sizeof text, x == 0.0 ? "0" : "%.1e", x);
  return text;
}

/// Names are cut in the middle, which carries the least information.
void print_row(const std::string& name, const std::string& output, const Line& line,
               const std::string& verdict) {
  std::printf("%-40s %-20s %7s %7s %7s  %s\n", without_middle(name, kCaseWidth).c_str(),
              without_middle(output, kOutputWidth).c_str(), show(line.error).c_str(),
              show(line.error_floor).c_str(), show(line.tolerance).c_str(), verdict.c_str());
}

/// Wrapped at blanks, indented.
void print_note(const std::string& note) {
  std::size_t start = 0;
  while (start < note.size()) {
    std::size_t end = note.size();
    if (end - start > kNoteWidth) {
      end = note.rfind(' ', start + kNoteWidth);
      if (end == std::string::npos || end <= start) end = start + kNoteWidth;
    }
    std::printf("      %s\n", note.substr(start, end - start).c_str());
    start = note.find_first_not_of(' ', end);
  }
}

void print_output(const Line& line) {
  print_row("    " + line.output, "", line, truths::word_of(line.verdict));
  if (!line.note.empty()) print_note(line.note);
}

/// Whether the line is the measured order of an integrator, which is also shown where all is right.
bool is_order(const Line& line) {
  return line.verdict == Verdict::kRight && line.output.find("order_") != std::string::npos;
}

void print_failures(const CaseResult& result) {
  std::size_t failures = 0;
  for (const Line& line : result.lines) {
    if (line.verdict != Verdict::kWrong) continue;
    if (++failures <= kMostFailures) print_output(line);
  }
  if (failures > kMostFailures)
    std::printf("    and %zu more outputs are wrong: --each shows all\n", failures - kMostFailures);
}

// Missing functions are listed once, below the first case that needs them.
void print_stubs(const CaseResult& result, std::set<std::string>& said) {
  for (const Line& line : result.lines) {
    if (line.verdict == Verdict::kNotAttempted && said.insert(line.note).second)
      print_note(line.note);
  }
}

}  // namespace

void print_truths_head() {
  std::printf("%-40s %-20s %7s %7s %7s  %s\n", "case", "worst output", "error", "floor", "allowed",
              "verdict");
}

void print_truths_case(const CaseResult& result, bool each, std::set<std::string>& said) {
  const Line* worst = truths::worst_line(result.lines);
  if (worst == nullptr) return;
  print_row(result.id, worst->output, *worst, truths::word_of(truths::verdict_of(result.lines)));
  if (each) {
    for (const Line& line : result.lines) print_output(line);
    return;
  }
  print_failures(result);
  print_stubs(result, said);
  const bool about_orders = result.family == "logistic";
  for (const Line& line : result.lines) {
    if (about_orders && is_order(line))
      print_note(line.output.substr(line.output.find("order_") + 6) + ": " + line.note);
  }
}

int count_cases(const std::vector<CaseResult>& results, Verdict verdict) {
  return static_cast<int>(std::count_if(
      results.begin(), results.end(),
      [=](const CaseResult& result) { return truths::verdict_of(result.lines) == verdict; }));
}

void print_truths_count(const std::vector<CaseResult>& results,
                        const std::map<std::string, int>& skipped) {
  int outputs = 0;
  for (const CaseResult& result : results) {
    for (const Line& line : result.lines)
      outputs += line.verdict == Verdict::kRight || line.verdict == Verdict::kWrong;
  }
  std::printf("\n%zu cases, %d outputs compared: %d right, %d wrong, %d not attempted",
              results.size(), outputs, count_cases(results, Verdict::kRight),
              count_cases(results, Verdict::kWrong), count_cases(results, Verdict::kNotAttempted));
  if (const int silent = count_cases(results, Verdict::kNotCompared); silent > 0)
    std::printf(", %d not compared", silent);
  std::printf("\n");
  if (skipped.empty()) return;
  int cases = 0;
  std::string families;
  for (const auto& [family, n] : skipped) {
    cases += n;
    families += (families.empty() ? "" : ", ") + family + " (" + std::to_string(n) + ")";
  }
  std::printf("skipped %d cases of %zu families that are not known here:\n", cases, skipped.size());
  print_note(families);
}

nlohmann::ordered_json truths_to_json(const std::vector<CaseResult>& results,
                                      const std::map<std::string, int>& skipped) {
  using Json = nlohmann::ordered_json;
  const auto number = [](double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); };
  Json cases = Json::array();
  for (const CaseResult& result : results) {
    Json lines = Json::array();
    for (const Line& line : result.lines) {
      lines.push_back({{"output", line.output},
                       {"error", number(line.error)},
                       {"floor", number(line.error_floor)},
                       {"pass_mark", number(line.tolerance)},
                       {"verdict", truths::word_of(line.verdict)},
                       {"note", line.note}});
    }
    cases.push_back({{"id", result.id},
                     {"verdict", truths::word_of(truths::verdict_of(result.lines))},
                     {"outputs", lines}});
  }
  return {{"cases", cases},
          {"skipped", skipped},
          {"count",
           {{"right", count_cases(results, Verdict::kRight)},
            {"wrong", count_cases(results, Verdict::kWrong)},
            {"not_attempted", count_cases(results, Verdict::kNotAttempted)},
            {"not_compared", count_cases(results, Verdict::kNotCompared)}}}};
}

}  // namespace tumble::cli
