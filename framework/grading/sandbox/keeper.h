/// The keeper: a process between the owner of a sandbox and the program inside (see sandbox.h).
#pragma once

#include "framework/grading/sandbox/sandbox_job.h"

namespace tumble::grading {

/// Runs the job, and returns when nothing of it is left.
/// @param hang_up  a pipe that the owner closes to end the sandbox
/// @param result   a pipe for the outcome, as read_outcome takes it
/// @pre  this process has no other children
void keep_sandbox(const SandboxJob& job, int hang_up, int result);

}  // namespace tumble::grading
