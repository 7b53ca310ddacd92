/// From a submission's source to a shared object, inside the sandbox: the compiler sees that one file, the headers that a
/// student has, and the system's; nothing of a solution, a test or another submission.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace tumble::grading {

struct CompileLimits {
  double wall_s = 900.0;                          // a module takes 2 on an idle core; past this the machine is too busy
  std::uint64_t cpu_s = 30;
  double stall_s = 30.0;                          // in which the compiler neither computes nor waits for a core: it waits for what never comes
  std::uint64_t memory_bytes = 1536ull << 20;     // of address space: Eigen's templates take 300 MB
  std::uint64_t source_bytes = 1u << 20;          // of the file handed in
};

struct CompileJob {
  std::filesystem::path root;       // of the source tree
  std::filesystem::path header;     // of the module, from root: "assignments/a1_impulse/a1_impulse.h"
  std::filesystem::path source;     // the file handed in
  std::filesystem::path object;     // written where it is built
  CompileLimits limits;
  std::filesystem::path build = {};   // of the build tree: sandbox_init in bin/, what is precompiled in submission_sdk/; empty: that of this program
};

struct Compiled {
  enum class Outcome {
    kBuilt,
    kRefused,          // the compiler's errors, or a file that is none
    kOutOfResources,   // of time, memory, file size or output
    kGraderFault,      // ours, or a machine too busy
  };
  Outcome outcome = Outcome::kGraderFault;
  std::string said;    // the compiler's words, which name the file as the student does; or what went wrong
};

/// Never throws for what the source does. What was in `object` before is gone, whatever the outcome.
/// @throws UserError when the module's header is missing or `object` cannot be written
Compiled compile_submission(const CompileJob& job);

}  // namespace tumble::grading
