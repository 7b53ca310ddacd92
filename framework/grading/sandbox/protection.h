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

/// "namespaces", "landlock (ABI 7, a user id of its own)", "bare (user id of the grader)": the
/// protection of a grade, for pages and records.
std::string protection_in_words(SandboxKind kind);

}  // namespace tumble::grading
