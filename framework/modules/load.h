/// Second implementation of a module: a shared object, loaded at run time. For the user's own
/// machine; a judge never calls this.
#pragma once

#include <filesystem>
#include <memory>

#include "framework/modules/names.h"

namespace tumble::modules {

/// A table of functions of some module, its type known to the registration only.
using AnyModule = std::shared_ptr<const void>;

/// @param file  a shared object built from a file that implements the module's header
/// @throws UserError when the file is missing, cannot be loaded, or exports no table of this module
AnyModule load_module(const ModuleName& module, const std::filesystem::path& file);

}  // namespace tumble::modules
