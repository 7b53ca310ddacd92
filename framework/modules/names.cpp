#include "framework/modules/names.h"

#include "framework/core/error.h"

namespace tumble::modules {

const ModuleName& find_name(const std::vector<ModuleName>& names, const std::string& id) {
  std::string known;
  for (const ModuleName& name : names) {
    if (name.id == id) return name;
    known += (known.empty() ? "" : ", ") + name.id;
  }
  throw UserError(id, "there is no assignment of this name", "Known: " + known + ".");
}

}  // namespace tumble::modules
