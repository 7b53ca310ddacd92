/// Which contacts with friction stick and which slide; an event reports each change.
///
/// A pair slides when the force is on the edge of Coulomb's cone at every point where the two push
/// each other and one of these points slips. It sticks when the force is on the edge at none. In
/// between (a box that pivots about a corner) it keeps its mode. The force alone does not decide:
/// on a slope as steep as friction holds it is at its limit and nothing slips. A contact begins
/// sticking; it is a new one where the pair has not pushed for a twentieth of a second. A change
/// that follows a reported one sooner than that is reported at the end of that time, if it still
/// holds: a chattering island does not report every step.
#pragma once

#include <map>

#include "framework/engines/contact/persistent_contacts.h"

namespace tumble::engines {

class ContactModes {
 public:
  ContactModes(MovingWorld& moving, const PersistentContacts& contacts,
               double restitution_threshold, TrajectorySink& sink)
      : moving_(moving),
        contacts_(contacts),
        restitution_threshold_(restitution_threshold),
        sink_(sink) {}

  /// The contacts of the step under way have their forces: tells of pairs that stick or slide from
  /// its beginning on.
  void look();
  /// Whether the pair slides in this step.
  bool slides(PersistentContacts::Pair pair) const;

 private:
  struct Mode {
    bool slides, reported_sliding;
    double told, seen;  // [s]
  };

  double slip_of(const ContactPoint& point);

  MovingWorld& moving_;
  const PersistentContacts& contacts_;
  double restitution_threshold_;  // [m/s]
  TrajectorySink& sink_;
  std::map<PersistentContacts::Pair, Mode> modes_;
};

}  // namespace tumble::engines
