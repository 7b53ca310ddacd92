// tumble class ACTION OUT: what a teaching assistant asks of a folder of results.
#include <algorithm>
#include <map>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "framework/cli/json_output.h"
#include "framework/cli/verb.h"
#include "framework/core/nearest_word.h"
#include "framework/core/version.h"
#include "framework/grading/course/handout_page.h"
#include "framework/grading/course/machine_key.h"
#include "framework/grading/grades/class_files.h"
#include "framework/grading/grades/class_facts.h"
#include "framework/grading/grades/grade_pages.h"
#include "framework/grading/grades/ledger.h"
#include "framework/grading/grades/output_folder.h"
#include "framework/grading/grades/scoring.h"
#include "framework/grading/verdicts/plain_text.h"
#include "framework/trajectory/record.h"

namespace tumble::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using grading::plain_name;

struct ClassWords {
  std::string action, out, name, test, to;
  bool json = false;
};

// The folder of results, and what is asked of it.
struct Class {
  Context& context;
  const ClassWords& words;
  grading::RunSettings settings;
};

std::vector<grading::GradeRecord> records_of(const Class& all) {
  return grading::records_of(
      all.words.out, all.settings.assignment, grading::machine_key().bytes,
      [](const std::string& sentence) { fmt::print(stderr, "{}\n", sentence); });
}

std::vector<grading::Grade> grades_of(const Class& all) {
  std::vector<grading::Grade> grades;
  for (auto& record : records_of(all)) grades.push_back(std::move(record.grade));
  return grades;
}

grading::Grade grade_called(const Class& all) {
  std::vector<std::string> known;
  for (grading::Grade& grade : grades_of(all)) {
    if (all.words.name == grade.name || all.words.name == grade.folder ||
        all.words.name == plain_name(grade.name))  // as it is shown
      return std::move(grade);
    known.push_back(grade.name);
  }
  throw UserError(
      plain_name(all.words.name),
      "is no submission in " + all.words.out + "." + did_you_mean(all.words.name, known),
      "For example: tumble class " + all.words.action + " OUT NAME");
}

// "1 call", "2 calls"
template <class Number>
std::string number_of(Number number, const std::string& what) {
  return fmt::format("{} {}{}", number, what, number == 1 ? "" : "s");
}

bool is_asked(const Class& all, const grading::ScoredTest& test) {
  return all.words.test.empty() ? test.result.verdict != grading::Verdict::kRight
                                : test.item.test == all.words.test;
}

void story_for_machines(const Class& all, const grading::Grade& grade) {
  Json tests = Json::array();
  for (const grading::ScoredTest& test : grade.tests)
    if (is_asked(all, test))
      tests.push_back({{"test", test.item.test},
                       {"title", test.item.title},
                       {"hidden", test.item.hidden},
                       {"verdict", grading::words(test.result.verdict)},
                       {"score", test.score},
                       {"points", test.item.points},
                       {"calls", test.result.calls},
                       {"last_call", test.result.last_call},
                       {"story", test.result.story}});
  print_json(all.context, {{"name", grade.name},
                           {"summary", grading::summary_of(grade)},
                           {"story", grade.story},
                           {"tests", std::move(tests)}});
}

// One test of one submission, with its whole story, also of a hidden test.
void story(const Class& all) {
  const grading::Grade grade = grade_called(all);
  std::vector<std::string> known;
  for (const grading::ScoredTest& test : grade.tests) known.push_back(test.item.test);
  if (all.words.json) return story_for_machines(all, grade);
  fmt::print("{}: {}\n\n", plain_name(grade.name), grading::summary_of(grade));
  const bool is_judged = grade.state == grading::GradeState::kJudged;
  if (!is_judged && all.words.test.empty())
    return fmt::print("{}\n", grading::plain_text(grade.story));
  std::size_t shown = 0;
  for (const grading::ScoredTest& test : grade.tests) {
    if (!is_asked(all, test)) continue;
    ++shown;
    fmt::print("{}{}\n{}: {}, {} of {} points, {}{}\n{}\n\n", test.item.test,
               test.item.hidden ? " (hidden)" : "", test.item.title,
               grading::words(test.result.verdict), grading::points_text(test.score),
               grading::points_text(test.item.points), number_of(test.result.calls, "call"),
               test.result.last_call.empty() ? "" : ", the last of " + test.result.last_call,
               grading::plain_text(test.result.story));
  }
  if (shown == 0 && !all.words.test.empty())
    throw UserError(
        plain_name(all.words.test),
        "is no test of " + all.settings.assignment + "." + did_you_mean(all.words.test, known),
        "Names are Suite.Name, as in its results.json.");
  if (shown == 0) fmt::print("Every test is right.\n");
}

// A page for the student: hidden tests keep their points, and neither name nor story.
void write_page(const Class& all, const grading::Grade& whole, const std::string& script,
                const fs::path& to) {
  const fs::path out = fs::weakly_canonical(fs::absolute(all.words.out));
  const grading::Grade grade = grading::for_student(whole);
  grading::PageView view;
  view.is_alone = true;
  const modules::ModuleKind& kind = all.context.registry.find(all.settings.assignment);
  const fs::path handout = out / grading::kHandoutPage;
  if (whole.has_handout && fs::exists(handout)) {
    view.handout = grading::kHandoutPage;
    view.handout_name = kind.folder;
  }
  view.bench = grading::bench_of(out / grade.folder, script);
  grading::submission_page(kind, grade, version_in_words(kProgramVersion), view)
      .write(to / "index.html");
  if (!view.handout.empty())  // a copy: what lies outside of OUT may be changed
    fs::copy_file(handout, to / view.handout, fs::copy_options::overwrite_existing);
  if (fs::is_directory(out / grade.folder / "media"))
    fs::copy(out / grade.folder / "media", to / "media",
             fs::copy_options::recursive | fs::copy_options::overwrite_existing);
}

// The page of one student, or without a name each one's in a folder of its own.
void page(const Class& all) {
  if (all.words.to.empty())
    throw UserError("class page", "has no place to write to", "Say --to FOLDER, outside of OUT.");
  const fs::path to = fs::weakly_canonical(fs::absolute(all.words.to)),
                 out = fs::weakly_canonical(fs::absolute(all.words.out));
  if (std::mismatch(out.begin(), out.end(), to.begin(), to.end()).first == out.end())
    throw UserError(to.string(), "is in the folder of results, which belongs to the grader",
                    "Name another folder.");
  const grading::Course course{all.context.root, all.context.build, &all.context.registry, ""};
  const std::string script = grading::page_script(course, all.settings.assignment);
  if (!all.words.name.empty()) {
    write_page(all, grade_called(all), script, to);
    return fmt::print("wrote {}\n", (to / "index.html").string());
  }
  const std::vector<grading::Grade> grades = grades_of(all);
  for (const grading::Grade& grade : grades) write_page(all, grade, script, to / grade.folder);
  fmt::print("wrote {}, each in a folder of {}\n", number_of(grades.size(), "page"), to.string());
}

void late(const Class& all) {
  const auto standings = grading::read_standings(fs::path(all.words.out) / grading::kStandingFile);
  Json told = Json::array();
  std::size_t count = 0;
  for (const grading::Standing& s : standings) {
    if (s.late_days == 0 && s.after && s.is_time_known) continue;
    ++count;
    if (all.words.json) {
      told.push_back({{"name", s.person.name},
                      {"submission", s.submission},
                      {"why", s.why},
                      {"late_days", s.late_days},
                      {"before", s.before ? Json(*s.before) : Json()},
                      {"after", s.after ? Json(*s.after) : Json()}});
      continue;
    }
    fmt::print("{}: {}{}\n", plain_name(s.person.name), s.why,
               s.before && s.after && *s.before != *s.after
                   ? fmt::format(" ({} -> {})", grading::points_text(*s.before),
                                 grading::points_text(*s.after))
                   : "");
  }
  if (all.words.json)
    return print_json(all.context, {{"of", standings.size()}, {"late", std::move(told)}});
  fmt::print("{} of {} late, without a score or without a time\n", count, standings.size());
}

// Groups of the roster, equal files, and files that are alike.
void together(const Class& all) {
  const bool json = all.words.json;
  Json told{{"groups", Json::array()}, {"equal", Json::array()}, {"alike", Json::array()}};
  const fs::path file = fs::path(all.words.out) / grading::kStandingFile;
  if (fs::exists(file)) {
    std::map<std::string, std::vector<std::string>> groups;
    for (const grading::Standing& s : grading::read_standings(file))
      if (!s.submission.empty()) groups[s.submission].push_back(plain_name(s.person.name));
    for (const auto& [submission, names] : groups)
      if (names.size() > 1 && json)
        told["groups"].push_back({{"submission", submission}, {"names", names}});
      else if (names.size() > 1)
        fmt::print("as a group: {} ({})\n", fmt::join(names, ", "), plain_name(submission));
  }
  for (auto& names : grading::equal_submissions(records_of(all))) {
    for (std::string& name : names) name = plain_name(name);
    if (json)
      told["equal"].push_back(names);
    else
      fmt::print("the same file: {}\n", fmt::join(names, ", "));
  }
  if (!grading::can_compare_sources()) {
    told["alike"] = Json();
    if (json) print_json(all.context, told);
    return fmt::print(json ? stderr : stdout,
                      "not compared further: sim_c++ is not installed (sudo apt-get install "
                      "similarity-tester)\n");
  }
  constexpr int kLeastPercent = 80;
  constexpr std::size_t kMostPairs = 40;
  const auto& kind = all.context.registry.find(all.settings.assignment);
  const auto sources = grading::sources_in(all.settings.submissions, kind);
  const grading::Course course{all.context.root, all.context.build, &all.context.registry, ""};
  std::vector<grading::SimilarPair> pairs;
  try {
    pairs = grading::similar_pairs(sources, grading::starter_of(course, kind), kLeastPercent, 0);
  } catch (const grading::SourcesNotCompared& error) {
    told["alike"] = Json();
    if (json) print_json(all.context, told);
    return fmt::print(json ? stderr : stdout, "not compared further: {}\n",
                      grading::plain_text(error.what()));
  }
  if (json) {
    for (const auto& pair : pairs)
      told["alike"].push_back(
          {{"percent", pair.percent}, {"names", {sources[pair.a].name, sources[pair.b].name}}});
    return print_json(all.context, told);
  }
  for (std::size_t i = 0; i < std::min(kMostPairs, pairs.size()); ++i)
    fmt::print("alike by {} %: {}, {}\n", pairs[i].percent, plain_name(sources[pairs[i].a].name),
               plain_name(sources[pairs[i].b].name));
  if (pairs.size() > kMostPairs)
    fmt::print("... and {} more pairs that are alike by at least {} %\n", pairs.size() - kMostPairs,
               kLeastPercent);
  if (!pairs.empty())
    fmt::print("side by side: {}\n", (fs::path(all.words.out) / "similar.html").string());
}

void slips(const Class& all) {
  const grading::Course course{all.context.root, all.context.build, &all.context.registry, ""};
  grading::SlipTally slips(grading::known_slips(course, all.settings.assignment));
  if (!slips.has_known())
    fmt::print(stderr,
               "slips are those that stories name; after tumble audit {} they are recognised by "
               "the tests that they fail\n",
               all.settings.assignment);
  for (const grading::Grade& grade : grades_of(all)) slips.add(grade);
  if (all.words.json) {
    Json told = Json::array();
    for (const grading::SlipCount& slip : slips.made_most())
      told.push_back({{"slip", slip.slip}, {"names", slip.names}});
    return print_json(all.context, {{"slips", std::move(told)}});
  }
  for (const grading::SlipCount& slip : slips.made_most())
    fmt::print("{:>5}  {}\n", slip.names.size(), slip.slip);
}

void changed(const Class& all) {
  const auto ledger = grading::read_ledger(fs::path(all.words.out) / grading::kLedgerFile);
  if (!ledger.fault.empty())
    throw UserError(all.words.out, "has a ledger that does not fit together: " + ledger.fault);
  Json told = Json::array();
  std::size_t count = 0;
  for (const grading::LedgerEntry& entry : ledger.entries) {
    if (entry.changes.empty() && entry.change.empty()) continue;
    ++count;
    if (all.words.json) {
      Json tests = Json::array();
      for (const grading::TestChange& c : entry.changes)
        tests.push_back(
            {{"test", c.test}, {"before", c.before}, {"after", c.after}, {"reason", c.reason}});
      told.push_back({{"name", entry.name}, {"change", entry.change}, {"tests", std::move(tests)}});
      continue;
    }
    fmt::print("{}: {}\n", entry.name,
               entry.change.empty() ? "the same score, by other tests" : entry.change);
    for (const grading::TestChange& c : entry.changes)
      fmt::print("  {}: {} -> {} ({})\n", c.test, c.before, c.after, c.reason);
  }
  if (all.words.json)
    return print_json(all.context,
                      {{"entries", ledger.entries.size()}, {"changed", std::move(told)}});
  fmt::print(
      "{} of the ledger's {} changed an earlier result\n", count,
      ledger.entries.size() == 1 ? "one entry" : fmt::format("{} entries", ledger.entries.size()));
}

const std::map<std::string, void (*)(const Class&)> kActions = {
    {"story", story}, {"page", page},       {"late", late},
    {"slips", slips}, {"changed", changed}, {"together", together}};

void run(Context& context, const ClassWords& words) {
  std::vector<std::string> known;
  for (const auto& [name, action] : kActions) known.push_back(name);
  const auto it = kActions.find(words.action);
  if (it == kActions.end())
    throw UserError("class " + words.action,
                    "there is no such action." + did_you_mean(words.action, known),
                    fmt::format("There are {}.", fmt::join(known, ", ")));
  if (words.json && words.action == "page")
    throw UserError("--json", "a page is for people",
                    "Say tumble class story OUT NAME --json, or leave it out.");
  it->second({context, words, grading::settings_of(words.out)});
}

}  // namespace

void add_class(CLI::App& app, Context& context) {
  auto words = std::make_shared<ClassWords>();
  Verb verb(app, "class",
            "What a graded class did: stories, late ones, slips, changes, equal files");
  verb.option("action", words->action, "story, page, late, together, slips or changed")
      .required()
      .type_name("ACTION");
  verb.option("results", words->out, "The folder that was given to grade as --out")
      .required()
      .type_name("OUT");
  verb.option("name", words->name, "For story and page: the submission; page without it: every one")
      .type_name("NAME");
  verb.option("test", words->test, "For story: Suite.Name; default: every test that is not right")
      .type_name("TEST");
  verb.option("--to", words->to, "For page: where it goes, outside of OUT").type_name("FOLDER");
  verb.flag("--json", words->json, "For machines; not of page");
  verb.footer(
      "story OUT NAME [TEST]    one test of one student with its whole story, also of a hidden "
      "one\n"
      "page OUT NAME --to DIR   the student's page, without names and stories of hidden tests\n"
      "page OUT --to DIR        every student's page, each in a folder of DIR\n"
      "late OUT                 who is late, without a score or without a time (needs --policy)\n"
      "together OUT             groups, equal files, and files that are alike\n"
      "slips OUT                the ten slips that the most students made\n"
      "changed OUT              who changed after a regrade, and by which test\n"
      "One student again: tumble regrade a1 OUT --only NAME --again\n"
      "Exit: 0 done, 2 something to repair.");
  verb.runs([&context, words] { run(context, *words); });
}

}  // namespace tumble::cli
