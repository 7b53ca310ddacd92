/// The scene that shows best what an assignment is about.
#pragma once

#include <string>

namespace tumble::live {

/// Noted in the registration of a module (Registry::set_note).
struct Showcase {
  std::string scene;  // a bare name; empty: the first of the assignment's scenes
};

}  // namespace tumble::live
