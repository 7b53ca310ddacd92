/// The laws of all reference modules, as in a run of the course's scenes.
#pragma once

#include "tests/support/places.h"
#include "assignments/a1_impulse/a1_binding.h"
#include "assignments/a2_integration/a2_binding.h"
#include "assignments/a3_constraints/a3_binding.h"
#include "framework/modules/load.h"
#include "framework/modules/registry.h"
#include "tests/engines/scenes.h"

namespace tumble::testing {

inline Laws reference_laws() {
  modules::Registry registry;
  register_assignments(registry);
  const std::filesystem::path built = std::filesystem::path(test::binary_dir()) / "modules";
  const auto load = [&](const char* id, const char* file) {
    return modules::load_module(registry.find(id), built / file);
  };
  Laws laws = library_laws();
  a1::bind(*std::static_pointer_cast<const a1::Module>(load("a1", "a1_reference.so")), laws);
  a2::bind(*std::static_pointer_cast<const a2::Module>(load("a2", "a2_reference.so")), laws);
  a3::bind(*std::static_pointer_cast<const a3::Module>(load("a3", "a3_reference.so")), laws);
  return laws;
}

}  // namespace tumble::testing
