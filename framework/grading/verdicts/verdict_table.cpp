#include "framework/grading/verdicts/verdict_table.h"

#include <algorithm>
#include <array>
#include <ostream>
#include <sstream>

#include "framework/grading/verdicts/plain_text.h"

namespace tumble::grading {
namespace {

constexpr std::array kLevels = {"basic", "intermediate", "advanced", ""};
constexpr int kVerdictWidth = 24;

const char* colour(Verdict verdict) {
  switch (verdict) {
    case Verdict::kRight: return "\033[32m";
    case Verdict::kNotAttempted: return "\033[90m";
    case Verdict::kGraderFault:
    case Verdict::kMachineBusy: return "\033[35m";
    default: return "\033[31m";
  }
}

std::string number(double x) {
  std::ostringstream text;
  text << x;
  return text.str();
}

struct Line {
  const TestResult* result;
  const RubricItem* item;  // may be null
};

std::string title_of(const Line& line) {
  return line.item != nullptr ? line.item->title : line.result->test;
}

void print_level(std::ostream& out, const std::vector<Line>& lines, const std::string& level,
                 bool colours) {
  std::size_t widest = 0;
  for (const Line& line : lines) widest = std::max(widest, title_of(line).size());
  bool first = true;
  for (const Line& line : lines) {
    if ((line.item != nullptr ? line.item->level : "") != level) continue;
    if (first && !level.empty()) out << '\n' << level << '\n';
    first = false;
    std::string verdict = words(line.result->verdict);
    verdict.resize(kVerdictWidth, ' ');
    out << "  " << (colours ? colour(line.result->verdict) : "") << verdict
        << (colours ? "\033[0m" : "");
    std::string title = title_of(line);
    if (line.item != nullptr) {
      title.resize(widest + 2, ' ');
      title += line.result->test;
    }
    out << title << '\n';
  }
}

std::string indented(const std::string& text, const std::string& by) {
  std::istringstream in(text);
  std::string result;
  for (std::string line; std::getline(in, line);)
    result += line.empty() ? "" : by + (line.starts_with("  ") ? line.substr(2) : line) + "\n";
  return result;
}

void print_story(std::ostream& out, const Line& line, bool colours) {
  const TestResult& r = *line.result;
  out << '\n'
      << (colours ? colour(r.verdict) : "") << words(r.verdict) << (colours ? "\033[0m" : "")
      << ": " << title_of(line);
  if (line.item != nullptr) out << "  [" << r.test << ']';
  out << '\n' << indented(plain_text(r.story), "    ");
  if (!r.printed.empty())
    out << "    your code printed:\n" << indented(plain_text(r.printed), "      | ");
}

void print_count(std::ostream& out, const std::vector<TestResult>& results, const Rubric& rubric) {
  constexpr std::array kAll = {
      Verdict::kRight,          Verdict::kWrong,       Verdict::kNotAttempted, Verdict::kCrashed,
      Verdict::kOutOfResources, Verdict::kGraderFault, Verdict::kMachineBusy};
  out << '\n' << results.size() << (results.size() == 1 ? " test: " : " tests: ");
  bool first = true;
  for (const Verdict verdict : kAll) {
    const auto n = std::count_if(results.begin(), results.end(),
                                 [&](const TestResult& r) { return r.verdict == verdict; });
    if (n == 0) continue;
    out << (first ? "" : ", ") << n << ' ' << words(verdict);
    first = false;
  }
  double reached = 0.0, possible = 0.0;
  for (const TestResult& r : results)
    if (const RubricItem* item = rubric.find(r.test)) {
      possible += item->points;
      if (r.verdict == Verdict::kRight) reached += item->points;
    }
  if (possible > 0.0)
    out << "; " << number(reached) << " of " << number(possible) << " public points";
  out << '\n';
}

}  // namespace

void print_verdicts(std::ostream& out, const std::vector<TestResult>& results, const Rubric& rubric,
                    bool colours) {
  std::vector<Line> lines;
  for (const TestResult& r : results) lines.push_back({&r, rubric.find(r.test)});
  for (const char* level : kLevels) print_level(out, lines, level, colours);
  std::string missing;
  for (const Line& line : lines) {
    if (line.result->verdict == Verdict::kNotAttempted) {
      const std::string story = "    " + plain_text(line.result->story) + "\n";
      if (missing.find(story) == std::string::npos) missing += story;
    } else if (line.result->verdict != Verdict::kRight) {
      print_story(out, line, colours);
    } else if (!line.result->printed.empty()) {
      out << "\nright: " << title_of(line) << "\n    your code printed:\n"
          << indented(plain_text(line.result->printed), "      | ");
    }
  }
  if (!missing.empty()) out << "\nnot attempted\n" << missing;
  print_count(out, results, rubric);
}

}  // namespace tumble::grading
