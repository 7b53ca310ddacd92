#include "framework/grading/sandbox/sandbox_kind.h"

#include "framework/core/error.h"

namespace tumble::grading {

const std::vector<SandboxTraits>& all_sandboxes() {
  static const std::vector<SandboxTraits> all = {
      {SandboxKind::kNamespaces, "namespaces", 3, true, false, true, true,
       "see files, processes, the network or IPC objects outside; write anything that outlives it",
       "nothing outside its own limits of time and memory"},
      {SandboxKind::kLandlock, "landlock", 1, false, false, false, true,
       "read or write files outside; create processes; signal, trace or read other processes; use "
       "the network or IPC objects",
       "learn that a file exists, and its size, where the folders above it are open to its user"},
      {SandboxKind::kBare, "bare", 1, false, true, false, false,
       "open files, start programs, create processes, signal others or use the network once it "
       "runs",
       "embed any file that its user can read while it is compiled, such as a world-readable "
       "solution"},
  };
  return all;
}

const SandboxTraits& traits_of(SandboxKind kind) {
  for (const SandboxTraits& traits : all_sandboxes())
    if (traits.kind == kind) return traits;
  throw PreconditionError("not a kind of sandbox");
}

SandboxKind sandbox_from_name(const std::string& name) {
  for (const SandboxTraits& traits : all_sandboxes())
    if (name == traits.name) return traits.kind;
  throw UserError(name, "is not a kind of sandbox", "Known: namespaces, landlock, bare.");
}

}  // namespace tumble::grading
