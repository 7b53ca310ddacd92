#include "framework/grading/sandbox/protection.h"

#include <cstdlib>

#include "framework/core/error.h"
#include "framework/grading/sandbox/landlock.h"
#include "framework/grading/sandbox/sandbox.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;

constexpr const char* kVariable = "TUMBLE_SANDBOX";

fs::path init_program() { return fs::canonical("/proc/self/exe").parent_path() / "sandbox_init"; }

SandboxKind strongest() {
  std::string reasons;
  for (const SandboxTraits& traits : all_sandboxes()) {
    const auto why = why_no_sandbox(traits.kind);
    if (!why) return traits.kind;
    reasons += "\n    " + std::string(traits.name) + ": " + *why;
  }
  throw UserError("sandbox", "no kind of it works on this machine:" + reasons,
                  "tumble doctor says what each needs.");
}

}  // namespace

std::optional<std::string> why_no_sandbox(SandboxKind kind) {
  if (!fs::exists(init_program())) return init_program().string() + " is not built";
  const SandboxUser user = SandboxUser::lease();
  Stage stage(&user);
  SandboxJob job;
  job.kind = kind;
  job.init = stage.add_file(init_program(), "init", true);
  job.binds = {{job.init, "/probe"}};
  job.command = {"/probe", "--probe"};
  job.is_alone = true;  // as submissions run
  job.limits.tmp_bytes = 0;
  job.uid = user.uid();
  const SandboxOutcome outcome = Sandbox::start(job).wait();
  if (outcome.ending == SandboxOutcome::Ending::kExited && outcome.code == 0) return std::nullopt;
  const std::string said = outcome.printed.substr(0, outcome.printed.find_last_not_of('\n') + 1);
  return said.empty() ? "the sandbox does not start" : said;
}

SandboxKind chosen_sandbox() {
  const char* named = std::getenv(kVariable);
  if (named != nullptr && *named != '\0') return sandbox_from_name(named);
  const SandboxKind kind = strongest();
  ::setenv(kVariable, traits_of(kind).name, 1);
  return kind;
}

void choose_sandbox(const std::string& name) {
  if (const auto why = why_no_sandbox(sandbox_from_name(name)))
    throw UserError("sandbox " + name, "does not work on this machine: " + *why,
                    "tumble doctor says what it needs.");
  ::setenv(kVariable, name.c_str(), 1);
}

std::string protection_in_words(SandboxKind kind) {
  const std::string name = traits_of(kind).name;
  if (kind == SandboxKind::kNamespaces) return name;
  const std::string user = can_change_user() ? "a user id of its own" : "the grader's user id";
  return name + (kind == SandboxKind::kLandlock
                     ? " (ABI " + std::to_string(landlock_abi()) + ", " + user + ")"
                     : " (" + user + ")");
}

GradeProtection protection_of_grades(const std::string& accepted) {
  if (!accepted.empty()) sandbox_from_name(accepted);
  const SandboxTraits& traits = traits_of(chosen_sandbox());
  GradeProtection protection{protection_in_words(traits.kind), traits.is_official, ""};
  if (traits.is_official) return protection;
  const std::string name = traits.name;
  if (accepted != name)
    throw UserError(
        "sandbox " + name,
        "is less than the policy for grades asks for (namespaces or landlock): a submission can " +
            std::string(traits.permits),
        "tumble doctor says what is missing here. To grade all the same, with every result marked "
        "as not official: --accept-sandbox " +
            name + ".");
  protection.note = "not an official grade: the sandbox was " + protection.words +
                    ", and the policy asks for namespaces or landlock";
  return protection;
}

}  // namespace tumble::grading
