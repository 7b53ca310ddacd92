/// Runs a program that nobody trusts: no network, no files but those given, limits on everything, nothing left running.
///
/// bubblewrap builds the namespaces. A keeper process of ours stands between: it owns the limits on wall time and output,
/// kills and reaps all, and outlives neither its owner nor its sandbox. As root the program runs under an unprivileged uid.
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
    kStopped,       // its owner asked for it
    kNotStarted,    // a fault of ours; `printed` says why
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
  /// Returns at once; what fails later shows in the outcome. @throws std::runtime_error when no process can be made
  static Sandbox start(const SandboxJob& job);
  Sandbox(Sandbox&& other) noexcept;
  Sandbox& operator=(Sandbox&& other) = delete;
  ~Sandbox();

  /// The program inside, as the machine numbers it; -1 while it has not begun. Cost: some 30 us
  pid_t program() const;
  /// Waits for the end.
  SandboxOutcome wait();
  /// Gives it `grace_s` to end by itself, then ends it.
  SandboxOutcome stop(double grace_s = 0.0);

 private:
  Sandbox() = default;
  pid_t keeper_ = -1;
  int hang_up_ = -1;   // closing it ends the sandbox
  int result_ = -1;
};

/// Whether this machine lets us: the reason where it does not.
std::optional<std::string> why_no_sandbox(const std::filesystem::path& init);

}  // namespace tumble::grading
