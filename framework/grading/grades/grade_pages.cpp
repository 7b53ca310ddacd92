#include "framework/grading/grades/grade_pages.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <set>
#include <sstream>

#include <fmt/format.h>

#include "framework/core/text.h"
#include "framework/core/version.h"
#include "framework/grading/verdicts/plain_text.h"
#include "framework/grading/grades/scoring.h"
#include "framework/trajectory/record.h"

namespace tumble::grading {
namespace {

using report::Cell;
using report::Look;

Look look_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::kRight: return Look::kGood;
    case Verdict::kNotAttempted: return Look::kMuted;
    case Verdict::kGraderFault:
    case Verdict::kMachineBusy: return Look::kWarning;
    default: return Look::kBad;
  }
}

std::size_t cut_off(const Grade& grade) {
  return static_cast<std::size_t>(
      std::count_if(grade.tests.begin(), grade.tests.end(),
                    [](const ScoredTest& test) { return is_cut_off(test.result); }));
}

void add_tiles(report::Page& page, const Grade& grade) {
  std::vector<std::pair<std::string, Cell>> tiles;
  const Look look = !grade.is_final()               ? Look::kWarning
                    : grade.score >= grade.possible ? Look::kGood
                                                    : Look::kPlain;
  tiles.push_back({"of " + points_text(grade.possible) + " points",
                   {grade.has_score() ? points_text(grade.score) : "none", "", look}});
  if (grade.state != GradeState::kJudged) return page.tiles(tiles);
  constexpr std::array kShown = {
      Verdict::kRight,          Verdict::kWrong,       Verdict::kNotAttempted, Verdict::kCrashed,
      Verdict::kOutOfResources, Verdict::kGraderFault, Verdict::kMachineBusy};
  for (const Verdict verdict : kShown)
    if (const std::size_t n =
            grade.count(verdict) - (verdict == Verdict::kOutOfResources ? cut_off(grade) : 0);
        n > 0)
      tiles.push_back({words(verdict), {std::to_string(n), "", look_of(verdict)}});
  if (const std::size_t n = cut_off(grade); n > 0)
    tiles.push_back({"not run", {std::to_string(n), "", Look::kMuted}});
  page.tiles(tiles);
}

report::Table table_of_tests(const Grade& grade, const std::vector<const ScoredTest*>& tests) {
  report::Table table;
  table.columns = {{"Test"}, {"Verdict"}, {"Points", true}, {"of", true}, {""}};
  for (const ScoredTest* test : tests) {
    const Verdict verdict = test->result.verdict;
    const bool is_judged = grade.state == GradeState::kJudged && !is_cut_off(test->result);
    const std::string link = has_story_in_page(*test) && grade.state == GradeState::kJudged
                                 ? "#" + anchor_of_story(test->item.test)
                                 : "";
    table.rows.push_back(
        {{test->item.title, link, Look::kPlain, anchor_of_row(test->item.test)},
         {is_judged ? words(verdict) : "not run", "", is_judged ? look_of(verdict) : Look::kMuted},
         {points_text(test->score)},
         {points_text(test->item.points), "", Look::kMuted},
         {test->item.hidden ? "hidden" : "", "", Look::kMuted}});
  }
  return table;
}

// What is right is folded: it needs nobody's eyes.
void add_level(report::Page& page, const Grade& grade, const std::string& level) {
  double score = 0.0, possible = 0.0, right_points = 0.0;
  std::vector<const ScoredTest*> right, other;
  for (const ScoredTest& test : grade.tests) {
    if (test.item.level != level) continue;
    score += test.score;
    possible += test.item.points;
    const bool is_right =
        grade.state == GradeState::kJudged && test.result.verdict == Verdict::kRight;
    if (is_right) right_points += test.score;
    (is_right ? right : other).push_back(&test);
  }
  if (right.empty() && other.empty()) return;
  std::string name = level.empty() ? "Without points" : level;
  name[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(name[0])));
  page.heading(fmt::format("{}: {} of {}", name, points_text(score), points_text(possible)), 3);
  if (!other.empty()) page.table(table_of_tests(grade, other));
  if (right.empty()) return;
  page.begin(report::Part::kFold, fmt::format("{} right: {} points", counted(right.size(), "test"),
                                              points_text(right_points)));
  page.table(table_of_tests(grade, right));
  page.end();
}

// The verdict that keeps a grade from being final.
Verdict unfinished_verdict(const Grade& grade) {
  return grade.count(Verdict::kGraderFault) > 0 ? Verdict::kGraderFault : Verdict::kMachineBusy;
}

void add_changes(report::Page& page, const Grade& grade) {
  if (grade.changes.empty()) return;
  report::Table table;
  table.columns = {{"Test"}, {"Before"}, {"Now"}, {"Because"}};
  for (const TestChange& c : grade.changes)
    table.rows.push_back(
        {{c.title}, {c.before, "", Look::kMuted}, {c.after}, {c.reason, "", Look::kMuted}});
  page.heading("What the last regrade changed", 2, "changes");
  page.table(table);
}

std::string numbers_of(const engines::CheckResult& c) {
  std::string unit = c.unit.empty() ? "" : ' ' + c.unit;
  for (std::size_t at = 0; (at = unit.find(' ', at)) != unit.npos;)
    unit.replace(at, 1, "\u00a0");  // stays with its number
  const std::string reached = std::isfinite(c.value) ? three_digits(c.value) + unit : "no number";
  const std::string threshold = three_digits(c.threshold) + unit;
  if (engines::is_off_by(c)) return fmt::format("off by {}, allowed {}", reached, threshold);
  return fmt::format("{}, allowed at {} {}", reached, c.at_least ? "least" : "most", threshold);
}

std::string title_of_check(std::string kind) {
  std::replace(kind.begin(), kind.end(), '_', ' ');
  if (!kind.empty()) kind[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(kind[0])));
  return kind;
}

// A fault's subject is a name in quotation marks, as sentences have it; a cell needs none.
std::string subject_of(const engines::CheckResult& c) {
  const std::string& name = c.subject;
  const bool is_quoted = name.size() > 2 && name.front() == '\'' && name.back() == '\'' &&
                         name.find('\'', 1) == name.size() - 1;
  return is_quoted ? name.substr(1, name.size() - 2) : name;
}

// The remedy of a fault is that of a scene which somebody writes: a smaller step, another method.
// Where a law is wrong, it is the law that is to be mended.
std::string reason_of(const engines::CheckResult& c, bool has_causes) {
  const std::size_t remedy = has_causes ? c.why.find(". Likely remedy: ") : c.why.npos;
  if (remedy == c.why.npos) return c.why;
  return c.why.substr(0, remedy) + ". Mend first what stands at the head of this page";
}

// The right ones are folded.
void add_checks(report::Page& page, const SceneMedia& scene, bool passed, bool has_causes) {
  report::Table table;
  table.columns = {{"Judged by"},
                   {"Of"},
                   {"Verdict"},
                   {"Reached and allowed"},
                   {passed ? "Because" : "Where, and because"}};
  for (const auto& c : scene.checks)
    if (c.passed == passed)
      table.rows.push_back(
          {{title_of_check(c.kind)},
           {subject_of(c)},
           {c.passed ? "right" : "wrong", "", c.passed ? Look::kGood : Look::kBad},
           {numbers_of(c)},
           {c.passed ? sentence(c.why) : sentences(c.detail, reason_of(c, has_causes)), "",
            Look::kMuted}});
  if (table.rows.empty()) return;
  if (!passed) return page.table(table);
  page.begin(report::Part::kFold, counted(table.rows.size(), "number") + " right");
  page.table(table);
  page.end();
}

}  // namespace

std::string summary_of(const Grade& grade) {
  if (grade.is_held) return "no score until somebody decides";  // students read it, too
  switch (grade.state) {
    case GradeState::kNothingToCompile: return "nothing to compile";
    case GradeState::kDoesNotCompile: return "does not compile";
    case GradeState::kGraderFault: return "fault of the grader";
    case GradeState::kJudged: break;
  }
  return points_text(grade.score) + " of " + points_text(grade.possible) +
         (grade.is_final() ? ""
                           : ", not final: " + std::string(words(unfinished_verdict(grade))) +
                                 "; run the same command again");
}

void add_stories(report::Page& page, const Grade& grade, const PageView& view) {
  std::map<std::string, std::string> missing;  // story -> titles of its tests
  for (const ScoredTest& test : grade.tests) {
    if (test.result.verdict == Verdict::kNotAttempted)
      missing[test.result.story] += "\n    " + test.item.title;
    if (!has_story_in_page(test)) continue;
    page.heading(
        fmt::format("{}: {}", is_cut_off(test.result) ? "not run" : words(test.result.verdict),
                    test.item.title),
        3, anchor_of_story(test.item.test));
    std::string facts = test.item.test + (test.item.hidden ? " (hidden)" : "");
    if (test.result.calls > 0)
      facts += fmt::format(
          ": {}; {} {}", counted(static_cast<std::size_t>(test.result.calls), "call"),
          test.result.verdict == Verdict::kWrong ? "the first wrong answer follows one of"
                                                 : "the last one of",
          test.result.last_call);
    page.paragraph(facts, Look::kMuted);
    add_story(page, test.result.story, view);
  }
  if (missing.empty()) return;
  page.heading("not attempted", 3);
  std::string text;
  for (const auto& [story, titles] : missing) text += (text.empty() ? "" : "\n") + story + titles;
  add_story(page, text, view);
}

// Its numbers are right, or it has none, and it ran to its end.
bool is_right(const SceneMedia& scene) {
  return scene.story.empty() && std::all_of(scene.checks.begin(), scene.checks.end(),
                                            [](const auto& c) { return c.passed; });
}

void add_scene(report::Page& page, const SceneMedia& scene, const std::filesystem::path& folder,
               bool has_causes) {
  page.heading(scene.title, 3, anchor_of_scene(scene.scene));
  const auto wrong = std::count_if(scene.checks.begin(), scene.checks.end(),
                                   [](const auto& c) { return !c.passed; });
  if (!scene.story.empty()) {
    // The arguments of the call that ended it may fill a screen.
    const std::size_t line = std::min(scene.story.find('\n'), scene.story.size());
    page.paragraph(
        sentence((scene.attempted ? "The submission's run ended early: " : "Not attempted: ") +
                 plain_text(scene.story.substr(0, line))),
        scene.attempted ? Look::kBad : Look::kMuted);
    if (line < scene.story.size())
      page.fold("More about it", plain_text(scene.story.substr(line + 1)));
  } else if (wrong > 0)
    page.paragraph(fmt::format("{} of its {} numbers are wrong.", wrong, scene.checks.size()),
                   Look::kBad);
  else if (!scene.checks.empty())
    page.paragraph(scene.checks.size() == 1 ? "Its number is right."
                   : scene.checks.size() == 2
                       ? "Both of its numbers are right."
                       : fmt::format("All {} of its numbers are right.", scene.checks.size()),
                   Look::kGood);
  if (!scene.picture.empty() || !scene.video.empty()) {
    report::Figure figure;
    if (!scene.picture.empty()) figure.picture = folder / scene.picture;
    if (!scene.video.empty()) figure.video = folder / scene.video;
    figure.caption = scene.about;
    page.figures({figure});
  }
  if (!scene.page.empty())
    page.links(
        {{"Play the run: rotate it, step through it, see its curves and the first difference",
          report::link_to(folder / scene.page)}});
  add_checks(page, scene, false, has_causes);
  add_checks(page, scene, true, has_causes);
}

void add_media(report::Page& page, const std::vector<SceneMedia>& media,
               const std::filesystem::path& folder, bool has_causes) {
  const auto right = std::count_if(media.begin(), media.end(), is_right);
  // What is right is folded where something else is to be looked at.
  const bool folds = right > 0 && right < static_cast<std::ptrdiff_t>(media.size());
  for (const SceneMedia& scene : media)
    if (!folds || !is_right(scene)) add_scene(page, scene, folder, has_causes);
  if (!folds) return;
  page.begin(report::Part::kFold,
             right == 1 ? "1 scene is right" : fmt::format("{} scenes are right", right));
  for (const SceneMedia& scene : media)
    if (is_right(scene)) add_scene(page, scene, folder, has_causes);
  page.end();
}

void add_cost(report::Page& page, const CostSection& cost) {
  if (cost.scene.empty()) return;
  page.heading("What accuracy costs", 2, "cost");
  for (const CostLine& line : cost.lines) {
    page.paragraph(line.reading, line.is_wasteful    ? Look::kWarning
                                 : line.is_right     ? Look::kGood
                                 : line.is_attempted ? Look::kBad
                                                     : Look::kMuted);
    if (!line.more.empty()) page.fold("More about it", line.more);
  }
  if (std::none_of(cost.lines.begin(), cost.lines.end(),
                   [](const CostLine& line) { return line.is_attempted; }))
    return;
  for (const report::Plot& plot : cost.plots) page.plot(plot);
  for (const report::Table& table : cost.tables) page.table(table);
  page.paragraph(
      fmt::format("Measured on: {}. {} This part is for information and earns no points.",
                  cost.scene, cost.truth),
      Look::kMuted);
}

// Its code answers in the page, or why it does not.
static void add_bench(report::Page& page, const Grade& grade, const PageView& view) {
  if (view.bench.own.empty() && grade.no_page_code.empty()) return;
  page.heading("Try this file's code", 2, "try");
  if (view.bench.own.empty())
    return page.paragraph("It does not run in this page: " + plain_text(grade.no_page_code),
                          Look::kMuted);
  page.paragraph(
      "Change the numbers: every answer is computed here by this file's own functions, compiled "
      "for the page.");
  if (!view.no_right_law.empty()) {
    page.paragraph("The right law is not beside it:", Look::kWarning);
    page.preformatted(plain_text(view.no_right_law));
  }
  report::add_bench(page, view.bench);
}

void add_own_tests(report::Page& page, const OwnTestsGrade& own) {
  if (!own.is_there) return;
  page.heading(fmt::format("{}: {} of {}", kOwnTestsTitle, points_text(own.score),
                           points_text(own.possible)),
               2, "own-tests");
  page.preformatted(plain_text(own.story));
  if (own.names.empty()) return;
  page.begin(report::Part::kFold, "For the grader only: which slips and right solutions these are");
  std::vector<Cell> names;
  for (std::size_t at = 0; at < own.names.size();) {
    const std::size_t end = std::min(own.names.find("; ", at), own.names.size());
    names.push_back({plain_text(own.names.substr(at, end - at))});
    at = end + 2;
  }
  page.list(names);
  page.end();
}

report::Page submission_page(const modules::ModuleKind& kind, const Grade& grade,
                             const std::string& record, const PageView& view) {
  report::Page page(plain_name(grade.name),
                    fmt::format("{} ({}): {}", kind.title, kind.id, summary_of(grade)));
  std::vector<Cell> links;
  if (!view.is_alone) links.push_back({"All submissions", "../index.html"});
  if (!grade.causes.empty()) links.push_back({"Mend first", "#mend-first"});
  if (!view.bench.own.empty()) links.push_back({"Try the code", "#try"});
  links.push_back({"Tests", "#tests"});
  if (grade.own_tests.is_there) links.push_back({"Own tests", "#own-tests"});
  links.push_back({"Stories", "#stories"});
  if (!grade.cost.scene.empty()) links.push_back({"What accuracy costs", "#cost"});
  links.push_back({"Scenes", "#scenes"});
  if (!view.handout.empty()) links.push_back({"Handout", view.handout});
  page.links(links);
  add_tiles(page, grade);
  for (const std::string& note : grade.notes)
    page.paragraph("Note: " + plain_text(note), Look::kWarning);
  for (const std::string& fault : grade.faults)
    page.paragraph("For the grader only: " + plain_text(fault) + ". The next run makes it again.",
                   Look::kWarning);
  if (!grade.story.empty()) {
    page.heading(summary_of(grade));
    page.preformatted(plain_text(grade.story));
  }
  add_changes(page, grade);
  add_mend_first(page, grade, view);
  add_bench(page, grade, view);
  page.heading("Tests", 2, "tests");
  for (const char* level : {"basic", "intermediate", "advanced", ""}) add_level(page, grade, level);
  add_own_tests(page, grade.own_tests);
  page.heading("Stories", 2, "stories");
  if (const auto stories = std::count_if(grade.tests.begin(), grade.tests.end(), has_story_in_page);
      grade.state == GradeState::kJudged && grade.count(Verdict::kRight) < grade.tests.size()) {
    if (stories == 0) {
      page.paragraph("None: a function that is not written yet has no story.", Look::kMuted);
    } else {
      page.begin(report::Part::kFold,
                 fmt::format("{} of tests that are not right",
                             stories == 1 ? "1 story" : std::to_string(stories) + " stories"));
      add_stories(page, grade, view);
      page.end();
    }
  }
  if (grade.state != GradeState::kJudged)
    page.paragraph("No test ran.", Look::kMuted);
  else if (grade.count(Verdict::kRight) == grade.tests.size())
    page.paragraph("Every test is right.", Look::kGood);
  add_cost(page, grade.cost);
  page.heading("Scenes", 2, "scenes");
  if (grade.media.empty()) page.paragraph("No scene was run.", Look::kMuted);
  add_media(page, grade.media, "media", !grade.causes.empty());
  page.record(record);
  return page;
}

Grade for_student(Grade grade) {
  std::map<std::string, std::string> hidden;  // name -> the name that the student sees
  std::size_t number = 0;
  for (ScoredTest& test : grade.tests) {
    if (!test.item.hidden) continue;
    const std::string shown = fmt::format("Hidden.Test{}", ++number);
    hidden[test.item.test] = shown;
    test.item.title = fmt::format("Hidden test {}", number);
    test.item.test = shown;
    const Verdict verdict = test.result.verdict;
    test.result = {};
    test.result.test = test.item.test;
    test.result.verdict = verdict;
  }
  std::erase_if(grade.changes,
                [&](const TestChange& change) { return hidden.contains(change.test); });
  // a cause keeps its words, which say nothing of a test
  for (Cause& cause : grade.causes)
    for (auto* tests : {&cause.tests, &cause.following, &cause.not_run})
      for (std::string& test : *tests)
        if (const auto it = hidden.find(test); it != hidden.end()) test = it->second;
  grade.remarks.clear();
  grade.own_tests.names.clear();
  grade.faults.clear();
  return grade;
}

report::Page index_page(const modules::ModuleKind& kind, const std::vector<Grade>& grades,
                        bool has_class_pages) {
  report::Page page(
      kind.title + ": all submissions",
      fmt::format("{}, {} submission{}", kind.id, grades.size(), grades.size() == 1 ? "" : "s"));
  std::vector<Cell> links;
  if (has_class_pages)
    links = {{"The class", "class.html"},
             {"Pictures", "pictures.html"},
             {"Similar submissions", "similar.html"}};
  links.insert(links.end(), {{"gradebook.csv", "gradebook.csv"}, {"ledger.jsonl", "ledger.jsonl"}});
  page.links(links);
  std::vector<double> scores;
  std::size_t faults = 0, not_found = 0, held = 0;
  for (const Grade& grade : grades) {
    if (grade.has_score())
      scores.push_back(grade.score);
    else if (grade.is_held)
      ++held;
    else if (grade.is_final())
      ++not_found;
    else
      ++faults;
  }
  std::sort(scores.begin(), scores.end());
  if (!scores.empty()) {
    const double median = (scores[(scores.size() - 1) / 2] + scores[scores.size() / 2]) / 2.0;
    page.tiles({{"submissions", {std::to_string(grades.size())}},
                {"lowest", {points_text(scores.front())}},
                {"median", {points_text(median)}},
                {"highest", {points_text(scores.back())}}});
  }
  if (faults > 0)
    page.paragraph(
        fmt::format("{} without a final score: the grader failed, or the machine was too busy. Run "
                    "the same command again; their scores in the gradebook are blank.",
                    faults),
        Look::kWarning);
  if (not_found > 0)
    page.paragraph(fmt::format("{} without a file to grade: the table gives the reasons; their "
                               "scores in the gradebook are blank.",
                               not_found),
                   Look::kWarning);
  if (held > 0)
    page.paragraph(
        fmt::format("{} would be lower than in the ledger, and the result that has that score is "
                    "missing or does not count. tumble regrade shows them and asks; until then "
                    "their scores in the gradebook are blank.",
                    held),
        Look::kWarning);
  if (std::any_of(grades.begin(), grades.end(),
                  [](const Grade& grade) { return !grade.is_official; }))
    page.paragraph(
        "These are not official grades: the sandbox gave less protection than the policy asks for. "
        "Each row's remarks name it.",
        Look::kWarning);
  report::Table table;
  table.columns = {
      {"Submission"},  {"Score", true},         {"of", true},      {"Right", true},
      {"Wrong", true}, {"Not attempted", true}, {"Crashed", true}, {"Out of time or memory", true},
      {"Remarks"}};
  for (const Grade& grade : grades) {
    std::string remarks = grade.state == GradeState::kJudged ? "" : summary_of(grade);
    for (const std::string& note : grade.notes)
      remarks += (remarks.empty() ? "" : "; ") + plain_text(note);
    if (grade.state == GradeState::kNothingToCompile) remarks += ": " + plain_text(grade.story);
    for (const std::string& remark : grade.remarks)
      remarks += (remarks.empty() ? "" : "; ") + remark;
    if (!grade.change.empty()) remarks += (remarks.empty() ? "" : "; ") + grade.change;
    const auto number = [&](Verdict v) {
      const auto n = grade.state == GradeState::kJudged ? grade.count(v) : 0;
      return Cell{n == 0 ? "" : std::to_string(n), "", n == 0 ? Look::kMuted : look_of(v)};
    };
    table.rows.push_back({{plain_name(grade.name),
                           report::link_to(std::filesystem::path(grade.folder) / "index.html")},
                          {grade.has_score() ? points_text(grade.score) : "none", "",
                           grade.has_score() ? Look::kPlain : Look::kWarning},
                          {points_text(grade.possible), "", Look::kMuted},
                          number(Verdict::kRight),
                          number(Verdict::kWrong),
                          number(Verdict::kNotAttempted),
                          number(Verdict::kCrashed),
                          number(Verdict::kOutOfResources),
                          {remarks, "", Look::kMuted}});
  }
  page.table(table);
  // one, unless results of an earlier run in another one still count
  std::set<std::string> sandboxes;
  for (const Grade& grade : grades) sandboxes.insert(grade.sandbox);
  // without the command, which may name the number of jobs: pages are the same for any number
  page.record(fmt::format("sandbox {} · {}", fmt::join(sandboxes, ", "),
                          version_in_words(kProgramVersion)));
  return page;
}

}  // namespace tumble::grading
