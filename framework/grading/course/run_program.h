/// Runs a program of ours or of the system to its end.
#pragma once

#include <string>
#include <vector>

namespace tumble::grading {

struct ProgramOutcome {
  int code = -1;          // of exit; 128 + signal for one that a signal ended, as a shell says it
  bool in_time = true;
  std::string printed;    // stdout and stderr as they came; empty where they were not asked for
};

enum class Output { kCaptured, kDropped, kOurs };

/// @param words   the program (a path, or a name on PATH) and its arguments
/// @param wall_s  after which it is killed
/// The program dies with us. @throws std::runtime_error when no process can be made
ProgramOutcome run_program(const std::vector<std::string>& words, Output output, double wall_s = 3600.0);

}  // namespace tumble::grading
