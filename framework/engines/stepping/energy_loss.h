/// Energy that is lost where nothing takes any.
///
/// The bodies of a world are parted into those that springs, rods, joints, drag and motors link;
/// between impacts and contacts none of these parts gives another anything. For each a ledger is
/// kept,
///   A = T + V - W + D                                                                    (1)
/// with W what effects have brought in, at least (effects::WorkMeter), and D what drag, dampers and
/// water have taken, at most (Effect::power_taken). Nothing makes A smaller than it was but the
/// method: damping of the step, projections, links of which two hold the same.
///
/// What a part is given or loses where it is hit, in persistent contact, or while a force begins or
/// ends between two looks, is counted neither way: A stands still from the look before to the one
/// after. Impacts are judged by themselves (`impact_energy`, judging/judge.h); what steps of bodies
/// that touch lose beside what sliding and landing take (contact/contact_energy.cpp) has a ledger
/// of its own, for all bodies that have touched each other: what rolls or rests loses nothing.
/// What hangs on driven bodies that all move alike is seen from a frame that moves along: there
/// they stand still. Where the frame is shaken, inertial forces -m a(t) act in it, like gravity
/// that changes, and what they do is part of W. Where bodies are driven, and the energy of the
/// world says nothing, a part's own energy must not rise either.
/// Not watched: what is linked with bodies that are driven differently, what an effect acts on that
/// says of no entry what it takes (effects::Takes::kUnknown), balls at rest without contacts; and
/// where looks are taken at frames (event engines), what motors and streams drive, what forces that
/// begin between two frames act on until they end, what hangs on what is shaken, what driven bodies
/// damp, and islands of scenes whose impacts are solved in steps. What dampers, drag and water take
/// is summed there over the steps between two looks (pass), where that matters.
#pragma once

#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "framework/core/disjoint_sets.h"
#include "framework/dynamics/world.h"
#include "framework/effects/effect.h"
#include "framework/effects/invariants.h"
#include "framework/trajectory/trajectory.h"

namespace tumble::engines {

/// What one part of a world has lost.
struct LostEnergy {
  std::vector<int> bodies;  // of the part
  double lost, whole;       // how much, of what moved, was stored or came down there at most [J]
  double time, watched;     // when, and until when it was looked at [s]
  bool is_sudden;           // half of it or more between two looks
  bool is_by_sleep;         // bodies of the part fell asleep between these two looks
  // by steps in which the bodies, which are of several parts, touched each other or what stands
  bool is_at_contacts = false;
};

/// What one part of a world has won that nothing brings in.
struct RisenEnergy {
  std::vector<int> bodies;  // of the part
  double risen, whole;      // as of LostEnergy [J]
  double time;              // when [s]
};

class EnergyLoss {
 public:
  /// @param sees_switches  as EnergyWatch is asked
  explicit EnergyLoss(bool sees_switches) : sees_switches_(sees_switches) {}

  /// Bodies that are hit, or touch, since the last look.
  void note(const Event& event);
  void note_touch(int a, int b) {
    touched_.push_back(a);
    touched_.push_back(b);
  }
  /// A body that has fallen asleep since the last look.
  void note_sleep(int body) { fell_asleep_.push_back(body); }
  /// A step of these bodies, which touch, has lost this beside what sliding and landing take. [J]
  /// @pre it has been looked once
  void note_lost_at_contacts(const std::vector<int>& bodies, double energy);
  /// Calls pass() for the part of a body at instants between the last look and this.
  /// @return whether these are known
  using PassSteps = std::function<bool(int body)>;
  /// @param brought     by effects since the last look, by body; empty: nothing
  /// @param pass_steps  asked where a part lost more than was taken, by what is known of the
  /// looks alone; empty: a look is taken at each step
  /// @return whether more is lost than before that may have to be told
  bool look(double time, const World& world, const std::vector<RigidBodyState>& states,
            const EnergyByBody& energy, const std::vector<effects::Work>& brought,
            const PassSteps& pass_steps = {});
  /// Whether drag, dampers or water take energy from any part that is watched.
  bool has_damped() const {
    return std::any_of(parts_.begin(), parts_.end(),
                       [](const Part& part) { return part.is_watched && !part.takers.empty(); });
  }
  /// Where a body that is damped, and all of its part, are between two looks: what is taken is
  /// known the better for it. Times do not go back. @param states  by body: of those alone
  void pass(double time, int body, const World& world, const std::vector<RigidBodyState>& states) {
    Part* part = part_with(body);
    if (part && part->power_at != time) take(*part, time, power_of(*part, world, states));
  }
  double last_look() const { return last_look_; }  // [s]
  /// The world has other entries from now on.
  void begin_again() { is_begun_ = false; }

  /// What is more than this part of the whole and of what a rounding leaves, in the order of parts
  /// and of time.
  /// @param rounding  of the world's energy [J]
  std::vector<LostEnergy> losses(double rounding) const;
  /// The same of energy that has risen.
  std::vector<RisenEnergy> rises(double rounding) const;

 private:
  static constexpr int kWorld = -1;
  /// A part as a frame sees it that moves as a driven body does: what tells the work of inertial
  /// forces between two looks. World axes.
  struct Seen {
    Vector3d displacement = Vector3d::Zero(), velocity = Vector3d::Zero(),
             acceleration = Vector3d::Zero();  // of the frame [m], [m/s], [m/s^2]
    Vector3d first_moment = Vector3d::Zero();  // sum of m x [kg m]
    Vector3d momentum = Vector3d::Zero();      // [kg m/s]
  };
  struct Loss {
    double time, size;  // [s], [J]
    bool is_sudden, is_by_sleep;
  };
  struct Taker {
    const effects::Effect* effect;
    int entry;
  };
  struct Part {
    std::vector<int> bodies;
    bool is_watched = true, is_touched = false, fell_asleep = false;
    // the frame that it is seen from: an immovable body that it is linked with, or kWorld
    std::optional<int> frame;
    Seen seen;
    // [J]: E = T + V now; of A and of A with W at most and without D, what they are above E, and
    // how far they have been
    double energy = kUnset, offset = 0.0, highest = 0.0, offset_of_rises = 0.0, least = 0.0;
    double highest_place = -kInfinity, whole = 0.0, rise = 0.0, largest_fall = 0.0;
    double risen_at = kUnset;  // [s]
    std::vector<Taker> takers;
    // that is taken, when it was asked last [W], [s]; and at most, since the last look [J]
    double power = kUnset, power_at = kUnset, taken = 0.0;
    std::vector<Loss> losses;  // each larger than the one before
  };
  /// Bodies that have touched each other, directly or through others, and what steps have made of
  /// their energy beside what contacts take.
  struct Heap {
    std::vector<int> bodies;
    double made = 0.0, highest = 0.0;  // now, and the most that it has been [J]
    double whole = 0.0;                // of their parts, at the last look [J]
    bool is_changed = true;            // since the last look
    std::vector<Loss> losses;          // each larger than the one before
  };
  Heap& heap_of(const std::vector<int>& bodies);
  bool look_at_heaps(double time);
  void begin(const World& world);
  Part* part_with(int body);  // nullptr: it does not move
  static double power_of(const Part& part, const World& world,
                         const std::vector<RigidBodyState>& states);
  static void take(Part& part, double time, double power);
  static Seen seen_from(const WorldBody& frame, double time);
  static effects::Work inertial_work(const Seen& before, const Seen& after, double passed);

  bool sees_switches_, is_begun_ = false;
  double last_look_ = kUnset;  // [s]
  std::vector<int> part_of_;   // by body; -1: immovable
  std::vector<Part> parts_, former_;
  DisjointSets met_{0};        // bodies that have touched
  std::map<int, Heap> heaps_;  // by the first of their bodies
  std::vector<Heap> former_heaps_;
  std::vector<int> parts_of_heap_;          // while one is looked at
  std::vector<int> touched_, fell_asleep_;  // bodies, since the last look
  std::vector<int> resting_;  // the same, since the beginning; how many of them are left out
  std::size_t left_out_ = 0;
};

}  // namespace tumble::engines
