#include "framework/modules/registry.h"

#include "framework/core/error.h"

namespace tumble::modules {

const ModuleKind& Registry::find(const std::string& id) const {
  if (const auto it = kinds_.find(id); it != kinds_.end()) return it->second;
  std::string known;
  for (const auto& [name, kind] : kinds_) known += (known.empty() ? "" : ", ") + name;
  throw UserError(id, "there is no assignment of this name", "Known: " + known + ".");
}

std::vector<const ModuleKind*> Registry::all() const {
  std::vector<const ModuleKind*> kinds;
  for (const auto& [name, kind] : kinds_) kinds.push_back(&kind);
  return kinds;
}

}  // namespace tumble::modules
