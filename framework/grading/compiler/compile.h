/// Compiles a submission's source inside the sandbox: to a shared object, or, in a kind of sandbox
/// in which no worker can load one, to the whole program of a worker. The compiler sees this one
/// file, the headers that a student has, and the system's headers; nothing of a solution, a test or
/// another submission.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace tumble::grading {

struct CompileLimits {
  // a module takes 2 s on an idle core; after this time the machine is too busy
  double wall_s = 900.0;
  std::uint64_t cpu_s = 30;
  // without computing or waiting for a core: the compiler waits for input that never comes
  double stall_s = 30.0;
  std::uint64_t memory_bytes = 1536ull << 20;  // of address space: Eigen's templates take 300 MB
  std::uint64_t source_bytes = 1u << 20;       // of the file handed in
};

struct CompileJob {
  std::filesystem::path root;  // of the source tree
  // of the module, from root: "assignments/a1_impulse/a1_impulse.h"
  std::filesystem::path header;
  std::filesystem::path source;  // the file handed in
  std::filesystem::path object;  // written where the outcome is kBuilt
  CompileLimits limits;
  // of the module, "a1": where a sandbox links the worker, bin/worker_ID.o of the build tree
  std::string id = {};
  // build tree with bin/sandbox_init and the precompiled header in submission_sdk/; empty: that of
  // this program
  std::filesystem::path build = {};
  enum class Form {
    kModule,  // for this machine's processor, as graded
    kBridge,  // WebAssembly, not linked: the side of a page (page_module.h)
    kPage,    // WebAssembly, linked with `bridge`
    // a student's own tests of the module: becomes a program, linked with bin/own_tests_ID.o; may
    // include GoogleTest and the headers of the public tests
    kTests,
  };
  Form form = Form::kModule;
  std::filesystem::path bridge = {};  // an object file
};

struct Compiled {
  enum class Outcome {
    kBuilt,
    kRefused,         // compiler errors, or not a source file
    kOutOfResources,  // time, memory, file size or output
    kGraderFault,     // of this program, or the machine was too busy
  };
  Outcome outcome = Outcome::kGraderFault;
  // the compiler's output, with the student's name of the file; or what went wrong
  std::string said;
};

/// Never throws because of the source. Removes an earlier `object` in every case.
/// @throws UserError when the module's header is missing or `object` cannot be written
Compiled compile_submission(const CompileJob& job);

}  // namespace tumble::grading
