// Process 1 inside the sandbox: starts the program, waits, and reports to the keeper outside how it
// ended.
//
//   sandbox_init MAX_PROCESSES PROGRAM ARGUMENTS...
//   sandbox_init --probe       the program that why_no_sandbox runs: does nothing
//
// It replaces bubblewrap's process 1, whose memory the program inside can write through
// /proc/1/mem, to forge its exit status. This one is not dumpable, so no process inside can access
// it or its descriptors. Linked statically, with plain C calls only.
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "framework/grading/sandbox/sandbox_wire.h"

namespace {

void report(const tumble::grading::InitReport& message) {
  while (write(tumble::grading::kStatusFd, &message, sizeof message) < 0 && errno == EINTR) {
  }
}

}  // namespace

int main(int argc, char** argv) {
  using namespace tumble::grading;
  if (argc == 2 && strcmp(argv[1], "--probe") == 0) return 0;
  if (argc < 3 || prctl(PR_SET_DUMPABLE, 0) != 0) return kCannotStart;
  const rlim_t processes = strtoul(argv[1], nullptr, 10);
  report({InitReport::kStarted, 0, 0, 0.0});
  const pid_t program = fork();
  if (program < 0) return kCannotStart;
  if (program == 0) {
    close(kStatusFd);
    // Set inside the user namespace, where it counts this sandbox's processes, not all processes of
    // the user.
    const rlimit limit{processes, processes};
    if (processes > 0) setrlimit(RLIMIT_NPROC, &limit);
    execv(argv[2], argv + 2);
    _exit(kCannotStart);
  }
  close(kChannelFd);  // otherwise the channel would not close when the program dies
  for (;;) {
    int status = 0;
    rusage usage{};
    const pid_t ended = wait4(-1, &status, 0, &usage);
    if (ended == program) {
      const double cpu_s =
          static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
          1e-6 * static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
      report({InitReport::kEnded, status, usage.ru_maxrss, cpu_s});
      return 0;  // the kernel kills every other process of the sandbox with process 1
    }
    if (ended < 0 && errno != EINTR) return kCannotStart;
  }
}
