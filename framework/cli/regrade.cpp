// tumble regrade a1 OUT: grades again into a folder of results, shows what changed and why, and
// asks before it lowers a score.
#include <cstdio>
#include <iostream>
#include <memory>

#include <fmt/format.h>
#include <unistd.h>

#include "framework/cli/grading_run.h"
#include "framework/grading/grades/output_folder.h"
#include "framework/grading/verdicts/plain_text.h"

namespace tumble::cli {
namespace {

namespace fs = std::filesystem;

struct RegradeWords {
  std::string id, out, submissions;
  std::vector<std::string> only;
  int jobs = default_jobs();
  bool again = false, yes = false;
  std::string sandbox, accepted_sandbox;
};

// The answer of the person at the terminal. Without a terminal nobody agrees.
bool ask(std::size_t count) {
  const bool is_terminal = ::isatty(STDIN_FILENO) == 1;
  if (!is_terminal) {
    fmt::print("Not lowered: nobody can be asked here. With --yes they are lowered.\n");
    return false;
  }
  fmt::print("Lower {}? Type yes, or anything else to leave {}: ",
             count == 1 ? "this score" : fmt::format("these {} scores", count),
             count == 1 ? "it" : "them");
  std::fflush(stdout);
  std::string answer;
  std::getline(std::cin, answer);
  return answer == "yes";
}

bool may_lower(const std::vector<grading::Lowering>& lowerings, bool yes) {
  fmt::print("{} would be lower than before:\n",
             lowerings.size() == 1 ? "One score" : fmt::format("{} scores", lowerings.size()));
  for (const grading::Lowering& lowering : lowerings) {
    fmt::print("  {}: {}\n", grading::plain_name(lowering.name), lowering.change);
    print_changes(lowering.changes, 4);
  }
  return yes || ask(lowerings.size());
}

void print_result(const std::vector<grading::Grade>& grades) {
  std::size_t unchanged = 0;
  for (const grading::Grade& grade : grades) {
    const bool is_refused = grade.change.starts_with("not lowered");
    const bool has_changed = !grade.taken_over && (!grade.change.empty() || !grade.changes.empty());
    if (!has_changed && !is_refused) {
      ++unchanged;
      continue;
    }
    fmt::print("{}: {}\n", grading::plain_name(grade.name),
               grade.change.empty() ? "the same score, by other tests" : grade.change);
    if (!is_refused) print_changes(grade.changes, 2);
  }
  fmt::print("{} of {} unchanged\n", unchanged, grades.size());
}

void regrade(Context& context, const RegradeWords& words) {
  const grading::RunSettings before = grading::settings_of(words.out);
  if (before.assignment != words.id)
    throw UserError(
        words.out,
        "holds results of " + grading::plain_name(before.assignment) + ", not of " + words.id,
        "Name its assignment first: tumble regrade " + before.assignment + " " + words.out);
  const fs::path folder =
      words.submissions.empty() ? before.submissions : fs::path(words.submissions);
  if (!fs::exists(folder))
    throw UserError(folder.string(), "is where the submissions were, and they are not there now",
                    "Say where they are with --submissions FOLDER.");
  GradingRequest request{words.id, folder, words.out, words.sandbox, before.policy, {}};
  request.options.jobs = words.jobs;
  request.options.budget_s = before.budget_s;
  request.options.media = before.media;
  request.options.code_in_pages = grading::code_in_pages_of(before.code_in_pages);
  request.options.accepted_sandbox = words.accepted_sandbox;
  request.options.only = words.only;
  request.options.again = words.again;
  request.options.guard_changed_files = true;
  request.options.may_lower = [&](const std::vector<grading::Lowering>& lowerings) {
    return may_lower(lowerings, words.yes);
  };
  const auto grades = run_grading(context, request);
  print_result(grades);
  for (const grading::Grade& grade : grades)
    if (grade.change.starts_with("not lowered") && context.exit == ExitCode::kFine)
      context.exit = ExitCode::kCheckFailed;
}

}  // namespace

void add_regrade(CLI::App& app, Context& context) {
  auto words = std::make_shared<RegradeWords>();
  Verb verb(app, "regrade", "Grade again: old and new score, which test changed and why");
  verb.option("assignment", words->id, "Which, e.g. a1").required().type_name("ID");
  verb.option("results", words->out, "The folder that was given to grade as --out")
      .required()
      .type_name("OUT");
  verb.option("--only", words->only,
              "Names of submissions, with commas between them; others keep "
              "what they have")
      .separated_by(',')
      .type_name("NAME,...");
  verb.flag("--again", words->again,
            "Also what has not changed: the same submission and grader give the same result");
  verb.flag("--yes", words->yes, "Lower scores without a question");
  verb.option("--submissions", words->submissions,
              "Where the submissions are now; default: where they were")
      .type_name("FOLDER");
  verb.option("--jobs", words->jobs, "Submissions at a time")
      .between(1, 256)
      .default_text("number of cores");
  verb.option("--sandbox", words->sandbox, "As of grade").type_name("KIND");
  verb.option("--accept-sandbox", words->accepted_sandbox, "As of grade").type_name("KIND");
  verb.footer(
      "One student again: tumble regrade a1 OUT --only ada --again\n"
      "Without a terminal and without --yes no score is lowered. Time budget, pictures and policy "
      "are those of the last grading.\n"
      "Exit: 0 done, 1 a score was not lowered or a submission has no file, 2 something to repair, "
      "3 the grader failed somewhere (run it again).");
  verb.runs([&context, words] { regrade(context, *words); });
}

}  // namespace tumble::cli
