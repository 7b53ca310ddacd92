/// Bodies that move together because effects tie them to each other or to the world, or act on them
/// otherwise than evenly through a step: one system of differential equations, integrated by the
/// laws' method as a whole.
///
/// Forces are evaluated at every stage of the method; what constrains (rods, joints) adds what
/// holds it (Lagrange multipliers at every stage), and is brought back by the stabilisation the
/// scene chose: Baumgarte's term in the multipliers, or a projection of places and velocities at
/// the end of each step.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "framework/dynamics/articulated_tree.h"
#include "framework/dynamics/contact_problem.h"
#include "framework/dynamics/laws.h"
#include "framework/dynamics/world.h"
#include "framework/effects/effect.h"
#include "framework/engines/base/effects_built.h"
#include "framework/engines/base/run_counters.h"
#include "framework/engines/stepping/body_places.h"
#include "framework/engines/stepping/link_forces.h"
#include "framework/engines/stepping/linked_groups.h"

namespace tumble::engines {

/// What the laws' integration makes of a constant acceleration a: x(h) = x0 + v h + bend a h^2 / 2.
/// Asked once, so that bounds hold for whichever method a student wrote. [-]
double path_bend(const Laws& laws);

class LinkedBodies final : effects::GroupPlaces {
 public:
  /// Gravity and point forces on a body (index in the world) in a state.
  using OuterWrench = std::function<Wrench(int body, const RigidBodyState& state)>;

  /// Whether nothing but gravity acts on a body (index in the world) from outside of the group;
  /// empty: outer_wrench says it all.
  using LeftAlone = std::function<bool(int body)>;

  LinkedBodies(const World& world, const Laws& laws, RunCounters& counters,
               OuterWrench outer_wrench, LinkedGroup group, LeftAlone left_alone = {});

  const std::vector<int>& bodies() const { return bodies_; }
  /// Immovable bodies that a link of the group ends at; -1: the world.
  const std::vector<int>& fixed_ends() const { return fixed_; }
  /// What its control laws hold until they look again, by place in effects::all(), and the same
  /// brought back.
  std::map<int, effects::Memory> held() const;
  void remember(const std::map<int, effects::Memory>& held);
  /// The next look of its control laws comes at once.
  void look_again();
  /// Whether its control laws drive it otherwise than by what they held before.
  bool is_driven_otherwise(const std::map<int, effects::Memory>& before) const;
  bool has_constraints() const { return row_count_ > 0; }
  /// Whether it is integrated in joint coordinates as long as nothing touches it.
  bool has_tree() const { return tree_.has_value(); }
  /// Whether forces act on its bodies that follow within a step where these are and how fast:
  /// springs, drag, water. What a motor holds does not.
  bool has_forces_of_motion() const;

  /// Why the group is not integrated in joint coordinates where the world asks for these; empty: it
  /// is, as long as nothing touches it.
  const std::string& kept_maximal_by() const { return kept_maximal_by_; }
  /// Whether its rods and joints ask for no law of rows as long as nothing touches it: it has none,
  /// or goes in the coordinates of a tree.
  bool goes_without_rows() const { return !has_constraints() || (tree_ && loop_rows_.empty()); }
  /// In words: numbers of joint coordinates and of rows that close loops. @pre kept_maximal_by() is
  /// empty, and the world asks for joint coordinates
  std::string reduced_in_words() const;
  /// From here on bodies of the group are in persistent contact, or are not: contacts push bodies
  /// of six coordinates, so the group goes on in these from the same state, and back.
  void set_touched(bool touched) { touched_ = touched; }

  /// Control laws whose time has come look and set their torques.
  /// @return the next time at which one looks; infinite without
  double look(double time, const std::vector<RigidBodyState>& states);

  /// States of bodies() after a step of the laws' method. @param states  by body of the world, at t
  std::vector<RigidBodyState> advance(const std::vector<RigidBodyState>& states, double t,
                                      double h);

  /// The rows of rods and joints at one instant, and the bodies between which they stand: bodies(),
  /// then fixed_ends().
  struct Instant {
    std::vector<Constraint> rows;
    std::vector<ConstrainedBody> bodies;
  };
  Instant at_instant(const std::vector<RigidBodyState>& states, double t);
  /// What rods and joints add to a sudden change of velocities: impulses of their own, after which
  /// their rates are what they were.
  /// @param change  (6 a body of the instant): linear, angular, world [m/s, rad/s]
  /// @return the same: smallest in the measure of the masses; 0 for fixed ends
  VectorXd reaction(const Instant& instant, const VectorXd& change);

  /// Velocities onto the constraints (where a callback or rounding left them off): the change that
  /// is smallest in the measure of the masses.
  void project_velocities(std::vector<RigidBodyState>& states, double t);
  /// Places, then velocities, onto the constraints.
  void project(std::vector<RigidBodyState>& states, double t);

  /// The rows of rods and joints, between places in bodies(), without those that say what others
  /// say; fixed ends have the index fixed_end().
  std::vector<Constraint> constraint_rows(const std::vector<RigidBodyState>& states, double t);
  int fixed_end() const { return static_cast<int>(bodies_.size()); }

  /// Notes rods and joints of this group that are open in these states at the end of a step of
  /// length h. From places alone: no law is asked.
  void watch(const std::vector<RigidBodyState>& states, double t, double h);

  /// Adds the forces of this group's links in these states. What lies on its bodies, leans or rubs
  /// against them weighs on the links too.
  /// @param contacts  persistent ones of the world, at that time
  void measure(const std::vector<RigidBodyState>& states, double t,
               const std::vector<ContactPoint>& contacts, LinkForces& forces);

  /// Raises, for each of its links, by how much what it pulls with changes along the ways in which
  /// rows that say what others say may share their load, over all multipliers. 0: statics alone
  /// tell its force. Nothing of contacts is looked at.
  void measure_shared(const std::vector<RigidBodyState>& states, double t, LinkForces& shared);
  /// Raises, for each of its links that would have to stretch along the way that bodies take from
  /// these states, though at first nothing holds them: by its part in that, of 1 at most. Not asked
  /// of groups that hang on driven bodies.
  void measure_stretched(const std::vector<RigidBodyState>& states, double t,
                         LinkForces& stretched);

 private:
  std::string subject() const;  // of messages
  double open_part(const std::vector<Body>& bodies, const std::vector<Constraint>& rows) const;
  double length_of_units() const;
  bool has(int body) const override;
  int place_of(int body) override;
  std::vector<Body> place_bodies(const std::vector<RigidBodyState>& local, double t) const;
  std::vector<Wrench> forces(const std::vector<RigidBodyState>& local,
                             const std::vector<Body>& bodies);
  std::vector<Constraint> rows(const std::vector<Body>& bodies);
  void add_contacts(const std::vector<Body>& bodies, const std::vector<ContactPoint>& contacts,
                    std::vector<Wrench>& wrenches) const;
  VectorXd add_constraint_forces(const std::vector<Constraint>& all,
                                 const std::vector<Body>& bodies,
                                 const std::vector<RigidBodyState>& local,
                                 std::vector<Wrench>& wrenches);
  VectorXd multipliers_at(const std::vector<RigidBodyState>& local, const std::vector<Body>& bodies,
                          double t, const std::vector<ContactPoint>& contacts);
  VectorXd derivative(double t, const VectorXd& y);
  // Rows that say what others say: redundant_rows.cpp.
  static constexpr std::size_t kMostDenseRows = 120;  // a step looks at them in 1 ms
  bool closes_loop(const LinkedGroup& group) const;
  void choose_rows(const std::vector<RigidBodyState>& local, double t);
  std::vector<char> spanning(const std::vector<Body>& bodies, std::size_t at_least);
  struct Directions;
  Directions directions(const std::vector<Constraint>& all, const std::vector<Body>& bodies) const;
  bool has_redundant_rows();
  std::optional<std::vector<Vector6d>> way_from(const std::vector<RigidBodyState>& local,
                                                const std::vector<Body>& bodies,
                                                const std::vector<Constraint>& all);
  struct Stretch;
  std::optional<Stretch> stretch_across(const std::vector<Constraint>& all,
                                        const std::vector<Body>& bodies, const VectorXd& change);
  std::optional<std::vector<Vector6d>> accelerations_of_many(const std::vector<Constraint>& all,
                                                             const std::vector<Body>& bodies,
                                                             const std::vector<Wrench>& wrenches);
  static double fastest(const std::vector<Vector6d>& way, const std::vector<Body>& bodies);
  static std::vector<Constraint> those_of(const std::vector<char>& chosen,
                                          std::vector<Constraint> all);
  VectorXd rates_of_bodies(const VectorXd& y) const;
  void need_size(const VectorXd& stage, const VectorXd& y) const;
  // In joint coordinates: reduced_bodies.cpp.
  void plant_tree();
  std::vector<RigidBodyState> advance_reduced(std::vector<RigidBodyState> local, double t,
                                              double h);
  VectorXd begin_reduced(std::vector<RigidBodyState>& local, double t);
  void keep_momentum(const std::vector<RigidBodyState>& before, double h,
                     std::vector<RigidBodyState>& after);
  VectorXd reduced_rate(double t, const VectorXd& y);
  void accelerate_tree(double t, const VectorXd& y);
  VectorXd multipliers_of_tree(std::vector<RigidBodyState> local, double t);
  void settle_on_tree(std::vector<RigidBodyState>& local, double t);
  void stand_fixed_ends_at(double t);
  void close_loops();
  Vector3d acceleration_of_fixed(int fixed, const Vector3d& com_world, double t) const;
  static std::vector<ConstrainedBody> constrained(const std::vector<Body>& bodies);
  VectorXd correction(const std::vector<Constraint>& rows,
                      const std::vector<ConstrainedBody>& bodies, const VectorXd& error);
  void project_local(std::vector<RigidBodyState>& local, double t, bool places);
  void bring_back(std::vector<RigidBodyState>& local, double t, bool places);
  std::vector<RigidBodyState> take(const std::vector<RigidBodyState>& states) const;
  void put(const std::vector<RigidBodyState>& local, std::vector<RigidBodyState>& states) const;

  const World& world_;
  const Laws& laws_;
  RunCounters& counters_;
  OuterWrench outer_wrench_;
  LeftAlone left_alone_;
  std::vector<int> bodies_;
  // immovable ends: bodies of the world, -1 for the world itself
  std::vector<int> fixed_;
  struct Terms {
    std::size_t effect;  // its place in effects::all()
    std::unique_ptr<effects::GroupTerms> acting;
  };
  std::vector<Terms> terms_;           // of the effects that act on the group
  std::size_t row_count_ = 0;          // of all of them
  std::vector<std::size_t> controls_;  // those of terms_ that look
  double time_of_stage_ = 0.0;
  double step_ = kUnset;  // the last that advance() took [s]
  // its longest rod or spring, or its largest radius of gyration [m]
  double length_ = 0.0;
  // of links, through the world or without, and of few enough rows for a step to look at them
  bool has_loop_ = false, has_small_loop_ = false;
  // once asked: how many rows say something new where the scene begins
  std::optional<std::size_t> rank_at_start_;
  // by row, in the step under way: whether its stages obey it; empty: all
  std::vector<char> obeyed_;
  VectorXd units_;  // of the packed states of its bodies, by length_

  std::optional<ArticulatedTree>
      tree_;  // absent: the group is integrated in six coordinates a body
  std::string kept_maximal_by_;
  std::vector<TreeLink> joints_;  // row: among those of all terms
  std::vector<int> loop_rows_;    // of joints that close loops
  bool touched_ = false;
  bool ends_move_ = false;            // fixed ends that are driven
  std::vector<char> feels_gravity_;   // by body, in the step under way: gravity alone
  std::vector<std::size_t> pulling_;  // those of terms_ that may act with forces
  // where the tree stands, by place
  std::vector<FixedEnd> ends_;
  std::vector<Body> seen_;
  std::vector<Wrench> wrenches_;
  std::optional<double> bend_;  // of paths, once asked
  double begun_at_ = 0.0;       // time of the coordinates' beginning [s]
};

/// What becomes of each group of a world that asks for joint coordinates, in words: its numbers, or
/// why it keeps six coordinates a body.
std::vector<std::string> coordinates_in_words(const World& world);

/// Whether no law of rows will be asked for in a world: its rods and joints hang bodies in trees in
/// joint coordinates, and none of these bodies collides.
bool goes_without_rows(const World& world);

/// Adds the rows of a group's rods and joints, where its bodies stand, to a problem of impulses.
/// @param places  of its movable bodies in the problem, by body of the world; all fixed ends become
/// one body that cannot be pushed
void add_rows(LinkedBodies& group, const std::vector<RigidBodyState>& states, double t,
              const BodyPlaces& places, ContactProblem& problem);

/// Rows are to have the rates afterwards that the problem's bodies give them before.
void keep_rates(ContactProblem& problem);

}  // namespace tumble::engines
