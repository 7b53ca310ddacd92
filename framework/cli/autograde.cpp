// tumble autograde a1 FOLDER --for PLATFORM: one submission, graded in the container of a platform.
#include <cstdlib>
#include <memory>

#include <fmt/format.h>

#include "framework/cli/verb.h"
#include "framework/core/files.h"
#include "framework/grading/grades/find_submissions.h"
#include "framework/grading/grades/grade_many.h"
#include "framework/grading/grades/scoring.h"
#include "framework/grading/platforms/formats.h"
#include "framework/grading/platforms/platform.h"

namespace tumble::cli {
namespace {

namespace fs = std::filesystem;
using grading::Platform;

struct AutogradeWords {
  std::string id, folder, platform, out, accepted_sandbox;
  double budget_s = grading::GradeOptions{}.budget_s;
  bool must_pass = false;
};

// The same way as in a class. No result of it is reused, so its key needs to last no longer.
grading::Grade grade_of(const grading::Course& course, const AutogradeWords& words) {
  const PrivateFolder results;
  ::setenv("TUMBLE_GRADER_KEY", (results.path() / "key").c_str(), 1);
  grading::GradeOptions options;
  options.media = options.cost = false;
  options.budget_s = words.budget_s;
  options.accepted_sandbox = words.accepted_sandbox;
  grading::Grade whole;
  options.each = [&](const grading::Grade& grade) { whole = grade; };
  const auto found = grading::find_submission(words.folder, course.registry->find(words.id));
  grading::grade_submissions(course, words.id, found, results.path() / "out", options);
  return whole;
}

void write_files(Platform platform, const grading::StudentView& view, const fs::path& out) {
  switch (platform) {
    case Platform::kGradescope: return write_whole(out, grading::gradescope_results(view));
    case Platform::kGithubClassroom:
      return write_whole(out, grading::github_classroom_result(view) + '\n');
    case Platform::kArtemis:
      for (const auto& [file, text] : grading::artemis_files(view)) write_whole(out / file, text);
      return;
    case Platform::kAutolab: return fmt::print("{}", grading::autolab_output(view));
  }
}

void autograde(Context& context, const AutogradeWords& words) {
  const Platform platform = grading::platform_named(words.platform);
  if (words.out.empty() && platform != Platform::kAutolab)
    throw UserError("--out", "is missing: " + words.platform + " reads a file",
                    "Name the file, or for artemis the folder, that it reads.");
  grading::Course course{context.root, context.build, &context.registry, context.command_line};
  course.public_only = !grading::has_hidden_tests(platform);
  const grading::Grade grade = grade_of(course, words);
  if (!grade.is_final()) {
    fmt::print(stderr, "tumble: the grader failed, so there is no result\n");
    // Elsewhere students may read what is printed.
    if (platform == Platform::kGradescope) fmt::print("{}", grading::instructors_story(grade));
    context.exit = ExitCode::kOurBug;
    return;
  }
  write_files(platform,
              grading::student_view(words.id, context.registry.find(words.id).title, grade),
              words.out);
  if (platform == Platform::kGradescope) fmt::print("{}", grading::instructors_story(grade));
  if (words.must_pass && grade.score < grade.possible) {
    fmt::print(stderr, "tumble: {} of {} points, and every point was expected\n",
               grading::points_text(grade.score), grading::points_text(grade.possible));
    context.exit = ExitCode::kCheckFailed;
  }
}

}  // namespace

void add_autograde(CLI::App& app, Context& context) {
  auto words = std::make_shared<AutogradeWords>();
  Verb verb(app, "autograde",
            "Grade one submission in the container of a platform, in the format that it reads");
  verb.option("assignment", words->id, "Which, e.g. a1").required().type_name("ID");
  verb.option("folder", words->folder, "What was handed in").required().type_name("FOLDER");
  verb.option("--for", words->platform, "gradescope, artemis, github-classroom or autolab")
      .required()
      .type_name("PLATFORM");
  verb.option("--out", words->out,
              "The file that the platform reads; for artemis its folder; autolab reads stdout")
      .type_name("PATH");
  verb.option(
          "--budget-s", words->budget_s,
          "Time for all tests of one submission together; tests after it are out of time, not run")
      .positive()
      .shows_default();
  verb.option("--accept-sandbox", words->accepted_sandbox,
              "Grade in this kind although the policy for grades refuses it; the result says that "
              "it is not official")
      .type_name("KIND");
  verb.flag("--must-pass", words->must_pass,
            "End with 1 unless the submission gets every point: how an installation proves itself");
  verb.footer(
      "tumble export makes what runs it there. For github-classroom the public tests alone are "
      "run. No output of it holds the name or the story of a hidden test, but stdout for "
      "gradescope, which instructors alone see.\n"
      "Exit: 0 there is a result, 1 --must-pass, 2 something to repair, 3 the grader failed and "
      "wrote no result.");
  verb.runs([&context, words] { autograde(context, *words); });
}

}  // namespace tumble::cli
