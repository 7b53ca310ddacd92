#include "framework/grading/verdicts/verdict_table.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <ostream>
#include <sstream>

#include "framework/core/terminal.h"
#include "framework/core/text.h"
#include "framework/grading/verdicts/mend_order.h"
#include "framework/grading/verdicts/own_functions.h"
#include "framework/grading/verdicts/plain_text.h"

namespace tumble::grading {
namespace {

constexpr std::array kLevels = {"basic", "intermediate", "advanced", ""};
constexpr int kVerdictWidth = 24;
// at most so many tests have a line each: "check a1 'Two walls'"
constexpr std::size_t kFew = 12;
constexpr std::size_t kMostColumns = 100;  // longer lines are read badly
// of the lines of a story: behind "    scene:    ", else behind "    "
constexpr std::size_t kBehindLabel = 14, kBehindNone = 8;

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

// Of a name on a line of its own: below the titles where it has room there.
std::size_t indent_of(const std::string& name, std::size_t columns) {
  constexpr std::size_t kLeast = 4, kMargin = 2 + kVerdictWidth;
  return std::clamp(columns - std::min(columns, name.size()), kLeast, kMargin);
}

void print_level(std::ostream& out, const std::vector<Line>& lines, const std::string& level,
                 bool colours, std::size_t columns) {
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
    // the name of a test has no spaces: behind the widest title, or on a line of its own
    constexpr std::size_t kMargin = 2 + kVerdictWidth;
    if (kMargin + title.size() > columns && line.item != nullptr) {
      out << wrapped(std::string(kMargin, ' ') + title_of(line), columns, kMargin).substr(kMargin)
          << '\n'
          << std::string(indent_of(line.result->test, columns), ' ') << line.result->test << '\n';
      continue;
    }
    out << title << '\n';
  }
}

// "RayTriangle" becomes "Ray triangle", "ContactNormal2d" "Contact normal 2d".
std::string group_in_words(const std::string& test) {
  const auto is = [](int (*kind)(int), char c) { return kind(static_cast<unsigned char>(c)) != 0; };
  const std::string name = test.substr(0, test.find('.'));
  std::string words;
  for (std::size_t i = 0; i < name.size(); ++i) {
    const char c = name[i];
    const bool is_size =
        is(std::isdigit, c) && i + 1 < name.size() && is(std::islower, name[i + 1]);
    const bool begins = i > 0 && (is(std::isupper, c) || is_size);
    if (begins) words += ' ';
    words += begins ? static_cast<char>(std::tolower(static_cast<unsigned char>(c))) : c;
  }
  return words;
}

// One line a group, those that are all right together:
//   ok              12 of 12  Ray triangle
//   2 wrong          5 of 7   Collision impulse
void print_groups(std::ostream& out, const std::vector<Line>& lines, bool colours) {
  struct Group {
    std::string name;
    std::size_t right = 0, all = 0;
    std::vector<std::pair<const TestResult*, std::size_t>> others;  // by verdict, how many
  };
  std::vector<Group> groups;
  for (const Line& line : lines) {
    const std::string name = group_in_words(line.result->test);
    auto group = std::find_if(groups.begin(), groups.end(),
                              [&](const Group& one) { return one.name == name; });
    if (group == groups.end()) group = groups.insert(groups.end(), Group{name, 0, 0, {}});
    ++group->all;
    if (line.result->verdict == Verdict::kRight) {
      ++group->right;
      continue;
    }
    const std::string verdict = words_of(*line.result);
    auto other = std::find_if(group->others.begin(), group->others.end(),
                              [&](const auto& one) { return words_of(*one.first) == verdict; });
    if (other == group->others.end())
      group->others.emplace_back(line.result, 1);
    else
      ++other->second;
  }
  std::stable_sort(groups.begin(), groups.end(), [](const Group& a, const Group& b) {
    return a.others.empty() > b.others.empty();
  });
  std::size_t widest = 0;
  for (const Group& group : groups) widest = std::max(widest, group.name.size());
  out << '\n';
  for (const Group& group : groups) {
    const bool is_ok = group.others.empty();
    const char* colour_of_group =
        is_ok ? colour(Verdict::kRight) : colour(*group.others.front().first);
    out << "  " << (colours ? colour_of_group : "") << (is_ok ? "ok" : "  ")
        << (colours ? "\033[0m" : "");
    const std::string right = std::to_string(group.right), all = std::to_string(group.all);
    out << std::string(5 - std::min<std::size_t>(4, right.size()), ' ') << right << " of "
        << std::string(2 - std::min<std::size_t>(2, all.size()), ' ') << all << "  " << group.name;
    if (!is_ok) {
      out << std::string(widest - group.name.size() + 2, ' ');
      for (std::size_t k = 0; k < group.others.size(); ++k) {
        const auto& [result, count] = group.others[k];
        out << (k > 0 ? ", " : "") << count << ' ' << (colours ? colour(*result) : "")
            << words_of(*result) << (colours ? "\033[0m" : "");
      }
    }
    out << '\n';
  }
}

std::string indented(const std::string& text, const std::string& by) {
  std::istringstream in(text);
  std::string result;
  for (std::string line; std::getline(in, line);)
    result += line.empty() ? "" : by + (line.starts_with("  ") ? line.substr(2) : line) + "\n";
  return result;
}

// An indented story, broken to the columns: what belongs to a label stands behind it.
std::string broken(const std::string& story, std::size_t columns) {
  constexpr std::size_t kMargin = 4;
  std::istringstream in(story);
  std::string result;
  for (std::string line; std::getline(in, line);) {
    const std::size_t colon = line.find(':'), space = line.find(' ', kMargin);
    const bool has_label = colon != line.npos && colon > kMargin && colon < kBehindLabel &&
                           (space > colon || line.compare(kMargin, 8, "look at:") == 0);
    result += wrapped(line, columns, has_label ? kBehindLabel : kBehindNone) + "\n";
  }
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

void print_story(std::ostream& out, const Line& line, const TableWords& words,
                 const std::map<std::string, std::string>& follows) {
  const TestResult& r = *line.result;
  out << '\n'
      << (words.colours ? colour(r.verdict) : "") << grading::words(r.verdict)
      << (words.colours ? "\033[0m" : "") << ": " << title_of(line);
  if (line.item != nullptr) {
    const std::size_t used = std::string(grading::words(r.verdict)).size() + title_of(line).size();
    out << (used + r.test.size() + 6 > words.columns ? "\n    [" : "  [") << r.test << ']';
  }
  out << '\n'
      << wrapped(places_of(r, follows, words.source), words.columns, kBehindNone)
      << broken(indented(plain_text(r.story), "    "), words.columns);
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

// One entry a heading, in the order in which they are to be mended.
void print_mend_first(std::ostream& out, const std::vector<HeadingGroup>& groups,
                      std::size_t columns) {
  bool is_first = true;
  for (const HeadingGroup& group : groups) {
    if (!group.is_attempted) continue;
    if (is_first) out << "\nmend first\n";
    is_first = false;
    std::string text =
        "    " + plain_text(group.heading) + " (" + counted(group.tests.size(), "test");
    if (group.points > 0.0)
      text += ", " + number(group.points) + (group.points == 1.0 ? " point" : " points");
    out << wrapped(text + ")\n", columns, 8);
  }
}

}  // namespace

TableWords table_words_for(int descriptor) {
  TableWords words;
  words.colours = shows_colours(descriptor);
  words.columns = std::min(terminal_columns(descriptor), kMostColumns);
  return words;
}

void print_verdicts(std::ostream& out, const std::vector<TestResult>& results, const Rubric& rubric,
                    const TableWords& words) {
  const std::string& source = words.source;
  const auto follows = what_follows(results, source);
  std::vector<Line> lines;
  std::vector<double> points;
  for (const TestResult& r : results) {
    lines.push_back({&r, rubric.find(r.test)});
    points.push_back(lines.back().item != nullptr ? lines.back().item->points : 0.0);
  }
  if (words.all || lines.size() <= kFew)
    for (const char* level : kLevels) print_level(out, lines, level, words.colours, words.columns);
  else
    print_groups(out, lines, words.colours);
  const auto groups = in_order_of_mending(results, headings_of(results, source), points);
  for (const HeadingGroup& group : groups)
    for (const std::size_t i : group.tests)
      if (!is_cut_off(results[i]) && results[i].verdict != Verdict::kNotAttempted)
        print_story(out, lines[i], words, follows);
  std::string missing, not_run;
  for (const Line& line : lines) {
    const Verdict verdict = line.result->verdict;
    const std::string story =
        wrapped("    " + plain_text(line.result->story) + "\n", words.columns, 8);
    if (is_cut_off(*line.result)) {
      not_run = story;
    } else if (verdict == Verdict::kNotAttempted) {
      if (missing.find(story) == std::string::npos) missing += story;
    } else if (!is_final_verdict(verdict)) {  // they stand under no heading
      print_story(out, line, words, follows);
    } else if (verdict == Verdict::kRight && !line.result->printed.empty()) {
      out << "\nright: " << title_of(line) << "\n    your code printed:\n"
          << indented(plain_text(line.result->printed), "      | ");
    }
  }
  if (!missing.empty()) out << "\nnot attempted\n" << missing;
  if (!not_run.empty()) out << "\n" << kNotRun << '\n' << not_run;
  if (!source.empty()) print_mend_first(out, groups, words.columns);
  print_count(out, results, rubric);
}

}  // namespace tumble::grading
