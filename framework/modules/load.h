/// Second implementation of a module: a shared object, loaded at run time. For the user's own
/// machine; a judge never calls this.
#pragma once

#include <filesystem>
#include <memory>

#include "framework/modules/names.h"

namespace tumble::modules {

/// A table of functions of some module, its type known to the registration only.
using AnyModule = std::shared_ptr<const void>;

/// The addresses that a shared object exports, of the type Module::Addresses. They stay valid as
/// long as the program: it is never unloaded.
/// @param file  built from a file that implements the module's header
/// @throws UserError when the file is missing, cannot be loaded, or exports no such module
const void* load_functions(const ModuleName& module, const std::filesystem::path& file);

/// The table of such addresses.
template <class Module>
AnyModule module_of(const void* functions) {
  return std::make_shared<const Module>(
      Module::of(*static_cast<const typename Module::Addresses*>(functions)));
}

}  // namespace tumble::modules
