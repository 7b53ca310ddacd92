/// What is run in a sandbox, what it sees, and its limits.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace tumble::grading {

struct SandboxLimits {
  double wall_s = 10.0;
  double stall_s = 0.0;                          // of wall time in which nothing inside computes or waits for a core; 0: not limited
  std::uint64_t cpu_s = 10;                      // per process; the wall limit bounds the sum
  std::uint64_t memory_bytes = 1ull << 30;       // of address space, per process
  std::uint64_t file_bytes = 64ull << 20;        // per file
  std::uint64_t tmp_bytes = 64ull << 20;         // of /tmp; /dev/shm has a sixteenth of it
  std::uint64_t processes = 12;                  // threads count; 0: not limited, for programs that are ours
  std::uint64_t open_files = 64;
  std::uint64_t output_bytes = 256ull << 10;     // printed; above it the program is killed
};

/// A file or folder outside, shown read-only inside.
struct Bind {
  std::filesystem::path from;   // the sandbox's user must be able to reach it: see Stage
  std::string to;
};

struct SandboxJob {
  std::vector<std::string> command;   // absolute path inside, arguments
  std::vector<Bind> binds;            // beside /usr
  SandboxLimits limits;
  int channel = -1;                   // becomes descriptor 3 inside, where given; the caller keeps its own copy
  std::filesystem::path init;         // the program sandbox_init, reachable as a Bind is
  std::optional<uid_t> uid;           // of SandboxUser
};

}  // namespace tumble::grading
