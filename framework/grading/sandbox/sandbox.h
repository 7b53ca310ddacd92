/// Runs an untrusted program: no network, only the given files, limits on everything, no process
/// left behind.
///
/// bubblewrap creates the namespaces. A keeper process between the owner and bubblewrap enforces
/// the limits on wall time and output, kills and reaps all processes, and ends with its owner or
/// its sandbox. As root the program runs under an unprivileged uid.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>

#include "framework/grading/sandbox/sandbox_job.h"
#include "framework/grading/sandbox/sandbox_user.h"

namespace tumble::grading {

struct SandboxOutcome {
  enum class Ending {
    kExited,        // code: of exit
    kSignal,        // code: the signal; the limit on CPU time shows as SIGXCPU or SIGKILL
    kWallLimit,
    kStalled,       // slept past the limit
    kOutputLimit,
    kStopped,       // by its owner
    kNotStarted,    // a fault of the grader; `printed` says why
  };
  Ending ending = Ending::kNotStarted;
  int code = 0;
  std::string printed;         // stdout and stderr, at most output_bytes
  long peak_memory_kb = 0;
  double cpu_s = 0.0;
};

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
  int hang_up_ = -1;   // closing it ends the sandbox
  int result_ = -1;
};

/// Why sandboxes do not work on this machine; nothing where they do.
std::optional<std::string> why_no_sandbox(const std::filesystem::path& init);

}  // namespace tumble::grading
