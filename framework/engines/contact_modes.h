/// Which contacts with friction stick and which slide, told as events where that changes.
///
/// A pair slides when the force is on the edge of Coulomb's cone at every point where the two push each other, sticks when at none, and
/// keeps its mode in between (a box that pivots about a corner). A contact begins sticking; it is a new one where the pair has not
/// pushed for a twentieth of a second. What changes again sooner than that after it was told is told then, if it has not changed
/// back: a heap that chatters does not tell of every step.
#pragma once

#include <map>

#include "framework/engines/lasting_contacts.h"

namespace tumble::engines {

class ContactModes {
 public:
  ContactModes(const LastingContacts& contacts, TrajectorySink& sink) : contacts_(contacts), sink_(sink) {}

  /// The contacts of the step that begins at `time` have their forces: tells of pairs that stick or slide from there on.
  void look(double time);
  /// Whether the pair slides in this step.
  bool slides(LastingContacts::Pair pair) const;

 private:
  struct Mode {
    bool slides, told_sliding;
    double told, seen;           // [s]
  };

  const LastingContacts& contacts_;
  TrajectorySink& sink_;
  std::map<LastingContacts::Pair, Mode> modes_;
};

}  // namespace tumble::engines
