/// Laws of the teaching timewarp's tests: decisions by the reference's module.
#pragma once

#include "tests/support/places.h"
#include "assignments/a4_timewarp/a4_binding.h"
#include "framework/modules/load.h"
#include "framework/modules/registry.h"
#include "tests/engines/reference_laws.h"

namespace tumble::testing {

/// Impulses by code independent of any solution, decisions by the reference.
inline Laws taught_laws() {
  modules::Registry registry;
  register_assignments(registry);
  Laws laws = test_laws();
  const auto file = std::filesystem::path(test::binary_dir()) / "modules" / "a4_reference.so";
  a4::bind(
      *std::static_pointer_cast<const a4::Module>(modules::load_module(registry.find("a4"), file)),
      laws);
  return laws;
}

/// All laws from the reference: for scenes with links and persistent contacts.
inline Laws taught_reference_laws() {
  Laws laws = reference_laws();
  laws.scheduling = taught_laws().scheduling;
  return laws;
}

/// An impact after this time is found and then lost.
inline void lose_impacts_after(double time_s, Laws& laws) {
  laws.scheduling.on_collision_check = [right = laws.scheduling.on_collision_check, time_s](
                                           const ScheduledEvent& event, CheckFinding finding,
                                           double step) {
    if (finding.contact && finding.contact->time > time_s) finding.contact.reset();
    return right(event, finding, step);
  };
}

}  // namespace tumble::testing
