/// A submission as laws of a scene: compiled and called in the sandbox, never loaded into this process.
#pragma once

#include <filesystem>
#include <memory>

#include "framework/cli/verb.h"

namespace tumble::cli {

struct SandboxedModule {
  modules::AnyModule module;         // forwards every call
  std::shared_ptr<void> connection;  // must outlive every call of the module
};

/// @param file  a source file, or a shared object
/// @throws UserError when it does not compile (with the compiler's words), or the sandbox is not built
SandboxedModule load_sandboxed(const Context& context, const modules::ModuleKind& kind, const std::filesystem::path& file);

}  // namespace tumble::cli
