/// The protocol between process 1 of a sandbox and its keeper outside.
#pragma once

namespace tumble::grading {

inline constexpr int kChannelFd = 3;   // of the program, where the job has a channel
inline constexpr int kStatusFd = 4;    // of process 1 only
inline constexpr int kFilterFd = 5;    // read and closed by bubblewrap

struct InitReport {
  enum What : int { kStarted = 1, kEnded = 2 };
  int what;
  int status;            // as of wait4
  long peak_memory_kb;
  double cpu_s;
};

}  // namespace tumble::grading
