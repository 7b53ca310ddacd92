// tumble demo: the whole workflow, from submissions to pages, on submissions with known scores.
#include <algorithm>
#include <cstdio>
#include <memory>

#include <fmt/format.h>

#include "framework/cli/engines_all.h"
#include "framework/cli/record.h"
#include "framework/cli/verb.h"
#include "framework/core/files.h"
#include "framework/grading/grades/grade.h"
#include "framework/grading/grades/grade_many.h"
#include "framework/grading/grades/grade_pages.h"
#include "framework/grading/sandbox/protection.h"
#include "framework/report/html.h"
#include "framework/report/player.h"

namespace tumble::cli {
namespace {

namespace fs = std::filesystem;
using grading::Grade;

constexpr const char* kPrivateFolder = "solutions_private";
constexpr const char* kEngines = "engines";  // folder of the comparison
// three.js once for all pages that play a run: the report is read as a whole
constexpr const char* kThree = "three.js";

struct DemoOptions {
  std::string out = "out/demo";
  int jobs = 2;
  int scenes = 0;  // of each assignment; 0: all
};

/// One assignment as the demo grades it: the reference, the untouched starter, a flawed submission.
struct Graded {
  const modules::ModuleKind* kind;
  std::vector<Grade> grades;  // in the order of submissions_of
};
enum { kReference, kStarter, kFlawed };
// The one whose scenes are drawn, beside the reference: the reference beside itself and a stub
// that does not move show nothing new.
constexpr const char* kDrawn = "flawed";

grading::FoundSubmissions submissions_of(const Context& context, const modules::ModuleKind& kind) {
  const fs::path file = kind.folder + ".cpp", ours = context.root / kPrivateFolder / kind.folder;
  return {ours,
          {{"reference", ours / file, "", {}},
           {"starter", context.root / "assignments" / kind.folder / file, "", {}},
           {kDrawn, ours / "flawed_submission" / file, "", {}}},
          {}};
}

void tell_progress(const std::string& id, const grading::GradeProgress& progress) {
  const std::string left =
      progress.left_s < 0 ? "" : fmt::format(", about {:.0f} s left", progress.left_s);
  if (!progress.finished.empty())
    fmt::print(stderr, "tumble: {} {}: {} of {} graded{}\n", id, progress.finished, progress.done,
               progress.total, left);
}

// Difference from the expected result of each submission, for any assignment; empty where there is
// none.
std::string surprise(int which, const Grade& grade) {
  if (!grade.is_final()) return "the grader failed";
  if (!grade.faults.empty()) return "the grader failed, at " + grade.faults.front();
  const bool fine = which == kReference ? grade.score == grade.possible
                    : which == kStarter ? grade.score == 0.0
                                        : grade.score > 0.0 && grade.score < grade.possible;
  if (fine) return "";
  return which == kReference ? "expected all points"
         : which == kStarter ? "expected no points"
                             : "expected some of the points";
}

void add_scores(report::Page& page, const std::vector<Graded>& all) {
  report::Table table;
  table.columns = {{"Assignment"},
                   {"Submission"},
                   {"Score", true},
                   {"of", true},
                   {"Right", true},
                   {"Wrong", true},
                   {"Not attempted", true},
                   {"Crashed", true},
                   {"Out of time or memory", true}};
  for (const Graded& graded : all)
    for (const Grade& grade : graded.grades)
      table.rows.push_back(
          {{graded.kind->id + " " + graded.kind->title},
           {grade.name, report::link_to(fs::path(graded.kind->id) / grade.folder / "index.html")},
           {fmt::format("{:g}", grade.score)},
           {fmt::format("{:g}", grade.possible)},
           {std::to_string(grade.count(grading::Verdict::kRight))},
           {std::to_string(grade.count(grading::Verdict::kWrong))},
           {std::to_string(grade.count(grading::Verdict::kNotAttempted))},
           {std::to_string(grade.count(grading::Verdict::kCrashed))},
           {std::to_string(grade.count(grading::Verdict::kOutOfResources))}});
  page.table(table);
}

// Every scene in small, with the pages that say more.
void add_scenes(report::Page& page, const Graded& graded) {
  const fs::path folder = graded.kind->id;
  const Grade& flawed = graded.grades[kFlawed];
  page.heading(fmt::format("{} {}: the flawed submission has {}", graded.kind->id,
                           graded.kind->title, grading::summary_of(flawed)),
               2, "scenes-" + graded.kind->id);
  page.links(
      {{"What it should mend first", report::link_to(folder / flawed.folder / "index.html")},
       {"The same for its student", report::link_to(folder / flawed.folder / "student.html")},
       {"All submissions", report::link_to(folder / "index.html")},
       {"Gradebook", report::link_to(folder / "gradebook.csv")}});
  std::vector<report::Figure> figures;
  for (const grading::SceneMedia& scene : flawed.media) {
    const fs::path media = folder / flawed.folder / "media";
    report::Figure figure;
    if (!scene.picture.empty()) figure.picture = media / scene.picture;
    if (!scene.video.empty()) figure.video = media / scene.video;
    figure.caption = scene.title;
    if (!scene.page.empty()) figure.link = report::link_to(media / scene.page);
    figures.push_back(figure);
  }
  page.thumbnails(figures);
}

void write_index(const Context& context, const std::vector<Graded>& all,
                 const DemoOptions& options) {
  const fs::path out = fs::absolute(options.out);
  const std::string scenes = options.scenes > 1
                                 ? fmt::format("at most {} scenes of each", options.scenes)
                             : options.scenes == 1 ? "the first scene of each"
                                                   : "every scene";
  report::Page page("Tumble", "three submissions of each assignment, graded; " + scenes +
                                  ", submission beside reference");
  std::vector<report::Cell> links{{"Scores", "#scores"}};
  for (const Graded& graded : all)
    links.push_back({"Scenes of " + graded.kind->id, "#scenes-" + graded.kind->id});
  links.push_back(
      {"Three engines on the paper's scenes", report::link_to(fs::path(kEngines) / "index.html")});
  page.links(links);
  page.heading("Scores", 2, "scores");
  page.paragraph(
      "The reference solution, the stub as students get it, and a submission with mistakes that "
      "students make. Each was compiled and run in a sandbox (" +
      grading::protection_in_words(grading::chosen_sandbox()) +
      "), "
      "and judged from outside it. The names link to the TA's page.");
  add_scores(page, all);
  for (const Graded& graded : all) add_scenes(page, graded);
  page.record(record_of(context));
  page.write(out / "index.html");
}

// @return the number of unexpected scores
int print_table(const std::vector<Graded>& all) {
  int surprises = 0;
  constexpr const char* kRow = "{:<19} {:<10} {:>5} {:>4} {:>6} {:>6} {:>14} {:>8} {:>12}{}\n";
  fmt::print(kRow, "assignment", "submission", "score", "of", "right", "wrong", "not attempted",
             "crashed", "out of time", "");
  for (const Graded& graded : all) {
    for (std::size_t i = 0; i < graded.grades.size(); ++i) {
      const Grade& grade = graded.grades[i];
      const std::string wrong = surprise(static_cast<int>(i), grade);
      surprises += wrong.empty() ? 0 : 1;
      fmt::print(
          kRow, graded.kind->id + " " + graded.kind->title, grade.name,
          fmt::format("{:g}", grade.score), fmt::format("{:g}", grade.possible),
          grade.count(grading::Verdict::kRight), grade.count(grading::Verdict::kWrong),
          grade.count(grading::Verdict::kNotAttempted), grade.count(grading::Verdict::kCrashed),
          grade.count(grading::Verdict::kOutOfResources), wrong.empty() ? "" : "   <- " + wrong);
    }
  }
  return surprises;
}

void demo(Context& context, const DemoOptions& options) {
  if (!fs::exists(context.root / kPrivateFolder))
    throw UserError("tumble demo", "grades the reference solutions, and this tree has none",
                    "It is the instructor's command; a student starts with: ./tumble check a1");
  const fs::path out = fs::absolute(options.out);
  grading::Course course{context.root, context.build, &context.registry, context.command_line};
  report::write_three(out / kThree);
  std::vector<Graded> all;
  for (const modules::ModuleKind* kind : context.registry.all()) {
    grading::GradeOptions grade;
    grade.jobs = options.jobs;
    grade.media_of = {kDrawn};
    if (options.scenes > 0) {
      grade.scenes = grading::scenes_of(course, kind->id);
      if (grade.scenes.size() > static_cast<std::size_t>(options.scenes))
        grade.scenes.resize(static_cast<std::size_t>(options.scenes));
    }
    grade.media_options.three_file = fs::path("../../..") / kThree;  // from aN/NAME/media
    // it shows the grader, and gives nobody a grade
    grade.accepted_sandbox = grading::traits_of(grading::chosen_sandbox()).name;
    grade.progress = [kind](const grading::GradeProgress& progress) {
      tell_progress(kind->id, progress);
    };
    all.push_back(
        {kind, grading::grade_submissions(course, kind->id, submissions_of(context, *kind),
                                          out / kind->id, grade)});
  }
  EnginesWords engines;
  engines.out = (out / kEngines).string();
  engines.three_file = fs::path("../..") / kThree;           // from engines/SCENE
  engines.small = engines.no_videos = engines.quiet = true;  // tumble engines makes the whole page
  engines_of_all(context, engines);
  write_index(context, all, options);
  const int surprises = print_table(all);
  fmt::print("{}\n", (out / "index.html").string());
  if (surprises > 0) {
    fmt::print(stderr,
               "tumble: {} of these scores differ from the expected ones: this is our bug, please "
               "report it\n",
               surprises);
    context.exit = ExitCode::kOurBug;
  }
}

}  // namespace

void add_demo(CLI::App& app, Context& context) {
  auto options = std::make_shared<DemoOptions>();
  Verb verb(app, "demo",
            "Grade three submissions of each assignment and draw every scene: the whole path on "
            "one page");
  verb.option("--out", options->out, "Folder of the report").shows_default();
  verb.option("--scenes", options->scenes,
              "Draw only the first N scenes of each assignment, by name; default all")
      .between(1, 1000);
  verb.option("--jobs", options->jobs, "Submissions graded at the same time")
      .between(1, 64)
      .shows_default();
  verb.runs([&context, options] { demo(context, *options); });
}

}  // namespace tumble::cli
