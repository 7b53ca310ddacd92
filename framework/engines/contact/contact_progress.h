/// What ends a run whose contacts would be solved for ever.
#pragma once

#include <vector>

#include "framework/engines/contact/contact_island.h"
#include "framework/engines/contact/contact_memory.h"
#include "framework/engines/stepping/moving_world.h"

namespace tumble::engines {

class ContactProgress {
 public:
  ContactProgress(const MovingWorld& moving, ContactMemory& memory)
      : moving_(moving), memory_(memory) {}

  /// A problem has stayed unsolved. Where a driven body presses the island against another, shorter
  /// parts of the step have the same one.
  /// @throws StoppedRun
  void require_room(const ContactIsland& island, double residual);
  /// A step has been cut once more. Contacts that ask for ever shorter ones, or problems that all
  /// stay unsolved, would take hours.
  /// @throws StoppedRun
  void require(const std::vector<ContactIsland>& islands);

 private:
  std::vector<int> driven_against(const ContactIsland& island) const;

  const MovingWorld& moving_;
  ContactMemory& memory_;
};

}  // namespace tumble::engines
