// tumble grade a1 FOLDER: a folder of submissions, graded.
#include <cstdio>
#include <memory>

#include <fmt/format.h>

#include "framework/cli/grading_run.h"
#include "framework/grading/grades/grade.h"
#include "framework/grading/grades/grade_pages.h"
#include "framework/grading/verdicts/plain_text.h"

namespace tumble::cli {
namespace {

namespace fs = std::filesystem;

struct GradeWords {
  std::string id, folder, out;
  int jobs = default_jobs();
  double budget_s = grading::GradeOptions{}.budget_s;
  bool no_media = false;
  std::string sandbox, accepted_sandbox, policy;
};

void print_table(const std::vector<grading::Grade>& grades) {
  std::size_t widest = 10;
  for (const auto& grade : grades)
    widest = std::max(widest, grading::plain_name(grade.name).size());
  for (const auto& grade : grades) {
    fmt::print("{:<{}}  {}", grading::plain_name(grade.name), widest, grading::summary_of(grade));
    if (grade.taken_over) fmt::print("  (unchanged since the last run)");
    if (!grade.change.empty() && !grade.taken_over) fmt::print("  ({})", grade.change);
    for (const auto& note : grade.notes) fmt::print("  note: {}", grading::plain_text(note));
    if (grade.state == grading::GradeState::kNothingToCompile)
      fmt::print(": {}", grading::plain_text(grade.story));
    for (const auto& remark : grade.remarks) fmt::print("  remark: {}", remark);
    fmt::print("\n");
    if (grade.taken_over) continue;
    print_changes(grade.changes, widest + 4);
  }
}

// Nobody is asked here: `regrade` is the verb that may lower.
bool keep_scores(const std::string& id, const fs::path& out,
                 const std::vector<grading::Lowering>& lowerings) {
  for (const grading::Lowering& lowering : lowerings)
    fmt::print(stderr, "not lowered: {} ({})\n", grading::plain_name(lowering.name),
               lowering.change);
  fmt::print(stderr,
             "These files are the same as before, so their scores stay. To see why, and to decide: "
             "tumble regrade {} {}\n",
             id, out.string());
  return false;
}

void grade(Context& context, const GradeWords& words) {
  const fs::path out =
      words.out.empty() ? fs::path("out") / ("grade_" + words.id) : fs::path(words.out);
  GradingRequest request{words.id, words.folder, out, words.sandbox, words.policy, {}};
  request.options.jobs = words.jobs;
  request.options.budget_s = words.budget_s;
  request.options.media = !words.no_media;
  request.options.accepted_sandbox = words.accepted_sandbox;
  request.options.may_lower = [&](const std::vector<grading::Lowering>& lowerings) {
    return keep_scores(words.id, out, lowerings);
  };
  const auto grades = run_grading(context, request);
  print_table(grades);
  for (const auto& grade : grades)
    if (!grade.is_official) {
      fmt::print("These are not official grades: {}\n", grade.sandbox);
      break;
    }
  fmt::print("wrote {} and {}\n", (out / "index.html").string(), (out / "gradebook.csv").string());
}

}  // namespace

void add_grade(CLI::App& app, Context& context) {
  auto words = std::make_shared<GradeWords>();
  Verb verb(app, "grade", "Grade a folder of submissions: scores, stories, pictures, a gradebook");
  verb.option("assignment", words->id, "Which, e.g. a1").required().type_name("ID");
  verb.option("folder", words->folder, "One submission a sub-folder")
      .required()
      .type_name("FOLDER");
  verb.option("--out", words->out,
              "Where results go, a folder of their own; default out/grade_ID. A run that was ended "
              "goes on from there")
      .type_name("FOLDER");
  verb.option("--jobs", words->jobs, "Submissions at a time")
      .between(1, 256)
      .default_text("number of cores");
  verb.option(
          "--budget-s", words->budget_s,
          "Time for all tests of one submission together; tests after it are out of time, not run")
      .positive()
      .shows_default();
  verb.flag(
      "--no-media", words->no_media,
      "Without pictures, videos and pages that play: seconds instead of minutes a submission");
  verb.option(
          "--policy", words->policy,
          "Due dates, late days, penalties, attempts, groups and the roster; the gradebook then "
          "has points before and after, and why")
      .type_name("FILE.json");
  verb.option("--sandbox", words->sandbox,
              "namespaces, landlock or bare; default: the strongest that this machine has (tumble "
              "doctor)")
      .type_name("KIND");
  verb.option("--accept-sandbox", words->accepted_sandbox,
              "Grade in this kind although the policy for grades refuses it; every result says "
              "that it is not official")
      .type_name("KIND");
  verb.footer(
      "Exit: 0 all graded, 1 a submission without a file (its score is blank, with the reason), 2 "
      "something to repair, "
      "3 the grader failed or the machine was too busy somewhere (those scores are blank; run it "
      "again).\n"
      "Earlier results count where they are signed by this machine's key ($TUMBLE_GRADER_KEY, else "
      "~/.local/state/tumble/grader.key, made on first use).");
  verb.runs([&context, words] { grade(context, *words); });
}

}  // namespace tumble::cli
