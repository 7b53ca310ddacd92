/// How a sandboxed program ended.
#pragma once

#include <string>

namespace tumble::grading {

struct SandboxOutcome {
  enum class Ending {
    kExited,  // code: of exit
    kSignal,  // code: the signal; the limit on CPU time shows as SIGXCPU or SIGKILL
    kWallLimit,
    kStalled,  // slept past the limit
    kOutputLimit,
    kDiskLimit,   // only where the temporary folder is on a disk of the host
    kStopped,     // by its owner
    kNotStarted,  // a fault of the grader; `printed` says why
  };
  Ending ending = Ending::kNotStarted;
  int code = 0;
  std::string printed;  // stdout and stderr, at most output_bytes
  long peak_memory_kb = 0;
  double cpu_s = 0.0;
};

}  // namespace tumble::grading
