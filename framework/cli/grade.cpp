// tumble grade a1 FOLDER: a folder of submissions, graded.
#include <cstdio>
#include <memory>

#include <fmt/format.h>

#include "framework/cli/grading_run.h"
#include "framework/grading/grades/grade_shards.h"
#include "framework/grading/grades/grade.h"
#include "framework/grading/grades/grade_pages.h"
#include "framework/grading/grades/output_folder.h"
#include "framework/grading/verdicts/plain_text.h"

namespace tumble::cli {
namespace {

namespace fs = std::filesystem;

struct GradeWords {
  std::string id, folder, out;
  int jobs = 0;  // one a core
  double budget_s = grading::GradeOptions{}.budget_s;
  bool no_media = false;
  std::string code_in_pages;  // empty: by no_media
  std::string sandbox, accepted_sandbox, policy;
  bool no_policy = false, mend_list = false;
  std::string shard, on, hosts;
  int shards = 0;
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
    fmt::print(stderr, "not lowered: {} ({}){}\n", grading::plain_name(lowering.name),
               lowering.change,
               lowering.is_only_in_ledger ? "; its score is blank until that is decided" : "");
  fmt::print(
      stderr,
      "These files are the same as before, so no score is lowered. To see why, and to decide: "
      "tumble regrade {} {}\n",
      id, out.string());
  return false;
}

// The words of this command for a task of a cluster, where paths mean the same from any folder.
std::vector<std::string> words_of_task(const Context& context, const GradeWords& words,
                                       const fs::path& out) {
  std::vector<std::string> all = {(context.build / "bin/tumble").string(),
                                  "grade",
                                  words.id,
                                  fs::canonical(words.folder).string(),
                                  "--out",
                                  out.string(),
                                  "--budget-s",
                                  fmt::format("{}", words.budget_s)};
  if (words.no_media) all.push_back("--no-media");
  if (!words.code_in_pages.empty()) all.insert(all.end(), {"--code-in-pages", words.code_in_pages});
  if (!words.sandbox.empty()) all.insert(all.end(), {"--sandbox", words.sandbox});
  if (!words.accepted_sandbox.empty())
    all.insert(all.end(), {"--accept-sandbox", words.accepted_sandbox});
  return all;
}

grading::RunSettings settings_of_run(const GradeWords& words,
                                     const grading::GradeOptions& options) {
  return {words.id,       fs::canonical(words.folder),          options.budget_s, options.media,
          options.policy, grading::word_of(options.page_code())};
}

void grade_shards(const Context& context, const GradeWords& words, std::size_t total,
                  const grading::GradeOptions& options, const fs::path& out) {
  grading::ShardedGrading job;
  job.cluster = farm::cluster_of(words.on);
  job.command = words_of_task(context, words, out);
  job.root = context.root;
  job.submissions = fs::canonical(words.folder);
  job.out = out;
  job.total = total;
  job.shards = words.shards;
  job.hosts = words.hosts;
  job.jobs = words.jobs;
  job.progress = options.progress;
  job.notice = options.notice;
  {  // Refused before any job. Its settings are those of the grading: where it is killed before the
     // end, the policy must not be forgotten.
    const grading::OutputFolder check(
        out, words.folder, words.id, settings_of_run(words, options),
        words.mend_list ? grading::BrokenList::kMend : grading::BrokenList::kRefuse);
  }
  grading::grade_on(job);
}

void refuse_contradictions(const GradeWords& words) {
  if (!words.on.empty() && !words.shard.empty())
    throw UserError("--shard", "is one part, which --on makes itself", "Leave out one of them.");
  if (words.on.empty() && (!words.hosts.empty() || words.shards > 0))
    throw UserError(words.hosts.empty() ? "--shards" : "--hosts", "means something with --on only",
                    "Add --on slurm, parallel or mpi.");
  if (words.on == "slurm" && !words.hosts.empty())
    throw UserError("--hosts", "are chosen by Slurm",
                    "Leave it out; SBATCH_PARTITION and SBATCH_NODELIST choose machines.");
}

/// The policy of the last grading into this folder; empty: it had none, or is no folder of results,
/// which is for the grading itself to say.
fs::path policy_before(const fs::path& out, bool mend_list) {
  if (!grading::has_manifest(out)) return {};
  try {
    return grading::settings_of(out).policy;
  } catch (const UserError&) {
    if (!mend_list) throw;
    throw UserError(out.string(),
                    "whether its last grading went by a policy is in no list that can be read",
                    "Add --policy FILE.json, or --no-policy if there was none.");
  }
}

/// A gradebook that had due dates and penalties must not lose them because a word was forgotten.
void refuse_to_drop_policy(const GradeWords& words, const fs::path& out) {
  // a part of a class makes no gradebook: the command that asked for it does
  if (!words.policy.empty() || words.no_policy || !words.shard.empty()) return;
  const fs::path before = policy_before(out, words.mend_list);
  if (before.empty()) return;
  throw UserError(
      out.string(),
      "its last grading went by " + before.string() +
          ", and none is given now: the gradebook would lose due dates, late days and "
          "penalties",
      "Add --policy " + before.string() + ", or --no-policy to go without from now on.");
}

void grade(Context& context, const GradeWords& words) {
  refuse_contradictions(words);
  const fs::path out =
      words.out.empty() ? fs::path("out") / ("grade_" + words.id) : fs::path(words.out);
  // before anything in it is read: a list of results among submissions is a student's
  if (fs::is_directory(words.folder)) grading::place_of_results(out, words.folder);
  refuse_to_drop_policy(words, out);
  GradingRequest request{words.id, words.folder, out, words.sandbox, words.policy, {}};
  request.options.jobs = words.jobs > 0 ? words.jobs : default_jobs();
  if (!words.shard.empty()) request.options.shard = farm::shard_of(words.shard);
  if (!words.on.empty())
    request.before = [&](std::size_t total, const grading::GradeOptions& options) {
      grade_shards(context, words, total, options, fs::weakly_canonical(fs::absolute(out)));
    };
  request.options.budget_s = words.budget_s;
  request.options.media = !words.no_media;
  if (!words.code_in_pages.empty())
    request.options.code_in_pages = grading::code_in_pages_of(words.code_in_pages);
  request.options.accepted_sandbox = words.accepted_sandbox;
  request.options.mend_list = words.mend_list;
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
  if (request.options.shard)
    fmt::print("shard {}: {} submission{}; grade {} without --shard makes the gradebook\n",
               words.shard, grades.size(), grades.size() == 1 ? "" : "s", words.id);
  else
    fmt::print("wrote {} and {}\n", (out / "index.html").string(),
               (out / "gradebook.csv").string());
}

}  // namespace

void add_grade(CLI::App& app, Context& context) {
  auto words = std::make_shared<GradeWords>();
  Verb verb(app, "grade", "Grade a folder of submissions: scores, stories, pictures, a gradebook");
  verb.option("assignment", words->id, "Which, e.g. a1").required().type_name("ID");
  verb.option(
          "folder", words->folder,
          "One submission a sub-folder; or what Gradescope, Canvas or Moodle gives to download, "
          "as a folder or a zip")
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
  verb.option("--code-in-pages", words->code_in_pages,
              "Whose functions answer in a page: own (the file's; in the TA's page "
              "the right ones beside them), both (in the student's page, too: it holds the "
              "solution, compiled), none")
      .type_name("WHOSE")
      .default_text("own; with --no-media none");
  verb.option(
          "--policy", words->policy,
          "Due dates, late days, penalties, attempts, groups and the roster; the gradebook then "
          "has points before and after, and why")
      .type_name("FILE.json");
  verb.flag("--no-policy", words->no_policy,
            "Grade without one into a folder whose last grading had one");
  verb.flag("--mend-list", words->mend_list,
            "Make the list of results in the folder (.tumble-grade.json) anew where it cannot be "
            "read: from the ledger and the records");
  verb.option("--sandbox", words->sandbox,
              "namespaces, landlock or bare; default: the strongest that this machine has (tumble "
              "doctor)")
      .type_name("KIND");
  verb.option("--accept-sandbox", words->accepted_sandbox,
              "Grade in this kind although the policy for grades refuses it; every result says "
              "that it is not official")
      .type_name("KIND");
  verb.option("--on", words->on,
              "Grade on other machines: " + farm::names_of_clusters() +
                  ". Course, submissions, results and key lie in a folder that all share")
      .type_name("WHAT");
  verb.option("--shards", words->shards,
              "With --on: in how many parts; default: ten submissions each, at most 1,000")
      .between(1, 1000000);
  verb.option(
          "--hosts", words->hosts,
          "With --on parallel its words for --sshlogin, e.g. ta@lab1,ta@lab2; with --on mpi for "
          "--host, e.g. lab1:4,lab2:4; default: this machine")
      .type_name("HOSTS");
  verb.option("--shard", words->shard,
              "Grade only this part of the class, e.g. 2/8, into OUT/.shards; the same command "
              "without it takes over what is finished")
      .type_name("K/N");
  verb.footer(
      "Exit: 0 all graded, 1 a submission without a file, or a score that tumble regrade has to "
      "ask about (blank, with the reason), 2 something to repair, "
      "3 the grader failed or the machine was too busy somewhere (those scores are blank, or a "
      "page "
      "says what is missing; run it again).\n"
      "Earlier results count where they are signed by this machine's key ($TUMBLE_GRADER_KEY, else "
      "~/.local/state/tumble/grader.key, made on first use).");
  verb.runs([&context, words] { grade(context, *words); });
}

}  // namespace tumble::cli
