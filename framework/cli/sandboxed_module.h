/// A submission as laws of a scene: compiled and called in the sandbox, never loaded into this
/// process.
#pragma once

#include <filesystem>
#include <memory>

#include "framework/cli/verb.h"

namespace tumble::cli {

/// A worker executes one call at a time, but laws of motion call each other: the search for an
/// impact calls a step, a step calls a derivative. So each depth has a worker of its own, started
/// at its first call.
struct SandboxedModule {
  struct Depth {
    modules::AnyModule module;         // forwards every call
    std::shared_ptr<void> connection;  // must outlive every call of the module
  };
  Depth search, step, derivative;
};

/// @param file  a source file, or a shared object
/// @throws UserError when it does not compile (with the compiler's message), or the sandbox is not
///   built
SandboxedModule load_sandboxed(const Context& context, const modules::ModuleKind& kind,
                               const std::filesystem::path& file);

}  // namespace tumble::cli
