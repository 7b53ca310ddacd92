/// What confines submissions on this machine: the strongest kind of sandbox that works, or the one
/// that TUMBLE_SANDBOX names.
#pragma once

#include <optional>
#include <string>

#include "framework/grading/sandbox/sandbox_kind.h"

namespace tumble::grading {

/// Why sandboxes of this kind do not work here; nothing where they do. Runs a program in one.
std::optional<std::string> why_no_sandbox(SandboxKind kind);

/// The kind that this process uses: $TUMBLE_SANDBOX, else the strongest that works here. It is
/// found once, and then named in the environment, so that the programs of one grading agree.
/// @throws UserError when TUMBLE_SANDBOX names no kind or none works
SandboxKind chosen_sandbox();

/// Chooses a kind for this process and those that it starts, as TUMBLE_SANDBOX does.
/// @throws UserError when it is none, or does not work here
void choose_sandbox(const std::string& name);

/// "namespaces", "landlock (ABI 7, a user id of its own)", "bare (user id of the grader)": the
/// protection of a grade, for pages and records.
std::string protection_in_words(SandboxKind kind);

/// What protects the grades of one run.
struct GradeProtection {
  std::string words;        // protection_in_words
  bool is_official = true;  // the policy accepts it for grades that count
  std::string note;         // for every output of an unofficial grade; else empty
};

/// @param accepted  the name of a kind that the policy refuses and the user accepts; may be empty
/// @throws UserError when the policy refuses the chosen kind and it is not `accepted`
GradeProtection protection_of_grades(const std::string& accepted);

}  // namespace tumble::grading
