#include "framework/cli/grading_run.h"

#include <cstdio>
#include <thread>

#include <fmt/format.h>

#include "framework/grading/grades/class_files.h"
#include "framework/grading/grades/find_submissions.h"
#include "framework/grading/grades/grade_many.h"
#include "framework/grading/sandbox/protection.h"
#include "framework/grading/verdicts/plain_text.h"

namespace tumble::cli {
namespace {

namespace fs = std::filesystem;

std::string span_of(double seconds) {
  if (seconds < 90.0) return fmt::format("{:.0f} s", seconds);
  if (seconds < 5400.0) return fmt::format("{:.0f} min", seconds / 60.0);
  return fmt::format("{:.1f} h", seconds / 3600.0);
}

void tell(const grading::GradeProgress& progress) {
  std::string line = fmt::format("[{}/{}]", progress.done, progress.total);
  if (!progress.finished.empty()) line += ' ' + grading::plain_name(progress.finished);
  if (progress.done < progress.total)
    line += progress.left_s >= 0.0 ? " · about " + span_of(progress.left_s) + " left" : " ...";
  fmt::print(stderr, "{}\n", line);
  std::fflush(stderr);
}

// Nobody gets 0 points in silence: who has no score, and why.
void tell_standings(const fs::path& out) {
  for (const std::string& sentence :
       grading::what_needs_a_look(grading::read_standings(out / grading::kStandingFile)))
    fmt::print(stderr, "look: {}\n", sentence);
}

void set_exit(Context& context, const std::vector<grading::Grade>& grades) {
  for (const auto& grade : grades) {
    for (const std::string& fault : grade.faults)
      fmt::print(stderr, "{}: the grader failed, at {}\n", grading::plain_name(grade.name),
                 grading::plain_text(fault));
    if ((!grade.is_final() && !grade.is_held) || !grade.faults.empty())
      context.exit = ExitCode::kOurBug;
    else if (!grade.has_score() && context.exit == ExitCode::kFine)
      context.exit = ExitCode::kCheckFailed;
  }
}

}  // namespace

int default_jobs() { return static_cast<int>(std::max(1u, std::thread::hardware_concurrency())); }

std::vector<grading::Grade> run_grading(Context& context, const GradingRequest& request) {
  const modules::ModuleKind& kind = context.registry.find(request.id);
  const grading::Course course{context.root, context.build, &context.registry,
                               context.command_line};
  grading::judge_of(course, request.id);  // refused before any submission is read
  if (!request.sandbox.empty()) grading::choose_sandbox(request.sandbox);
  grading::GradeOptions options = request.options;
  std::optional<grading::PolicyFile> policy;
  if (!request.policy.empty()) policy = grading::read_policy(request.policy, request.id);
  if (policy) options.policy = fs::absolute(request.policy);
  const grading::GradeProtection protection =
      grading::protection_of_grades(options.accepted_sandbox);
  const auto found = grading::find_submissions(request.folder, kind, request.options.shard);
  options.progress = tell;
  options.notice = [](const std::string& sentence) {
    fmt::print(stderr, "{}\n", grading::plain_text(sentence));
  };
  grading::SlipTally slips({});
  if (!options.shard) slips = grading::SlipTally(grading::known_slips(course, request.id));
  bool has_failed = false, has_standings = false;
  options.failed = [&](const std::string& what, const std::string& why) {
    fmt::print(stderr,
               "the grader failed at {}: {}\nEvery grade is in place; the same command makes it "
               "again.\n",
               what, grading::plain_text(why));
    has_failed = true;
  };
  options.each = [&](const grading::Grade& grade) { slips.add(grade); };
  options.overview = [&](const fs::path& out, const std::vector<grading::Grade>& grades) {
    grading::write_class_files(course, kind, request.folder, policy ? &*policy : nullptr, out,
                               grades, slips, options);
    has_standings = policy.has_value();
  };
  for (const std::string& name : found.passed_over)
    fmt::print(stderr, "passed over: {}\n", grading::plain_name(name));
  fmt::print(stderr, "{} submission{} of {}, {} at a time, into {}; sandbox: {}\n",
             found.all.size(), found.all.size() == 1 ? "" : "s", request.id, options.jobs,
             request.out.string(), protection.words);
  if (request.before) request.before(found.all.size(), options);
  const auto grades =
      grading::grade_submissions(course, request.id, found, fs::absolute(request.out), options);
  if (has_standings) tell_standings(request.out);
  set_exit(context, grades);
  if (has_failed) context.exit = ExitCode::kOurBug;
  return grades;
}

void print_changes(const std::vector<grading::TestChange>& changes, std::size_t indent) {
  for (const auto& c : changes)
    fmt::print("{:<{}}{}: {} -> {} ({})\n", "", indent, c.test, c.before, c.after, c.reason);
}

}  // namespace tumble::cli
