// Every assignment by name, a line each; register.cpp says what they are made of.
#include "framework/modules/names.h"

namespace tumble {

const std::vector<modules::ModuleName>& assignment_names() {
  static const std::vector<modules::ModuleName> names = {
      {"a1", "a1_impulse", "Impulse"},
      {"a2", "a2_integration", "Integration"},
      {"a3", "a3_constraints", "Constraints"},
      {"a4", "a4_timewarp", "Timewarp"},
  };
  return names;
}

}  // namespace tumble
