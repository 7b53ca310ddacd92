/// The response of a world to an impact: what touches at that instant takes part, and what was slow enough stays together.
#pragma once

#include <utility>
#include <vector>

#include "framework/engines/contact/lasting_contacts.h"
#include "framework/engines/contact/meetings.h"
#include "framework/engines/contact/sequential_impacts.h"

namespace tumble::engines {

/// All pairs that take part in an impact.
struct TouchingPairs {
  std::vector<TouchingPair> all;   // sorted by (a, b)
  std::size_t trigger = 0;         // which of them stopped the step
};

/// Of these pairs the trigger, those that touch, and those in lasting contact: what rests on something touches it.
/// @param pairs  sorted; the trigger is among them
/// @param is_in_contact  (pair) whether a lasting contact keeps the two together
template <class IsInContact>
TouchingPairs touching_pairs(const Meetings& meetings, const std::vector<Meetings::Pair>& pairs, Meetings::Pair trigger, const IsInContact& is_in_contact) {
  TouchingPairs touching;
  for (const Meetings::Pair& pair : pairs) {
    const collision::Gap gap = meetings.gap(pair);
    if (pair != trigger && !is_in_contact(pair) && !(gap.distance <= meetings.touching_distance(pair))) continue;
    if (pair == trigger) touching.trigger = touching.all.size();
    touching.all.push_back({pair.first, pair.second, gap, meetings.touching_points(pair, gap)});
  }
  return touching;
}

/// A pair that touches and whose impacts, if any, were slow enough not to bounce begins a lasting contact.
void begin_slow_contacts(const TouchingPairs& touching, const std::vector<Event>& events, const SequentialImpacts& impacts, const World& world, LastingContacts& contacts);

}  // namespace tumble::engines
