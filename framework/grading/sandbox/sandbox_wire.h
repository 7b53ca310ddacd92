/// The protocol between process 1 of a sandbox, or what becomes the program, and its keeper
/// outside.
#pragma once

namespace tumble::grading {

inline constexpr int kChannelFd = 3;  // of the program, where the job has a channel
inline constexpr int kStatusFd = 4;   // for InitReport; the program does not get it
inline constexpr int kBodyFd = 5;     // SandboxBody::descriptor; bubblewrap reads its filter there

// exit code where the program itself cannot be started, as in a shell
inline constexpr int kCannotStart = 127;

struct InitReport {
  enum What : int { kStarted = 1, kEnded = 2 };
  int what;
  int status;  // as of wait4
  long peak_memory_kb;
  double cpu_s;
};

}  // namespace tumble::grading
