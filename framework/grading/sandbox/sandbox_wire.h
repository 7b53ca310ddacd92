/// What process 1 of a sandbox and its keeper outside agree on.
#pragma once

namespace tumble::grading {

inline constexpr int kChannelFd = 3;   // the program's, where the job has a channel
inline constexpr int kStatusFd = 4;    // process 1's alone
inline constexpr int kFilterFd = 5;    // read and closed by bubblewrap

struct InitReport {
  enum What : int { kStarted = 1, kEnded = 2 };
  int what;
  int status;            // as of wait4
  long peak_memory_kb;
  double cpu_s;
};

}  // namespace tumble::grading
