#include "framework/grading/grades/class_page.h"

#include <algorithm>
#include <array>
#include <map>
#include <sstream>

#include <fmt/format.h>

#include "framework/core/text.h"
#include "framework/core/version.h"
#include "framework/grading/grades/scoring.h"
#include "framework/grading/verdicts/plain_text.h"
#include "framework/render/picture.h"
#include "framework/trajectory/record.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;
using report::Cell;
using report::Look;

std::string title_of(const modules::ModuleKind& kind, const char* what) {
  return kind.title + ": " + what;
}

std::string link_of(const Grade& grade) {
  return report::link_to(fs::path(grade.folder) / "index.html");
}

void add_links(report::Page& page) {
  page.links({{"All submissions", "index.html"},
              {"The class", "class.html"},
              {"Pictures", "pictures.html"},
              {"Similar submissions", "similar.html"}});
}

void add_histogram(report::Page& page, const std::vector<Grade>& grades) {
  constexpr std::size_t kBins = 10;
  std::array<double, kBins> bins{};
  for (const Grade& grade : grades) {
    if (!grade.has_score() || grade.possible <= 0.0) continue;
    const double share = grade.score / grade.possible * static_cast<double>(kBins);
    ++bins[std::min(kBins - 1, static_cast<std::size_t>(std::max(0.0, share)))];
  }
  report::StackedBars bars{"Points before late days",
                           {"submissions"},
                           {"submissions"},
                           {},
                           "Full points count to the last bar.",
                           true};
  for (std::size_t i = 0; i < kBins; ++i)
    bars.rows.push_back({fmt::format("{} to {} %", 10 * i, 10 * (i + 1)), {bins[i]}});
  page.heading("Points", 2, "points");
  page.plot(bars);
}

// The tests of which `is_one` holds, by number and title.
template <class IsOne>
std::string named(const std::vector<TestCount>& counts, const IsOne& is_one) {
  constexpr std::size_t kMostNamed = 12;  // more are read in the table's last column
  std::string text;
  std::size_t number = 0;
  for (std::size_t i = 0; i < counts.size(); ++i)
    if (is_one(counts[i]) && ++number <= kMostNamed)
      text += fmt::format("{}{} {}", text.empty() ? "" : "; ", i + 1, counts[i].item.title);
  if (number > kMostNamed)
    return fmt::format("{} of the {} tests, which the remarks below name", number, counts.size());
  return text.empty() ? "none" : text;
}

void add_tests(report::Page& page, const std::vector<TestCount>& counts) {
  page.heading("Tests", 2, "tests");
  page.paragraph("Tests that nobody passes: " +
                 named(counts, [](const TestCount& count) { return count.right == 0; }) + ".");
  page.paragraph("Tests that nobody fails: " +
                 named(counts, [](const TestCount& count) { return count.right == count.judged; }) +
                 ".");
  report::Table table{"Numbers are those of the matrix below.",
                      {{"No.", true}, {"Test"}, {"Right", true}, {"of", true}, {"Remark"}},
                      {}};
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const TestCount& count = counts[i];
    const bool nobody = count.right == 0, everybody = count.right == count.judged;
    table.rows.push_back({{std::to_string(i + 1)},
                          {count.item.title + (count.item.hidden ? " (hidden)" : "")},
                          {std::to_string(count.right)},
                          {std::to_string(count.judged)},
                          {nobody      ? "nobody passes: is it fair?"
                           : everybody ? "nobody fails: is it needed?"
                                       : "",
                           "", nobody ? Look::kBad : Look::kMuted}});
  }
  page.table(table);
}

void add_slips(report::Page& page, const SlipTally& tally) {
  constexpr std::size_t kNamed = 5;
  page.heading("The slips made most", 2, "slips");
  const auto slips = tally.made_most();
  if (slips.empty()) return page.paragraph("No failing test names a slip.", Look::kMuted);
  report::Table table{!tally.has_known()
                          ? "A slip is what a failing test names as likely. After tumble audit, "
                            "slips are recognised by the tests that they fail."
                          : "A slip is recognised by the tests that fail for it and by "
                            "what their stories name.",
                      {{"Submissions", true}, {"Slip"}, {"Made by"}},
                      {}};
  for (const SlipCount& slip : slips) {
    std::string who;
    for (std::size_t i = 0; i < std::min(kNamed, slip.names.size()); ++i)
      who += (i == 0 ? "" : ", ") + plain_name(slip.names[i]);
    if (slip.names.size() > kNamed) who += fmt::format(" and {} more", slip.names.size() - kNamed);
    table.rows.push_back(
        {{std::to_string(slip.names.size())}, {slip.slip}, {who, "", Look::kMuted}});
  }
  page.table(table);
}

void add_standings(report::Page& page, const std::vector<Standing>& standings) {
  if (standings.empty()) return;
  page.heading("Points by the course's rules", 2, "rules");
  report::Table table{"", {{"Student"}, {"Before", true}, {"After", true}, {"Why"}}, {}};
  const auto points = [](const std::optional<double>& value) {
    return Cell{value ? points_text(*value) : "none", "", value ? Look::kPlain : Look::kWarning};
  };
  for (const Standing& standing : standings)
    table.rows.push_back({{plain_name(standing.person.name)},
                          points(standing.before),
                          points(standing.after),
                          {standing.why, "", standing.after ? Look::kMuted : Look::kWarning}});
  page.table(table);
}

Cell mark_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::kRight: return {"+", "", Look::kGood};
    case Verdict::kWrong: return {"x", "", Look::kBad};
    case Verdict::kNotAttempted: return {"o", "", Look::kMuted};
    case Verdict::kCrashed: return {"!", "", Look::kBad};
    case Verdict::kOutOfResources: return {"t", "", Look::kWarning};
    default: return {"?", "", Look::kWarning};
  }
}

// A class of some thousand students makes a page that no browser shows: the gradebook has them all.
constexpr std::size_t kMostInMatrix = 2000;

// A block of the matrix: of `last` - `first` tests, so that it fits a page.
report::Table matrix_of(const std::vector<Grade>& grades, const std::vector<TestCount>& counts,
                        std::size_t first, std::size_t last) {
  report::Table table{last == first + 1 ? fmt::format("Test {}", last)
                                        : fmt::format("Tests {} to {}", first + 1, last),
                      {{"Submission"}, {"Points", true}},
                      {}};
  for (std::size_t i = first; i < last; ++i) table.columns.push_back({std::to_string(i + 1)});
  for (const Grade& grade : grades) {
    if (table.rows.size() == kMostInMatrix) break;
    std::map<std::string, Verdict> verdicts;
    if (grade.state == GradeState::kJudged)
      grade.each_verdict(
          [&](const RubricItem& item, Verdict verdict) { verdicts[item.test] = verdict; });
    std::vector<Cell> row = {{plain_name(grade.name), link_of(grade)},
                             {grade.has_score() ? points_text(grade.score) : "none"}};
    for (std::size_t i = first; i < last; ++i) {
      const auto it = verdicts.find(counts[i].item.test);
      row.push_back(it == verdicts.end() ? Cell{""} : mark_of(it->second));
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

void add_matrix(report::Page& page, const std::vector<Grade>& grades,
                const std::vector<TestCount>& counts) {
  constexpr std::size_t kMostOfBlock = 25;  // tests, as a page has room for
  const std::size_t blocks = (counts.size() + kMostOfBlock - 1) / kMostOfBlock,
                    each = blocks == 0 ? 1 : (counts.size() + blocks - 1) / blocks;
  page.heading("Tests by submissions", 2, "matrix");
  page.paragraph(
      "+ right, x wrong, o not attempted, ! crashed, t out of time or memory, ? no final verdict; "
      "nothing: it does not compile",
      Look::kMuted);
  if (grades.size() > kMostInMatrix)
    page.paragraph(fmt::format("The first {} of {} submissions.", kMostInMatrix, grades.size()),
                   Look::kMuted);
  for (std::size_t first = 0; first < counts.size(); first += each)
    page.table(matrix_of(grades, counts, first, std::min(counts.size(), first + each)));
}

std::string line_of(const std::vector<std::string>& lines, std::size_t number) {
  if (number == 0 || number > lines.size()) return "";
  std::string text = lines[number - 1], indented;
  const auto first = std::min(text.find_first_not_of(' '), text.size());
  for (std::size_t i = 0; i < first; ++i) indented += "\u00a0";  // cells drop spaces
  return indented + plain_name(text.substr(first));
}

std::string pair_id(const SimilarPair& pair) { return fmt::format("pair-{}-{}", pair.a, pair.b); }

void add_pair(report::Page& page, const NamedSource& a, const NamedSource& b,
              const SimilarPair& pair) {
  constexpr std::size_t kMostRuns = 6, kMostLines = 40;
  const auto lines_of = [](const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) lines.push_back(line);
    return lines;
  };
  const auto left = lines_of(a.text), right = lines_of(b.text);
  page.heading(fmt::format("{} and {}: {} %", plain_name(a.name), plain_name(b.name), pair.percent),
               3, pair_id(pair));
  for (std::size_t r = 0; r < std::min(kMostRuns, pair.runs.size()); ++r) {
    const SimilarRun& run = pair.runs[r];
    report::Table table{fmt::format("{} words and signs alike in a row", run.tokens),
                        {{"", true}, {plain_name(a.name)}, {"", true}, {plain_name(b.name)}},
                        {}};
    const std::size_t length = std::max(run.a_last - run.a_first, run.b_last - run.b_first) + 1;
    const auto cell = [](std::size_t number, std::size_t last) {
      return Cell{number > last ? "" : std::to_string(number), "", Look::kMuted};
    };
    for (std::size_t i = 0; i < std::min(length, kMostLines); ++i)
      table.rows.push_back({cell(run.a_first + i, run.a_last),
                            {run.a_first + i > run.a_last ? "" : line_of(left, run.a_first + i)},
                            cell(run.b_first + i, run.b_last),
                            {run.b_first + i > run.b_last ? "" : line_of(right, run.b_first + i)}});
    page.table(table);
    if (length > kMostLines)
      page.paragraph(fmt::format("{} of this part {} not shown: it ends in line {} of {} and in "
                                 "line {} of {}.",
                                 counted(length - kMostLines, "more line"),
                                 length - kMostLines == 1 ? "is" : "are", run.a_last,
                                 plain_name(a.name), run.b_last, plain_name(b.name)),
                     Look::kMuted);
  }
  if (pair.runs.size() > kMostRuns)
    page.paragraph(counted(pair.runs.size() - kMostRuns, "more part") +
                       " that are alike, all shorter, are not shown.",
                   Look::kMuted);
}

}  // namespace

report::Page class_page(const modules::ModuleKind& kind, const std::vector<Grade>& grades,
                        const SlipTally& slips, const std::vector<Standing>& standings) {
  report::Page page(title_of(kind, "the class"), counted(grades.size(), "submission"));
  add_links(page);
  page.links({{"Points", "#points"},
              {"Slips", "#slips"},
              {"Tests", "#tests"},
              {"Tests by submissions", "#matrix"}});
  const auto counts = test_counts(grades);
  add_histogram(page, grades);
  add_slips(page, slips);
  add_tests(page, counts);
  add_standings(page, standings);
  add_matrix(page, grades, counts);
  page.record(version_in_words(kProgramVersion));
  return page;
}

report::Page pictures_page(const modules::ModuleKind& kind, const std::vector<Grade>& grades,
                           const fs::path& out) {
  constexpr std::size_t kMost = 200;  // of a scene: a browser shows them at once
  report::Page page(title_of(kind, "pictures"), "those farthest from the reference first");
  add_links(page);
  struct Shown {
    double distance;
    const Grade* grade;
    fs::path picture;
  };
  std::map<std::string, std::vector<Shown>> scenes;
  for (const Grade& grade : grades)
    for (const SceneMedia& media : grade.media) {
      if (media.picture.empty()) continue;
      const fs::path picture = fs::path(grade.folder) / "media" / media.picture;
      scenes[media.title].push_back(
          {render::distance_of_views(render::read_png(out / picture)), &grade, picture});
    }
  if (scenes.empty())
    page.paragraph("No pictures were made: run grade without --no-media.", Look::kMuted);
  for (auto& [title, shown] : scenes) {
    std::stable_sort(shown.begin(), shown.end(),
                     [](const Shown& a, const Shown& b) { return a.distance > b.distance; });
    page.heading(title);
    std::vector<report::Figure> figures;
    for (const Shown& one : shown) {
      if (figures.size() == kMost) break;
      figures.push_back(
          {one.picture, "",
           fmt::format("{}: {:.1f} of 255", plain_name(one.grade->name), one.distance), ""});
    }
    if (shown.size() > kMost)
      page.paragraph(fmt::format("The {} farthest of {}.", kMost, shown.size()), Look::kMuted);
    page.figures(figures);
  }
  page.paragraph(
      "Each number is the root mean square difference of colours between the submission's half of "
      "a picture and the reference's, without the words at the edges: 0 where both are drawn "
      "alike.",
      Look::kMuted);
  page.record(version_in_words(kProgramVersion));
  return page;
}

report::Page similar_page(const modules::ModuleKind& kind, const std::vector<NamedSource>& sources,
                          const std::vector<SimilarPair>& pairs, const std::string& problem) {
  report::Page page(title_of(kind, "similar submissions"),
                    "compared by sim_c++, without the lines of the starter");
  add_links(page);
  if (!problem.empty()) page.paragraph(problem, Look::kWarning);
  page.paragraph(
      "A small assignment has few right answers: what is alike here is a reason to look and to "
      "ask, "
      "and no proof of anything.");
  if (sources.size() > kMostForEveryPair)
    page.paragraph(
        fmt::format("With more than {} submissions each is listed with those that it is most like, "
                    "not with every other that it is like.",
                    kMostForEveryPair),
        Look::kMuted);
  constexpr std::size_t kMost = 100;
  report::Table table{"", {{"Submission"}, {"and"}, {"Alike", true}}, {}};
  for (const SimilarPair& pair : pairs) {
    if (table.rows.size() == kMost) break;
    table.rows.push_back(
        {{plain_name(sources[pair.a].name)},
         {plain_name(sources[pair.b].name)},
         {fmt::format("{} %", pair.percent), pair.runs.empty() ? "" : "#" + pair_id(pair)}});
  }
  if (pairs.empty()) {
    if (problem.empty()) page.paragraph("No two of them are alike.", Look::kMuted);
    page.record(version_in_words(kProgramVersion));
    return page;
  }
  page.heading(counted(pairs.size(), "pair"));
  if (pairs.size() > kMost)
    page.paragraph(fmt::format("The first {} are listed.", kMost), Look::kMuted);
  page.table(table);
  page.heading("Side by side");
  const auto beside = std::count_if(pairs.begin(), pairs.end(),
                                    [](const SimilarPair& pair) { return !pair.runs.empty(); });
  if (beside > 0 && static_cast<std::size_t>(beside) < pairs.size())
    page.paragraph(beside == 1 ? std::string("Only the pair that is most alike is shown.")
                               : fmt::format("Only the {} that are most alike are shown.",
                                             counted(static_cast<std::size_t>(beside), "pair")),
                   Look::kMuted);
  for (const SimilarPair& pair : pairs)
    if (!pair.runs.empty()) add_pair(page, sources[pair.a], sources[pair.b], pair);
  page.record(version_in_words(kProgramVersion));
  return page;
}

}  // namespace tumble::grading
