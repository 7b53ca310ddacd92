/// What is known of a module by its name alone: enough for its files and its programs, without its
/// header.
#pragma once

#include <string>
#include <vector>

namespace tumble::modules {

struct ModuleName {
  std::string id;      // "a1"
  std::string folder;  // "a1_impulse": below assignments/, solutions_private/ and tests/
  std::string title;   // for people

  /// C symbol of a shared object that gives the addresses of its functions (module.h).
  std::string exported_name() const { return "tumble_functions_" + id; }
};

/// @throws UserError naming the known ids
const ModuleName& find_name(const std::vector<ModuleName>& names, const std::string& id);

}  // namespace tumble::modules

namespace tumble {
/// Every assignment of the tree, in their order: assignments/CMakeLists.txt finds their folders.
const std::vector<modules::ModuleName>& assignment_names();
}  // namespace tumble
