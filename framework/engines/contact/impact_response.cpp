#include "framework/engines/contact/impact_response.h"

namespace tumble::engines {

void begin_slow_contacts(const TouchingPairs& touching, const std::vector<Event>& events, const SequentialImpacts& impacts, const World& world, LastingContacts& contacts) {
  for (const TouchingPair& pair : touching.all) {
    bool slow = true;
    for (const Event& event : events)
      if (event.body_a == pair.a && event.body_b == pair.b) slow = slow && impacts.stays(world, pair, -event.normal_velocity_before);
    if (slow) contacts.begin({pair.a, pair.b}, pair.gap);
  }
}

}  // namespace tumble::engines
