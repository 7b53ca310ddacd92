/// What happens at the instant of an impact: the sequential law.
///
/// One round visits all pairs that touch at that instant, in the order of their body indices. A
/// pair that approaches gets the impulse of the laws at the middle of the region where the two
/// touch, or, when the middle does not approach, at the corner of that region that approaches
/// fastest. With friction all corners of the pair are struck together: friction at the middle alone
/// would turn a box that lands flat, which its corners can bear. Rounds follow until no pair
/// approaches faster than round-off. For equal balls in a row and restitution 1 this is Newton's
/// cradle. With restitution below 1 the outcome depends on the order, which is therefore part of
/// the law; where two impacts of one body at one instant give another result in the opposite order,
/// a notice says so, of the first eight rounds.
///
/// Bodies on rods and joints: the impulse acts on the constrained system (impact_bodies.h). Its
/// size is that of the laws' collision_impulse for the free bodies, times K_free / K_held, so that
/// the normal velocity after the links' reactions has the restitution. Friction is solved together
/// with the normal impulse (dynamics/point_impact.h), so that both laws hold afterwards and no
/// impact creates energy; what push_apart does is no impact.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "framework/dynamics/contact_problem.h"
#include "framework/engines/contact/impact_bodies.h"
#include "framework/engines/stepping/moving_world.h"

namespace tumble::engines {

/// The subject of what a run says of them (RunWatch::say).
inline constexpr const char* kOrderOfImpacts = "order of impacts";

/// Two bodies that touch at the committed time.
struct TouchingPair {
  int a, b;  // a < b
  collision::Gap gap;
  // the middle of where they touch, then its corners, if it is more than a point
  std::vector<Vector3d> points_world;
};

/// What one resolution did.
struct Resolution {
  // one an impulse, in order; of an impact that bodies hand to and fro many times one a pair
  std::vector<Event> events;
  bool settled = true;  // false: the rounds did not end
  // pairs that meet again at once, or met without an impulse: see push_apart
  std::vector<TouchingPair> micro_impacts;
};

struct ImpactRules {
  double restitution_threshold;  // [m/s]
  // a pair that meets again within this, slower than the restitution threshold, has a micro-impact
  // [s]
  double micro_interval;
};

class SequentialImpacts {
 public:
  SequentialImpacts(const Laws& laws, ImpactRules rules, RunCounters& counters)
      : laws_(laws), rules_(rules), counters_(counters) {}

  /// Impacts that would rebound more slowly than the restitution threshold (laws' ends_in_contact)
  /// do not rebound: they begin a persistent contact. Pairs with friction slide less after an
  /// impact: Coulomb's law for the impulse, against the slip that is left. With the simultaneous
  /// law all touching pairs are solved together (Newton's law of restitution as complementarity): a
  /// row of equal balls hit by one then leaves with (-3/5, 2/5, 2/5, 2/5, 2/5) of its speed, not as
  /// Newton's cradle does. Where restitution at several points would create energy (unequal
  /// restitutions, friction), as much of it is taken as creates none: on the line from there to the
  /// answer without friction, or, where that creates energy too, to the one without rebound.
  void use_contact_rules(double restitution_threshold, scene::ImpactLaw law) {
    contact_threshold_ = restitution_threshold;
    law_ = law;
  }
  /// When pairs met last: what a run that goes on from another time has to know. [s]
  const std::map<std::pair<int, int>, double>& last_impacts() const { return last_impacts_; }
  void remember(std::map<std::pair<int, int>, double> last_impacts) {
    last_impacts_ = std::move(last_impacts);
  }
  /// Whether an impact of the pair at this speed begins a persistent contact.
  bool stays(const World& world, const TouchingPair& pair, double approach_speed) const;

  /// @param pairs    sorted by (a, b)
  /// @param trigger  which of them stopped the step
  Resolution resolve(MovingWorld& moving, const std::vector<TouchingPair>& pairs,
                     std::size_t trigger);

  /// Separates the pairs that had a micro-impact at the restitution threshold u, where they
  /// separate more slowly, and with them the touching pairs of bodies that this moves: else a stack
  /// would be pushed back and forth within one instant. Without a persistent contact, a pair that
  /// gravity or rotation presses together would meet infinitely often in no time. A body that rests
  /// on another therefore rises by up to u^2 / 2g; this separation impulse adds an energy of the
  /// order of m u^2, which the next impact removes where restitution is below 1.
  void push_apart(MovingWorld& moving, const std::vector<TouchingPair>& touching,
                  const std::vector<TouchingPair>& micro_impacts);

 private:
  struct Work;
  bool push_pair_apart(Work& work, const TouchingPair& pair);
  bool collide(Work& work, const TouchingPair& pair, double threshold);
  /// Impacts whose order decides: two of one body at one instant.
  struct Tie {
    int body, round;
    const TouchingPair *one, *two;
  };
  // ties: null, or where the first of each of the first rounds is put; turned_from: the round from
  // which on pairs are visited backwards
  bool collide_in_turn(Work& work, std::vector<const TouchingPair*> in_turn, double threshold,
                       std::vector<Tie>* ties, int turned_from = 0);
  std::optional<Tie> tie_of(Work& work, const std::vector<const TouchingPair*>& pairs,
                            double threshold, int round);
  void watch_order(Work& work, const Tie& tie, const std::vector<TouchingPair>& pairs,
                   double threshold);
  double friction_at_impact(const World& world, const TouchingPair& pair) const;
  ContactSolution solve_without_gain(const ContactProblem& problem);
  void note_unsolved(const MovingWorld& moving, const std::vector<int>& bodies,
                     const ContactSolution& solution);
  // false: none approaches
  bool collide_together(Work& work, const std::vector<const TouchingPair*>& pairs, double threshold,
                        bool rebounds);

  const Laws& laws_;
  ImpactRules rules_;
  RunCounters& counters_;
  std::map<std::pair<int, int>, double> last_impacts_;
  std::optional<double> contact_threshold_;  // [m/s]
  scene::ImpactLaw law_ = scene::ImpactLaw::kSequential;
};

}  // namespace tumble::engines
