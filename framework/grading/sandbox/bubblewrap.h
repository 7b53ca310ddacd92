/// The command line of bubblewrap for one sandbox.
#pragma once

#include <string>
#include <vector>

#include "framework/grading/sandbox/sandbox_job.h"

namespace tumble::grading {

/// Absolute path of the program, then its arguments.
std::vector<std::string> bubblewrap_command(const SandboxJob& job);

}  // namespace tumble::grading
