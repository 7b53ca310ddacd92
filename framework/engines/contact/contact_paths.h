/// The part of a step that contacts decide: paths for bodies in lasting contact, and which pairs are left to be searched for impacts.
#pragma once

#include <vector>

#include "framework/engines/contact/lasting_contacts.h"
#include "framework/engines/contact/meetings.h"

namespace tumble::engines {

/// Pairs of a step that has begun.
struct PairsOfStep {
  std::vector<Meetings::Pair> searched;   // for their first impact
  std::vector<Meetings::Pair> near;       // all that may meet on the paths that contacts have given; empty where nothing is in contact
};

/// Gives bodies in lasting contact their paths. Where a contact asks for a shorter step, the step begins again with it.
/// @param pairs  `searched`: pairs whose boxes meet in the step; becomes what is left when contacts keep theirs apart
/// @param begin_again  (target) begins the step again; false: the step ends where it began
/// @return false where begin_again has said so
template <class BeginAgain>
bool keep_contacts(LastingContacts& contacts, Meetings& meetings, PairsOfStep& pairs, const BeginAgain& begin_again) {
  while (const auto earlier = contacts.advance(pairs.searched)) {
    if (!begin_again(*earlier)) return false;
    pairs.searched = meetings.candidates();
  }
  if (contacts.empty()) return true;
  pairs.near = pairs.searched = meetings.candidates();   // the paths are others now
  std::erase_if(pairs.searched, [&](const Meetings::Pair& pair) { return contacts.keeps(pair); });
  return true;
}

/// At the committed end of a step: what rounding, turning and contacts have left of overlaps is taken back.
/// @param contacts  null: the scene asks for none
inline void take_back_overlaps(LastingContacts* contacts, Meetings& meetings, const PairsOfStep& pairs) {
  if (!meetings.apart_at_target()) meetings.separate(pairs.searched);
  if (contacts && !contacts->commit()) meetings.separate(pairs.near);
}

}  // namespace tumble::engines
