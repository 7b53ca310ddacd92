/// Bodies that rest, slide, roll and are stacked: persistent contacts.
///
/// A pair becomes a persistent contact where a collision would rebound more slowly than the
/// restitution threshold (laws' ends_in_contact), or, with `"plastic_impacts": "in_step"`, as soon
/// as two bodies without restitution come together. It does not bounce, and ends when the bodies
/// separate. One step of an island:
/// 1. The bodies first take the paths that they would take without each other (the laws' method,
///    links included).
/// 2. Contact impulses, spread evenly over the step, keep what touches from approaching:
///    v' = v_free + M^-1 J^T p,  x' = x_free + h/2 M^-1 J^T p,  exact for constant forces. Bodies
///    that rotate meet their contacts at the middle of the step, and fit the surfaces at its end.
///    Where a point becomes active within the step, x' = x + h v' instead, so that the path does
///    not go below the surface and come back. The laws' contact_forces solves islands without
///    friction and links, of at most ContactConstants::many_contacts contacts; the laws'
///    friction_impulses, or where it is empty the framework's solve_contacts, all others.
/// 3. A contact that becomes active within the step faster than ten times the threshold, where
///    impacts are located, ends the step just before it; its perfectly inelastic impact is the
///    first thing of the next. A slower one closes its gap by the step's end. A large
///    island that would cut a step many times for that is solved in steps until it rests, unless
///    the scene says "located": v' acts from the middle of the step on, x' = x + h v'
///    (large_islands.cpp). A pair that stops sliding, or slides back, ends the step there.
/// 4. Position correction removes the overlaps that rotation leaves.
/// Where links leave it open which of several contacts carries a load, it is spread over them most
/// evenly, and friction goes with it (dynamics/contact_spread.h).
///
/// Parts: contact_memory.h (what is kept from step to step), contact_geometry.h (where bodies
/// touch), contact_reach.h (what can meet in a step), contact_island.h (which bodies are solved
/// together), step_contact.h (a point of the step), island_problems.h (an island's problem and who
/// solves it), warm_start.h (impulses that are known), contact_activation.h (contacts that become
/// active within the step), sliding_stop.h (where friction has stopped a pair), pressed_bodies.h
/// (forces that follow a motion which contact stops), large_islands.h, position_correction.h,
/// contact_progress.h (when to give up); here the step, with one island's ends and paths
/// (contact_steps.cpp), its energy (contact_energy.cpp), and whether it may sleep
/// (contact_equilibrium.cpp). Tolerances: contact_constants.h.
/// Sources: J. J. Moreau, CISM 302, 1988; D. Stewart, J. Trinkle 1996; D. Baraff, SIGGRAPH 1994.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "framework/dynamics/contact_problem.h"
#include "framework/engines/contact/contact_activation.h"
#include "framework/engines/contact/contact_progress.h"
#include "framework/engines/contact/contact_reach.h"
#include "framework/engines/contact/large_islands.h"
#include "framework/engines/contact/pair_table.h"
#include "framework/engines/contact/position_correction.h"
#include "framework/engines/contact/pressed_bodies.h"
#include "framework/engines/contact/sliding_stop.h"
#include "framework/engines/contact/step_contact.h"
#include "framework/engines/contact/warm_start.h"

namespace tumble::engines {

class PersistentContacts {
 public:
  using Pair = ContactGeometry::Pair;  // bodies, first < second

  /// @param step  of the scene's grid: tolerances refer to it, however short the steps are that
  /// impacts cut from it [s]
  PersistentContacts(MovingWorld& moving, const Laws& laws, const scene::ContactSpec& rules,
                     double restitution_threshold, double step, RunCounters& counters,
                     TrajectorySink& sink)
      : moving_(moving),
        rules_(rules),
        restitution_threshold_(restitution_threshold),
        step_(step),
        counters_(counters),
        sink_(sink),
        geometry_(moving),
        correction_(moving, geometry_, memory_, restitution_threshold, counters),
        reach_(moving, geometry_),
        pressed_(moving, memory_),
        warm_start_(moving, geometry_, memory_),
        sliding_stop_(moving, geometry_, restitution_threshold, memory_),
        progress_(moving, memory_),
        problems_(moving, laws, rules, restitution_threshold, counters, geometry_, warm_start_,
                  progress_, memory_),
        activation_(moving, laws, restitution_threshold, counters, sink, geometry_, problems_,
                    memory_),
        large_(moving, rules, restitution_threshold, counters, geometry_, reach_, problems_,
               memory_) {
    memory_.longest_step = step;
  }
  PersistentContacts(const PersistentContacts&) = delete;
  PersistentContacts& operator=(const PersistentContacts&) = delete;

  /// A collision has become a persistent contact.
  void begin(Pair pair, const collision::Gap& gap);
  /// Pairs that touch at the start and do not approach faster than the restitution threshold;
  /// overlaps of a rounding are removed.
  void begin_where_touching(const std::vector<Pair>& pairs);
  bool lasts(Pair pair) const { return memory_.persistent.contains(pair); }
  const std::set<Pair>& lasting() const { return memory_.persistent; }
  /// Ends what has come apart where the bodies stand now: within a step that an impact with another
  /// process cuts short, which no commit() has seen.
  void end_where_apart();

  /// Gives the bodies in contact their paths for the step that has begun. It may change committed
  /// velocities, by impulses at the step's start, and send their events, before the step is
  /// committed.
  /// @param candidates  pairs whose boxes meet, sorted
  /// @return a target to begin the step again with; nothing: all have their paths. The same target
  /// where impulses have acted at the step's start; an earlier one where a point becomes active, a
  /// contact stops sliding, a body turns too far, or a shorter step may mend an overlap or a gain
  /// of energy.
  std::optional<double> advance(const std::vector<Pair>& candidates);
  /// Whether nothing is in contact in this step.
  bool empty() const { return points_.empty(); }
  /// Whether the last advance() has kept the two apart, so that no impact is looked for.
  bool keeps(Pair pair) const { return points_.contains(pair); }
  /// All such pairs. @param see  (Pair)
  template <class See>
  void for_each_kept(const See& see) const {
    for (const auto& [pair, points] : points_) see(pair);
  }

  /// Whether an impact between the two is dealt with in the step it falls into, not at its instant.
  bool deals_in_step(Pair pair) const { return plastic(pair); }

  /// After the step was committed: takes back overlaps, ends contacts that have come apart.
  /// @return whether all pairs with a body in contact are known to be apart
  bool commit();
  /// Takes back overlaps among bodies in contact at a time within the step under way: contacts keep
  /// bodies apart at its ends, and on the path between them a body that turns dips in by what is of
  /// second order in the step. Changes nothing but these states.
  void remove_overlaps_within_step(std::vector<RigidBodyState>& states, double t);
  /// The same of any of these pairs that overlap in these states, whatever is in contact in the
  /// step under way; velocities stay.
  void remove_overlaps(const std::vector<Pair>& pairs, std::vector<RigidBodyState>& states,
                       double t);
  const std::vector<ContactPoint>& forces() const { return forces_; }
  /// Farther apart than this the two are in contact no more. [m]
  double open_distance(Pair pair) const { return kContact.open_band * geometry_.margin(pair); }
  /// Friction of a pair: the smaller of the two.
  double friction(Pair pair) const { return geometry_.friction(pair); }
  /// How much farther away than its nearest a point of a pair in contact takes part in an impact
  /// that passes through the pair. [m]
  double impact_band(Pair pair) const { return kContact.impact_band * geometry_.size_of(pair); }

  /// Whether the island is solved in steps, without locating its impacts.
  bool is_large(const ContactIsland& island) const { return large_.is_large(island); }
  /// Whether bodies that are slow may be left where they are: if they stood still, links, contacts
  /// and friction would hold all that acts on them, or would from places nearer than `within`.
  /// Asked after a step was committed; changes nothing, nor what is counted.
  /// @param island  bodies, pairs and links of the step that was committed last
  /// @param within  of the fastest point of its bodies [m]
  bool is_in_equilibrium(const ContactIsland& island, double within);

  /// Goes on from what is remembered of another state; what was known of a step is forgotten.
  void recall(ContactMemory memory);
  /// What contacts pressed bodies with in the last step, its mean, by body: of those on which
  /// forces act that follow their motion; and the same of another state.
  const std::map<int, Wrench>& pressing() const { return memory_.pressing; }
  void expect(int body, const Wrench& pressing) { memory_.pressing[body] = pressing; }
  /// From now on it is kept what a committed step has lost beside what sliding and landing take: of
  /// islands without links and driven supports, whose impacts are not solved in steps.
  void watch_losses() { watches_losses_ = true; }
  /// That of each such island of the step that was committed last; below 0 where sliding and
  /// landing may have taken more than was lost. @param see  (bodies of the island, energy [J])
  template <class See>
  void for_each_loss(const See& see) {
    if (has_committed_)
      for (const Loss& loss : lost_) see(islands_[loss.island].bodies, loss.energy);
    lost_.clear();
  }
  /// Hands over what is remembered; recall() comes before the next step.
  ContactMemory take_memory() { return std::move(memory_); }

 private:
  // ---- Which contacts there are in the step (persistent_contacts.cpp)
  bool plastic(Pair pair) const;
  bool locates() const { return rules_.plastic_impacts != scene::PlasticImpacts::kInStep; }
  std::vector<ContactIsland> islands(const std::vector<Pair>& touching);
  void note_near_pairs(const std::vector<Pair>& candidates);
  StepContacts contacts_of(const ContactIsland& island);
  bool is_apart_by_digits(Pair pair, const collision::ManifoldPoint& point) const;
  bool is_curved(const ContactIsland& island) const;
  bool flies_off(Pair pair, const std::vector<RigidBodyState>& states) const;
  double near_distance(Pair pair, bool lasted, bool is_large,
                       const std::vector<RigidBodyState>& states) const;
  void end(Pair pair, const collision::Gap& gap);
  void remove_overlaps();

  // ---- Whether bodies may sleep (contact_equilibrium.cpp)
  struct Unheld {
    std::vector<Velocity> accelerations;  // by body of the island [m/s^2, rad/s^2]
    double largest = 0.0;                 // of a point of its bodies [m/s^2]
    double unseen = 0.0;                  // as much may be errors of the solution [m/s^2]
  };
  Unheld unheld(const ContactIsland& island, const std::vector<RigidBodyState>& states,
                double moved);
  StepContacts contacts_at_rest(const ContactIsland& island,
                                const std::vector<RigidBodyState>& states, double moved) const;

  // ---- One island's step (persistent_contacts.cpp, contact_steps.cpp)
  std::optional<double> take_steps(double h);
  std::optional<double> take_step(const ContactIsland& island, double h);
  void keep_warm_start(const ContactIsland& island, const StepContacts& contacts,
                       const ContactProblem& problem, const ContactSolution& solution, double h);
  void find_ends(const ContactIsland& island, const ContactProblem& problem,
                 const ContactSolution& solution, double h, bool activation,
                 bool inertia_at_ends = false);
  double largest_turn(const ContactIsland& island, const std::vector<RigidBodyState>& ends,
                      double h) const;
  double turn_of_normals(const ContactIsland& island,
                         const std::vector<RigidBodyState>& ends) const;
  StepContacts contacts_midway(const ContactIsland& island, const StepContacts& contacts);
  bool set_paths(const ContactIsland& island, const StepContacts& contacts,
                 const std::vector<RigidBodyState>& contacts_at, const ContactProblem& problem,
                 const ContactSolution& solution, double h, bool activation);
  void set_straight_path(int body, const RigidBodyState& end);
  struct Loss {
    std::size_t island;
    double energy;  // [J]
  };
  struct StepEnergy {
    double gain = 0.0, unseen = 0.0;  // that contacts have made, and that rounding may [J]
  };
  std::optional<StepEnergy> energy_of(const ContactIsland& island) const;
  void note_loss(const ContactIsland& island, const StepContacts& starts,
                 const ContactProblem& problem, const ContactSolution& solution,
                 const StepEnergy& energy);
  std::optional<double> take_large_island_step(const ContactIsland& island, double h);

  MovingWorld& moving_;
  scene::ContactSpec rules_;
  double restitution_threshold_;  // [m/s]
  double step_;                   // of the scene's grid [s]
  RunCounters& counters_;
  TrajectorySink& sink_;
  ContactMemory memory_;
  ContactGeometry geometry_;
  PositionCorrection correction_;
  ContactReach reach_;
  PressedBodies pressed_;
  WarmStart warm_start_;
  SlidingStop sliding_stop_;
  ContactProgress progress_;
  IslandProblems problems_;
  ContactActivation activation_;
  LargeIslands large_;
  // Of the step that has begun:
  std::vector<ContactIsland> islands_;
  PairTable<ContactManifold> points_;
  std::set<Pair> next_stuck_, next_sharing_;
  std::vector<ContactPoint> forces_;
  bool watches_losses_ = false;
  double began_ = kUnset, target_ = kUnset;  // [s]
  bool has_committed_ = false;
  std::vector<Loss> lost_;  // of the step that has begun
  // By body, of the island whose step is taken: where it comes out, and the middle of the way
  // there. Others stand where the step began; those of islands whose steps have been taken are
  // stale.
  std::vector<RigidBodyState> ends_, midway_;
};

}  // namespace tumble::engines
