/// Limits that the kernel keeps for each process.
#pragma once

#include <cstdint>

#include "framework/grading/sandbox/sandbox_job.h"

namespace tumble::grading {

/// Sets the limits for this process and its descendants, except the number of processes, which each
/// body counts in its own way.
void set_limits(const SandboxLimits& limits);

/// Sets one limit, RLIMIT_...
void set_limit(int what, std::uint64_t value);

}  // namespace tumble::grading
