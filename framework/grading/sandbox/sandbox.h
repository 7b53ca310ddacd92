/// Runs an untrusted program: no network, only the given files, limits on everything, no process
/// left behind.
///
/// A body (body.h) confines the program: by namespaces, or by what else the kernel offers. A keeper
/// process between the owner and the program enforces the limits on wall time and output, kills and
/// reaps all processes, and ends with its owner or its sandbox. As root the program runs under an
/// unprivileged uid.
#pragma once

#include <sys/types.h>

#include "framework/grading/sandbox/sandbox_job.h"
#include "framework/grading/sandbox/sandbox_outcome.h"
#include "framework/grading/sandbox/sandbox_user.h"

namespace tumble::grading {

/// A running sandbox. Destruction stops it.
class Sandbox {
 public:
  /// Returns immediately; later failures are in the outcome.
  /// @throws std::runtime_error when no process can be created
  static Sandbox start(const SandboxJob& job);
  Sandbox(Sandbox&& other) noexcept;
  Sandbox& operator=(Sandbox&& other) = delete;
  ~Sandbox();

  /// Process id, outside the sandbox, of the program inside; -1 before it starts. Cost: about 30 us
  pid_t program() const;
  /// Waits for the end.
  SandboxOutcome wait();
  /// Gives the program `grace_s` to end by itself, then kills it.
  SandboxOutcome stop(double grace_s = 0.0);

 private:
  Sandbox() = default;
  pid_t keeper_ = -1;
  int hang_up_ = -1;  // closing it ends the sandbox
  int result_ = -1;
  int generations_ = 1;  // from the keeper to the program
};

}  // namespace tumble::grading
