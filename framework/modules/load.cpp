#include "framework/modules/load.h"

#include <dlfcn.h>

#include "framework/core/error.h"

namespace tumble::modules {

const void* load_functions(const ModuleName& module, const std::filesystem::path& file) {
  if (!std::filesystem::exists(file))
    throw UserError(file.string(), "there is no such file",
                    "Build it first, or check the path given to --modules.");
  // RTLD_LOCAL: two loaded submissions do not see each other's functions. RTLD_NOW: a missing
  // symbol is reported here.
  void* handle = ::dlopen(std::filesystem::absolute(file).c_str(), RTLD_NOW | RTLD_LOCAL);
  if (handle == nullptr)
    throw UserError(file.string(), std::string("cannot be loaded: ") + ::dlerror());
  using Exported = const void* (*)();
  const auto exported = reinterpret_cast<Exported>(::dlsym(handle, module.exported_name().c_str()));
  if (exported == nullptr)
    throw UserError(file.string(), "defines nothing of " + module.id,
                    "It must be built from a file that includes the header of " + module.folder +
                        ": is that file empty?");
  return exported();
}

}  // namespace tumble::modules
