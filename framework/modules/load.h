/// Second implementation of a module: a shared object, loaded at run time. For the user's own
/// machine; a judge never calls this.
#pragma once

#include <filesystem>

#include "framework/modules/registry.h"

namespace tumble::modules {

/// @param file  a shared object built from a file that implements the module's header
/// @throws UserError when the file is missing, cannot be loaded, or exports no table of this module
AnyModule load_module(const ModuleKind& kind, const std::filesystem::path& file);

}  // namespace tumble::modules
