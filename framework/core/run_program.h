/// Runs a trusted program, of the project or of the system, to its end.
#pragma once

#include <string>
#include <vector>

namespace tumble {

struct ProgramOutcome {
  int code = -1;  // exit code; 128 + signal where a signal ended it, as in a shell
  bool in_time = true;
  std::string printed;  // stdout and stderr, interleaved; empty unless kCaptured
};

enum class Output { kCaptured, kDropped, kOurs };

/// @param words   the program (a path, or a name on PATH) and its arguments
/// @param wall_s  time after which it is killed
/// The program dies with this process.
/// @throws std::runtime_error when no process can be created
ProgramOutcome run_program(const std::vector<std::string>& words, Output output,
                           double wall_s = 3600.0);

}  // namespace tumble
