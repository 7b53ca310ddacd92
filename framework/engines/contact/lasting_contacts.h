/// Bodies that lie, slide, roll and are stacked: contacts that last.
///
/// A pair becomes a lasting contact where a collision would rebound more slowly than the rest speed (laws' ends_in_contact), or, with
/// `"plastic_impacts": "in_step"`, as soon as two bodies without restitution come together. Every step the bodies first go where they
/// would without each other (the laws' method, links included); then contact impulses, spread evenly over the step, keep what touches from
/// approaching: v' = v_free + M^-1 J^T p, x' = x_free + h/2 M^-1 J^T p, which is exact for constant forces. Bodies that turn meet their
/// contacts at the middle of the step, and fit the surfaces at its end. A point that comes down faster than the rest speed ends the step
/// there and strikes a blow without rebound; a slower one is let down by the step's end. A heap that would cut a step many times for that
/// goes in steps until it lies, unless the scene says "located". A pair that stops sliding ends the step there. Frictionless groups ask the laws' contact_forces; friction, links
/// inside a group, and large groups the framework's solve_contacts. What turning leaves of an overlap is taken back by the smallest shift
/// of the group. A lasting contact does not bounce; it ends when the bodies come apart.
///
/// Contacts are kept a shell apart, 1e-10 of the smaller body: gaps are never negative.
/// Sources: J. J. Moreau, CISM 302, 1988; D. Stewart, J. Trinkle 1996; D. Baraff, SIGGRAPH 1994.
#pragma once

#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "framework/collision/near_points.h"
#include "framework/dynamics/contact_problem.h"
#include "framework/engines/stepping/moving_world.h"

namespace tumble::engines {

/// An orientation after a turn, given as axis times angle in the world frame. [rad]
Quaterniond turned(const Quaterniond& world_from_body, const Vector3d& turn_world);

/// How far lasting contacts are kept apart, as a part of the smaller body's radius: far above rounding, far below what is seen or measured.
inline constexpr double kContactMargin = 1e-10;

class LastingContacts {
 public:
  using Pair = std::pair<int, int>;   // bodies, first < second

  LastingContacts(MovingWorld& moving, const Laws& laws, const scene::ContactSpec& rules, double rest_speed, RunCounters& counters, TrajectorySink& sink)
      : moving_(moving), laws_(laws), rules_(rules), rest_speed_(rest_speed), counters_(counters), sink_(sink) {}

  /// A collision has become a lasting contact.
  void begin(Pair pair, const collision::Gap& gap);
  /// Pairs that touch at the start and do not approach faster than the rest speed; overlaps of a rounding are taken back.
  void begin_where_touching(const std::vector<Pair>& pairs);
  bool lasts(Pair pair) const { return lasting_.contains(pair); }
  const std::set<Pair>& lasting() const { return lasting_; }

  /// Gives the bodies in contact their paths for the step that has begun. @param candidates  pairs whose boxes meet, sorted
  /// @return an earlier target to begin the step again with: where a contact stops sliding
  std::optional<double> advance(const std::vector<Pair>& candidates);
  /// Whether nothing is in contact in this step.
  bool empty() const { return points_.empty(); }
  /// Whether the last advance() has kept the two apart, so that no impact is looked for.
  bool keeps(Pair pair) const { return points_.contains(pair); }

  /// Whether a blow between the two is dealt with in the step it falls into, not at its instant.
  bool deals_in_step(Pair pair) const { return plastic(pair); }

  /// After the step was committed: takes back overlaps, ends contacts that have come apart.
  /// @return whether all pairs with a body in contact are known to be apart
  bool commit();
  /// Takes back overlaps among bodies in contact at a time within the step under way: contacts keep bodies apart at its ends, and on the
  /// path between them a body that turns dips in by what is of second order in the step. Changes nothing but these states.
  void open_gaps(std::vector<RigidBodyState>& states, double t);
  /// The same of any of these pairs that overlap in these states, whatever is in contact in the step under way; velocities stay.
  void draw_apart(const std::vector<Pair>& pairs, std::vector<RigidBodyState>& states, double t);
  const std::vector<ContactPoint>& forces() const { return forces_; }
  /// Friction of a pair: the smaller of the two.
  double friction(Pair pair) const;

 private:
  using Points = std::vector<collision::NearPoint>;
  struct Warm {
    Vector3d point_body_a, impulse_world;
    double duration;             // of the step it was spread over [s]
  };
  struct Group {
    std::vector<int> bodies;     // that can move, ascending
    std::vector<Pair> pairs;     // in contact
    std::vector<Pair> near;      // pairs with a body of the group that may meet in the step; those in contact among them
    std::vector<int> linked;     // places in linked_groups()
    bool pile = false;           // many bodies, asked for in steps: contact_piles.cpp
  };
  struct Touch {
    Pair pair;
    collision::NearPoint point;
    double target;               // least normal velocity afterwards [m/s]
    bool lands;                  // apart at the start of the step
    Vector3d slip_target_world = Vector3d::Zero();   // [m/s], see PushingContact
    double start_gap = 0.0;      // at the start of the step, wherever `point` is looked at [m]
  };

  struct Faced {                 // a pair's points as they were when it was last asked for them
    Points points;
    double reach = -1.0;         // all up to here [m]; negative: never asked
    double moved = 0.0;          // by any point of the two since, at most [m]
  };

  struct Landing {
    std::size_t touch;           // which
    double time, speed;          // since the step's start [s], with which it comes down [m/s]
    double approach;             // at the step's start [m/s]
    bool within;                 // the step
  };
  struct Held {                  // a point that pushes to the step's end
    Pair pair;
    collision::NearPoint point;
    const std::vector<RigidBodyState>* at;   // where the bodies are when it is there
  };

  // Of the longest step: ends of sliding that come sooner are taken with it.
  static constexpr double kShortest = 1e-6;
  // Of the longest step: one that gains energy is not cut below this.
  static constexpr double kShortestForEnergy = 1.0 / 64;
  // Rest speeds: what holds a group that is slower is an equilibrium, however it trembles.
  static constexpr double kMoves = 10.0;

  struct Locating {
    Pair pair;
    double start, duration, impulse;
    bool found;
  };

  bool is_dead(Pair pair) const;     // does not bounce
  bool plastic(Pair pair) const;
  bool locates() const { return rules_.plastic_impacts != scene::PlasticImpacts::kInStep; }
  double size_of(Pair pair) const;   // radius about the smaller one [m]
  Vector3d point_of(Pair pair, const collision::NearPoint& point) const;
  double shell(Pair pair) const;
  double reach(Pair pair);
  std::vector<double> speeds_about(const std::vector<Pair>& candidates);
  void give_guesses(const std::vector<Touch>& touches, const std::vector<RigidBodyState>& states, double h, double farthest, ContactProblem& problem) const;
  collision::Pose pose(int body, const std::vector<RigidBodyState>& states) const;
  Points points_at(Pair pair, const std::vector<RigidBodyState>& states, double reach) const;
  collision::Gap gap_of(Pair pair, const std::vector<RigidBodyState>& states) const;
  double distance_of(Pair pair, const std::vector<RigidBodyState>& states, double limit = std::numeric_limits<double>::infinity()) const;
  double least_gap_of(Pair pair, const std::vector<RigidBodyState>& states) const;
  std::vector<Group> groups(const std::vector<Pair>& touching);
  void note_near_pairs(const std::vector<Pair>& candidates);
  void require_progress();
  std::vector<Touch> touches_of(const Group& group);
  const std::vector<Warm>* known_impulses(Pair pair) const;
  void remember(const std::vector<Touch>& touches, const ContactProblem& problem, const ContactSolution& solution, double h, std::map<Pair, std::vector<Warm>>& store) const;
  ContactProblem problem_of(const Group& group, const std::vector<Touch>& touches, const std::vector<RigidBodyState>& states, double h,
                            const std::vector<RigidBodyState>* ends = nullptr);
  ContactSolution solve(const Group& group, const ContactProblem& problem, double h);
  static Vector3d relative_velocity(const ContactProblem& problem, std::size_t contact, const std::vector<Velocity>& velocities);
  static double approach(const ContactProblem& problem, std::size_t contact, const std::vector<Velocity>& velocities);
  static double slip_speed(const ContactProblem& problem, std::size_t contact, const std::vector<Velocity>& velocities);
  bool is_down(const Touch& touch) const;
  std::vector<Velocity> velocities_now(const Group& group, const std::vector<Touch>& touches, const ContactProblem& problem) const;
  bool comes_down(const Group& group, const std::vector<Touch>& touches, const ContactProblem& problem, const ContactSolution& solution, double h) const;
  std::vector<Landing> predict_landings(const Group& group, const std::vector<Touch>& touches, double h);
  std::optional<double> sort_out_landings(const Group& group, std::vector<Touch>& touches, double h);
  bool strike_what_is_down(const Group& group, const std::vector<Touch>& touches);
  bool strike(const Group& group, std::vector<Touch> down);
  static std::vector<int> touched_bodies(const Group& group, const std::vector<Touch>& touches);
  bool is_curved(const Group& group) const;
  bool are_balls(Pair pair) const;
  bool flies_off(Pair pair, const std::vector<RigidBodyState>& states) const;
  double same_within(Pair pair) const;
  double turn_of_normals(const Group& group, const std::vector<RigidBodyState>& ends) const;
  double speed(const Group& group) const;
  std::optional<double> take_steps(double h);
  std::optional<double> take_step(const Group& group, double h);
  bool gains_energy(const Group& group);
  void require_numbers(const Group& group, const ContactSolution& solution) const;
  void note_unsolved(const Group& group, const ContactSolution& solution, double h);
  void draw_apart();
  bool is_pile(const Group& group) const;
  bool becomes_heap(const Group& group);
  void tell_of_heaps();
  double room_of(Pair pair) const;
  std::vector<RigidBodyState> middle_of(const Group& group, double h) const;
  std::vector<Touch> touches_of_pile(const Group& group, const std::vector<RigidBodyState>& middle, double h);
  std::optional<double> take_pile_step(const Group& group, double h);
  double way_of(int body, const Velocity& shift) const;
  bool keep_pile_apart(const Group& group, const std::vector<Pair>& pairs, std::vector<RigidBodyState>& states, double t, std::vector<double>& gaps);
  Points points_of_overlap(Pair pair, const std::vector<RigidBodyState>& states, double reach, double gap) const;
  ContactProblem shifts_of(const Group& group, const std::vector<Pair>& pairs, const std::vector<RigidBodyState>& states, double t, const std::vector<double>& gaps, double wrong, const std::vector<double>& way, std::vector<Faced>& faced);
  bool apply_shift(int body, const Velocity& shift, std::vector<RigidBodyState>& states) const;
  void place_for_shift(const Group& group, Pair pair, const collision::NearPoint& point, const std::vector<RigidBodyState>& states, double t, double room, std::map<int, int>& places,
                       ContactProblem& problem, PushingContact& contact);
  void set_straight_path(int body, const RigidBodyState& end);
  void keep_warm(const Group& group, const std::vector<Touch>& touches, const ContactProblem& problem, const ContactSolution& solution, double h);
  std::optional<double> stop_of_sliding(const ContactProblem& problem, const std::vector<Touch>& touches, const ContactSolution& solution, double h);
  bool let_part(const Group& group, std::vector<Touch>& touches, ContactProblem& problem) const;
  static void keep_together(std::vector<Touch>& touches, ContactProblem& problem);
  static bool lands(const std::vector<Touch>& touches, const ContactSolution& solution);
  std::vector<RigidBodyState> ends_of(const Group& group, const ContactProblem& problem, const ContactSolution& solution, double h, bool landing,
                                      const std::vector<RigidBodyState>* at = nullptr) const;
  double largest_turn(const Group& group, const std::vector<RigidBodyState>& ends, double h) const;
  std::vector<Touch> touches_midway(const Group& group, const std::vector<Touch>& touches, const std::vector<RigidBodyState>& ends,
                                    std::vector<RigidBodyState>& middle) const;
  static const collision::NearPoint* same_point(Pair pair, const collision::NearPoint& p, const std::vector<RigidBodyState>& p_at, const Points& points,
                                                const std::vector<RigidBodyState>& at, double near);
  bool give_paths(const Group& group, const std::vector<Touch>& touches, const std::vector<RigidBodyState>& touches_at, const ContactProblem& problem,
                  const ContactSolution& solution, double h, bool landing,
                  const std::vector<RigidBodyState>* at);
  double add_shifts(const Group& group, const std::vector<Pair>& pairs, const std::vector<RigidBodyState>& states, double t, const std::vector<Held>& held, double reach, std::map<int, int>& places, ContactProblem& problem);
  bool keep_apart(const Group& group, const std::vector<Pair>& pairs, std::vector<RigidBodyState>& states, double t, const std::vector<Held>& held = {});
  void add_rows(const Group& group, const std::vector<RigidBodyState>& states, double t, const std::map<int, int>& places, bool of_places, ContactProblem& problem);
  int place(int body, double t, std::map<int, int>& places, const std::vector<RigidBodyState>& states, const RigidBodyState* velocities, ContactProblem& problem) const;

  MovingWorld& moving_;
  const Laws& laws_;
  scene::ContactSpec rules_;
  double rest_speed_, step_ = 0.0;               // [m/s], the longest step so far [s]
  std::vector<double> reaches_;                  // by body, where impacts are asked for in steps: how fast it or what it meets is [m/s]
  RunCounters& counters_;
  TrajectorySink& sink_;
  std::set<Pair> lasting_;
  std::map<Pair, Points> points_;                // of the step that has begun
  std::map<Pair, std::vector<Warm>> warm_, next_warm_;
  std::map<Pair, std::vector<Warm>> tried_;      // found by attempts at the step that has begun
  std::set<Pair> stuck_, next_stuck_;            // pairs with friction that did not slide in the last step
  std::vector<Group> groups_;                    // of the step
  std::set<int> heaped_;                         // bodies whose group strikes, or has struck since it last lay, too many blows a step to locate each
  double counted_from_ = -1e300;                 // blows that cut a step were counted since, and how many of each group, by its first body
  std::map<int, int> blows_;
  std::vector<ContactPoint> forces_;
  RunWatch unsolved_;                            // what the step that has begun leaves unsolved, until it is committed
  double struck_at_ = -1e300;                    // blows were struck last, and how many then
  int struck_ = 0;
  double searched_from_ = -1e300;                // ends of sliding were looked for since, and how often
  int searches_ = 0;
  std::optional<Locating> locating_;             // the end of sliding that is being looked for
  double cut_since_ = -1e300;                    // how often the step was cut since, and sweeps of the contact solver, for impulses and for shifts
  long cuts_ = 0;
  std::uint64_t sweeps_ = 0;
  int asked_last_ = -1;                          // body of the group that last asked for an earlier target
};

}  // namespace tumble::engines
