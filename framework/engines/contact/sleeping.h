/// Bodies at rest that are left alone until something touches them (`"sleep": true` of a scene's
/// contact).
///
/// An island sleeps or wakes as a whole. It falls asleep when for half a second none of its bodies
/// was faster than a tenth of the restitution threshold, or left its position by more than a
/// hundredth of the distance that the threshold makes in that time: 5 um at the default threshold,
/// 1 mm/s. A contact solver leaves that much motion in large islands and, without friction, in
/// stacks. Where a pair of the island slides with friction, the limit is a hundredth of that: 1e-7
/// m/s, the creep that a sticking contact is allowed; and for a body that lies by itself, whose
/// contacts are solved to rounding: nothing brakes what glides without friction or rolls. Something
/// immovable must hold the island, too: a body at the top of its path is slow for a while, and not
/// at rest.
///
/// Slow is not at rest either where a damper, drag or a motor brakes what a force still draws, or
/// where the force is faint: an island stays awake unless contacts, friction, rods and joints would
/// hold all that acts on its bodies if they stood still, or would from places nearer than those 5
/// um (contact_equilibrium.cpp). Where they would not it is asked again after another half second.
/// What no force draws or brakes is at rest as far as speed tells: several bodies that glide over a
/// smooth floor together more slowly than that, or swing so slowly past their equilibrium, are
/// stopped, and told of (energy_loss.h).
///
/// Asleep, a body keeps its position to the last bit and its velocity is zero. It is not
/// integrated, its contacts are not solved, and it is no candidate with others that do not move.
/// The forces of its contacts in the last step stay on record. An island wakes at the beginning of
/// the step in which something moving meets it (that step is then taken with the island awake: the
/// impact acts as on bodies that never slept), when a force on one of its bodies is switched, or
/// when a motor's law asks for another torque. Bodies that rest on a driven body, or are linked to
/// one, do not sleep.
///
/// Sleep removes the kinetic energy of the last half second: less than m v^2 / 2 at a tenth of the
/// restitution threshold.
#pragma once

#include <map>
#include <utility>
#include <vector>

#include "framework/engines/contact/contact_modes.h"

namespace tumble::engines {

class Sleepers {
 public:
  using Pair = PersistentContacts::Pair;

  /// @param modes  null where no contact has friction
  Sleepers(MovingWorld& moving, PersistentContacts& contacts, const ContactModes* modes,
           double restitution_threshold, RunCounters& counters, TrajectorySink& sink);

  /// After a step: puts the groups to sleep that have been still long enough.
  /// @param touching  pairs in contact in this step
  /// @return the bodies that fell asleep
  std::vector<int> look(const std::vector<Pair>& touching);

  /// Before a step's contacts: wakes groups that something moving will be in contact with.
  /// @return whether there were any: the step is to be begun again
  bool wake_approached(const std::vector<Pair>& candidates);
  /// Wakes the groups of both bodies, if they sleep. @return whether one did
  bool wake(Pair pair);
  /// Wakes a body's group, if it sleeps. @param waker  what met it; -1 for a force or a control law
  bool wake(int body, int waker);
  /// Wakes groups whose control laws drive them otherwise than before.
  void wake_where_control_changes();

  /// Appends what the contacts of the sleeping groups carried in their last step.
  void append_forces(std::vector<ContactPoint>& forces) const;

 private:
  struct Place {
    double since;        // it was last seen to have left its place [s]
    Vector3d com_world;  // then
    Quaterniond world_from_body;
  };
  struct Stillness {
    Place roughly, strictly;
  };
  struct Group {
    std::vector<int> bodies;  // ascending
    std::vector<Pair> pairs;  // in contact
    std::vector<int> linked;  // places in linked_groups()
    std::vector<ContactPoint> forces;
    // by something that does not move; by something that moves by its own law
    bool held = false, driven = false;
    bool slides = false;

    bool is_alone() const { return bodies.size() == 1 && linked.empty(); }
  };

  void watch(int body);
  bool is_still(const Group& group, double since) const;
  bool is_in_equilibrium(const Group& group);
  void watch_control(int linked);
  bool is_driven_otherwise(int linked) const;
  std::map<int, Group> groups_of(const std::vector<Pair>& touching) const;
  void put_to_sleep(Group group);
  bool would_touch(Pair pair);

  MovingWorld& moving_;
  PersistentContacts& contacts_;
  const ContactModes* modes_;
  double restitution_threshold_;  // [m/s]
  RunCounters& counters_;
  TrajectorySink& sink_;
  std::vector<Stillness> still_;  // by body
  // by linked group: what its control laws held when that last changed
  std::vector<std::map<int, effects::Memory>> held_;
  std::map<int, Group> asleep_;  // by first body
  std::vector<int> group_of_;    // by body: key in asleep_, -1
};

}  // namespace tumble::engines
