/// What a sandbox runs, what is visible inside, and its limits.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "framework/grading/sandbox/sandbox_kind.h"

namespace tumble::grading {

struct SandboxLimits {
  double wall_s = 10.0;
  // wall time in which no process inside computes or waits for a core; 0: not limited
  double stall_s = 0.0;
  // the sum of such times, however often something is computed between them; 0: not limited
  double idle_s = 0.0;
  std::uint64_t cpu_s = 10;                 // per process; the wall limit bounds the sum
  std::uint64_t memory_bytes = 1ull << 30;  // of address space, per process
  std::uint64_t file_bytes = 64ull << 20;   // per file
  std::uint64_t tmp_bytes = 64ull << 20;    // of /tmp; 0: there is no folder to write to
  // including threads and process 1; 0: not limited, for trusted programs
  std::uint64_t processes = 12;
  std::uint64_t open_files = 64;
  std::uint64_t output_bytes = 256ull << 10;  // printed; above it the program is killed
};

/// A file or folder that is visible inside, read-only.
struct Bind {
  std::filesystem::path from;  // accessible to the sandbox's user: see Stage
  // its name inside; where the sandbox has no files of its own, it is read at `from`
  std::string to;
};

/// Name inside of the folder that can be written to.
inline constexpr const char* kTmpInside = "/tmp";

struct SandboxJob {
  /// Absolute path inside, then arguments. A word that is Bind::to or kTmpInside, or a path below
  /// one of them, is written as its name in the sandbox that runs it.
  std::vector<std::string> command;
  std::vector<Bind> binds;  // beside /usr
  SandboxLimits limits;
  // a submission: no further process or thread, no signal to another, no change to a file's
  // attributes
  bool is_alone = false;
  // if >= 0, becomes descriptor 3 inside; the caller keeps its own copy
  int channel = -1;
  // the program sandbox_init, accessible like Bind::from; see SandboxTraits::needs_init
  std::filesystem::path init;
  std::optional<uid_t> uid;                     // of SandboxUser
  SandboxKind kind = SandboxKind::kNamespaces;  // chosen_sandbox(), unless one kind is examined
};

}  // namespace tumble::grading
