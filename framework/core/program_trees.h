/// Where a program finds the course: in the source tree that it was built from, or where a package
/// put it.
#pragma once

#include <filesystem>

namespace tumble {

struct ProgramTrees {
  std::filesystem::path root;   // assignments/, models/, tests/, handouts/, headers of framework/
  std::filesystem::path build;  // programs in bin/, shared objects in modules/
  bool is_installed = false;    // from a package: neither tree can be written
};

/// The trees of the program that runs. `build` is the folder above the one with the program. A
/// package has a file tree.txt there, whose first line leads from `build` to `root`; without it
/// TUMBLE_ROOT names the root (the launcher sets it), or else the root is the folder above `build`.
/// @throws UserError where tree.txt leads to no folder
ProgramTrees find_trees();

}  // namespace tumble
