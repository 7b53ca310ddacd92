#include "framework/grading/verdicts/verdict_table.h"

#include <algorithm>
#include <array>
#include <map>
#include <ostream>
#include <sstream>

#include "framework/core/text.h"
#include "framework/grading/verdicts/mend_order.h"
#include "framework/grading/verdicts/own_functions.h"
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

constexpr const char* kNotRun = "not run";

const char* colour(const TestResult& result) {
  return is_cut_off(result) ? "\033[90m" : colour(result.verdict);
}
std::string words_of(const TestResult& result) {
  return is_cut_off(result) ? kNotRun : words(result.verdict);
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
    std::string verdict = words_of(*line.result);
    verdict.resize(kVerdictWidth, ' ');
    out << "  " << (colours ? colour(*line.result) : "") << verdict << (colours ? "\033[0m" : "");
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

// Where the story of a call that did not return names no line: the one in which its function
// begins. And the function that the failure probably follows from.
std::string places_of(const TestResult& r, const std::map<std::string, std::string>& follows,
                      const std::string& source) {
  std::string text;
  const bool is_lost = r.verdict == Verdict::kCrashed || r.verdict == Verdict::kOutOfResources;
  const int line =
      is_lost && exact_place_of(r).empty() ? line_of_definition(source, r.last_call) : 0;
  if (line > 0) text += "    " + r.last_call + " begins in line " + std::to_string(line) + "\n";
  if (const auto other = follows.find(r.last_call); other != follows.end())
    text += "    probably follows from " + with_its_line(source, other->second) +
            ", which it asks: mend that first\n";
  return text;
}

void print_story(std::ostream& out, const Line& line, bool colours,
                 const std::map<std::string, std::string>& follows, const std::string& source) {
  const TestResult& r = *line.result;
  out << '\n'
      << (colours ? colour(r.verdict) : "") << words(r.verdict) << (colours ? "\033[0m" : "")
      << ": " << title_of(line);
  if (line.item != nullptr) out << "  [" << r.test << ']';
  out << '\n' << places_of(r, follows, source) << indented(plain_text(r.story), "    ");
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
    const auto n = std::count_if(results.begin(), results.end(), [&](const TestResult& r) {
      return r.verdict == verdict && !is_cut_off(r);
    });
    if (n == 0) continue;
    out << (first ? "" : ", ") << n << ' ' << words(verdict);
    first = false;
  }
  if (const auto n = std::count_if(results.begin(), results.end(), is_cut_off); n > 0)
    out << (first ? "" : ", ") << n << ' ' << kNotRun;
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

// One line a heading: what costs most stands first, and before it what kept tests from running.
void print_mend_first(std::ostream& out, const std::vector<Line>& lines,
                      const std::vector<std::string>& headings, bool used_up) {
  struct Group {
    std::string heading;
    std::size_t tests = 0;
    double points = 0.0;
    bool is_first = false;
  };
  std::vector<Group> groups;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const TestResult& r = *lines[i].result;
    if (headings[i].empty() || r.verdict == Verdict::kNotAttempted) continue;
    auto group = std::find_if(groups.begin(), groups.end(),
                              [&](const Group& one) { return one.heading == headings[i]; });
    if (group == groups.end()) group = groups.insert(groups.end(), Group{headings[i], 0, 0, false});
    ++group->tests;
    group->points += lines[i].item != nullptr ? lines[i].item->points : 0.0;
    group->is_first = group->is_first || (used_up && is_cut_off(r));
  }
  std::stable_sort(groups.begin(), groups.end(), [](const Group& a, const Group& b) {
    return a.is_first != b.is_first ? a.is_first : a.points > b.points;
  });
  if (groups.empty()) return;
  out << "\nmend first\n";
  for (const Group& group : groups) {
    out << "    " << plain_text(group.heading) << " (" << counted(group.tests, "test");
    if (group.points > 0.0)
      out << ", " << number(group.points) << (group.points == 1.0 ? " point" : " points");
    out << ")\n";
  }
}

}  // namespace

void print_verdicts(std::ostream& out, const std::vector<TestResult>& results, const Rubric& rubric,
                    bool colours, const std::string& source) {
  const auto follows = what_follows(results, source);
  std::vector<Line> lines;
  for (const TestResult& r : results) lines.push_back({&r, rubric.find(r.test)});
  for (const char* level : kLevels) print_level(out, lines, level, colours);
  std::string missing, not_run;
  for (const Line& line : lines) {
    if (is_cut_off(*line.result)) {
      not_run = "    " + plain_text(line.result->story) + "\n";
    } else if (line.result->verdict == Verdict::kNotAttempted) {
      const std::string story = "    " + plain_text(line.result->story) + "\n";
      if (missing.find(story) == std::string::npos) missing += story;
    } else if (line.result->verdict != Verdict::kRight) {
      print_story(out, line, colours, follows, source);
    } else if (!line.result->printed.empty()) {
      out << "\nright: " << title_of(line) << "\n    your code printed:\n"
          << indented(plain_text(line.result->printed), "      | ");
    }
  }
  if (!missing.empty()) out << "\nnot attempted\n" << missing;
  if (!not_run.empty()) out << "\n" << kNotRun << '\n' << not_run;
  if (!source.empty())
    print_mend_first(out, lines, headings_of(results, source),
                     !what_used_the_time(results).empty());
  print_count(out, results, rubric);
}

}  // namespace tumble::grading
