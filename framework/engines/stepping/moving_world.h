/// A world on the move: where every body is at the last committed time, and where the laws take it
/// from there.
///
/// Within a step each body follows a path: the laws' integration from the committed state by any
/// part of the step, always from the step's start. Bodies that depend on others (links, persistent
/// contacts) follow the smooth path between the step's ends instead. Collision finding, rollback
/// and pictures all look at this one path.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "framework/collision/first_impact.h"
#include "framework/collision/sweep.h"
#include "framework/dynamics/laws.h"
#include "framework/dynamics/rotation_bounds.h"
#include "framework/dynamics/spin_series.h"
#include "framework/dynamics/world.h"
#include "framework/effects/registry.h"
#include "framework/engines/base/effects_built.h"
#include "framework/engines/base/run_counters.h"
#include "framework/engines/stepping/free_turning.h"
#include "framework/engines/stepping/linked_bodies.h"
#include "framework/engines/stepping/pair_caches.h"
#include "framework/engines/stepping/smooth_path.h"

namespace tumble::engines {

/// A ball at rest relative to an immovable support, which may move evenly; it may spin. It is left
/// alone until something touches it.
struct Rest {
  int support;
  Vector3d offset_from_support_world;  // [m]
};

class MovingWorld {
 public:
  MovingWorld(World world, const Laws& laws, RunCounters& counters);
  /// The same with solids that were prepared before: what a body's `shape` in the world says is not
  /// looked at.
  /// @param shapes  by body; stay where they are as long as this lives
  MovingWorld(World world, const Laws& laws, RunCounters& counters,
              std::vector<const collision::CollisionShape*> shapes);
  MovingWorld(const MovingWorld&) = delete;
  MovingWorld& operator=(const MovingWorld&) = delete;

  /// Stands at another time in other states; no step is under way.
  /// @param states  by body; those of immovable bodies are not looked at: driven ones stand where
  /// they are at that time
  void stand_at(double time, const std::vector<RigidBodyState>& states);
  /// Steady forces act from here on as they do at the time where this stands.
  /// @param memory  by effect: what its entries remember
  /// @return when the next is switched; infinite without [s]
  double load_forces(const std::map<int, effects::Memory>& memory);
  /// What they remember, by effect.
  std::map<int, effects::Memory> force_memory() const;

  /// From here on bodies that nothing but gravity acts on go in closed form instead of along the
  /// laws' integration.
  void go_in_closed_form();

  /// From here on bodies that nothing turns are compared with the exact rotation, as far as the
  /// laws' integration leads them. For worlds whose steps are all committed.
  void watch_free_turning() { watches_free_turning_ = true; }

  const World& world() const { return world_; }
  int size() const { return static_cast<int>(world_.bodies.size()); }
  const collision::CollisionShape& shape(int body) const { return *shapes_[body]; }
  double time() const { return time_; }

  /// Committed state of a movable body.
  const RigidBodyState& state(int body) const { return states_[body]; }
  const std::vector<RigidBodyState>& states() const { return states_; }
  void set_state(int body, const RigidBodyState& state) {
    states_[body] = state;
    paths_[body].is_stale = true;
  }
  /// Whether the two may collide at all: one can move, both collide, and the scene does not keep
  /// them apart.
  bool may_collide(int a, int b) const;
  bool can_move(int body) const {
    return !world_.bodies[body].immovable() && !rests_[body] && !asleep(body);
  }
  /// Whether an immovable body moves by a law of its own.
  bool is_driven(int body) const { return tumble::is_driven(world_.bodies[body].motion); }
  /// Those that do, ascending.
  const std::vector<int>& driven_bodies() const { return driven_; }
  bool resting(int body) const { return rests_[body].has_value(); }
  void put_to_rest(int body, int support);
  /// Stops a body where it is: from here on it keeps its place to the last bit, and no law is asked
  /// about it (sleeping.h).
  void put_to_sleep(int body);
  bool asleep(int body) const { return built::kSleep && asleep_[body]; }
  /// Where bodies that can move would be after a time h if they all stood still now, with control
  /// laws that look then; contacts hold nothing. Changes nothing, nor what is counted.
  /// @param bodies  groups of linked bodies as a whole
  /// @param states  by body; their momenta are not looked at
  /// @return by body; those of others as they were
  std::vector<RigidBodyState> released(const std::vector<int>& bodies,
                                       std::vector<RigidBodyState> states, double h);
  /// Ends rest or sleep of a body.
  void wake(int body);
  /// Steady forces that are to be switched at the committed time, with the place of each's effect
  /// among those that act: hand each to turn().
  std::vector<std::pair<std::size_t, effects::Switch>> due_switches() const;
  void turn(const std::pair<std::size_t, effects::Switch>& what);
  /// Takes in entries of steady forces that begin now or later. @param more  holds nothing else
  void take_in(const scene::Scene& more);
  /// The work of what acts steadily on a body, along the way from one state of it to another. [J]
  double steady_work(int body, const RigidBodyState& from, const RigidBodyState& to) const {
    double sum = 0.0;
    for (const Steady& forces : steady_) sum += forces.acting->work(body, from, to);
    return sum;
  }
  /// Whether nothing steady acts on the body now but gravity.
  bool is_left_alone(int body) const {
    for (const Steady& forces : steady_)
      if (!forces.acting->leaves_flight(body)) return false;
    return true;
  }

  /// Bodies that effects tie (effects::Traits::ties): groups that are integrated as one.
  std::vector<LinkedBodies>& linked_groups() { return linked_; }
  const std::vector<LinkedBodies>& linked_groups() const { return linked_; }
  /// Place of a body's group in linked_groups(); -1 for a body without links.
  int linked_group(int body) const { return group_of_[body]; }
  /// Control laws whose time has come look. @return when the next one does; infinite without
  double look();
  /// What springs, rods and joints pull with in these states.
  /// @param contacts  persistent ones, which weigh on them
  LinkForces measure_links(const std::vector<RigidBodyState>& states, double t,
                           const std::vector<ContactPoint>& contacts);
  /// For a picture within a step: rods and joints of projected groups hold there too, where the
  /// path between the step's ends is off by its fourth power. Changes nothing but these states.
  void close_links(std::vector<RigidBodyState>& states, double t);
  /// At the end of a step of length h: notes rods and joints that have come apart.
  void watch_links(double h);
  /// After callbacks: velocities of the bodies joined to those that were called back onto the
  /// constraints.
  /// @return whether there are any
  bool keep_constraints(const std::vector<Event>& events);
  /// From here on to the step's target the body goes from `start` (at time(); its velocities may
  /// jump there) to `end`.
  void set_path(int body, const RigidBodyState& start, const RigidBodyState& end,
                SmoothPath::Momenta momenta = SmoothPath::Momenta::kOfPath);
  /// @throws StoppedRun where the body turns about itself ten times on its smooth path in the step
  /// under way, or where that path is not made of numbers
  void refuse_fast_turning(int body) const;
  /// Whether forces act on a body that follow, within a step, where it is and how fast.
  bool has_forces_of_motion(int body) const {
    return group_of_[body] >= 0 && linked_[group_of_[body]].has_forces_of_motion();
  }
  /// Works out anew where the step under way leads bodies that contacts press: springs, drag and
  /// water feel the path that contacts allow, not the one on which nothing holds a body up. What
  /// presses them takes part in the integration, and its own share is taken off the path's end
  /// again, for the step's contacts to give:
  ///   p' -= F h,   x' -= b F h^2 / 2m,   L' -= T h,   and turned back by b I^-1 T h^2 / 2,
  /// b what the method makes of a constant acceleration: 1 from the second order on.
  /// With forces that do not follow the motion the end is the same as before.
  /// @param pressing  by body: the mean of what presses it, expected for the step
  void lead_pressed(const std::map<int, Wrench>& pressing);
  /// Where the step leads without what set_path has added.
  const RigidBodyState& path_end(int body);
  /// The path that set_path has given, or that links have; nothing where the laws are asked at
  /// every instant.
  const std::optional<SmoothPath>& smooth_path(int body) const {
    if (paths_[body].smooth) paths_[body].smooth->work_out();
    return paths_[body].smooth;
  }

  /// How long the next step may be for the effects that act, where `asked` would be taken.
  /// infinite: any. [s]
  double longest_step(double asked) const;
  /// Begins a step from the committed time: works out where all come out. The motion's bounds are
  /// worked out where motion() asks for them.
  void begin_step(double target);
  /// Begins the step under way again, because some bodies ask for an earlier target or have got
  /// other velocities. Nothing is integrated for a body that flies alone and has kept its state:
  /// its path stays, or its new end is worked out when it is asked for.
  void begin_step_again(double target);
  /// What the step under way has computed was in vain: it will be begun again.
  void give_up_step() { counters_.undone_integrations += integrations_in_step_; }
  double target() const { return target_; }
  /// Begins the step again with an earlier target, if one of the bodies of these pairs turns too
  /// far in it for a bound on its turning to hold: collisions of these pairs would be missed. Balls
  /// for collision never ask for that.
  /// @param in_step  pairs that contacts keep apart however their paths run: of these only the
  /// turning is asked, not what is wrong with it
  /// @return whether the target was moved
  /// @throws StoppedRun where a step would have to be cut into more than 1e5 parts
  bool shorten_step(const std::vector<std::pair<int, int>>& pairs,
                    const std::function<bool(std::pair<int, int>)>& in_step = {});
  /// Where a body's path is at time t in [time(), target()]; any t for immovable, resting and
  /// sleeping ones.
  RigidBodyState path(int body, double t);
  collision::MotionState motion_at(int body, double t);
  /// Only where it is: cheap at the step's ends.
  collision::Pose pose_at(int body, double t);
  collision::Motion motion(int body);
  /// How fast any point of a body is in the step under way, from the speeds at its ends. [m/s]
  double fastest_in_step(int body);
  collision::SweptBox swept_box(int body);
  /// Whether swept_box is that of a longer step: of a body whose path's end was not asked for.
  /// path_end(body) ends that.
  bool has_roomy_box(int body) const { return !paths_[body].end_known; }
  /// All bodies to where their paths are at t; what the step had computed beyond counts as undone
  /// when t is before its target.
  void commit(double t);

  /// Of the bodies a < b: hand it to every question about their gap.
  collision::PairCache* pair_cache(int a, int b) const { return caches_.of(a, b); }

  /// As impulses need it, at the committed time.
  Body body_at_impact(int body) const;
  Vector3d velocity_of(int body, double t) const;

 private:
  struct Steady {
    int effect;  // its place in effects::all()
    std::unique_ptr<effects::SteadyForces> acting;
  };
  struct Path {
    VectorXd start;  // packed
    RigidBodyState end;
    // false: worked out by path_end, not yet asked for since the step began again
    bool end_known = true;
    bool is_stale = false;  // the state has been changed since the step began
    // of a body alone, from the step's start to box_target
    std::optional<collision::SweptBox> box;
    double box_target;
    Vector3d acceleration_world;  // of the path, constant in the step
    std::optional<collision::MotionBounds> bounds;
    double memo_time;
    RigidBodyState memo;
    double measured_duration, turning_error;  // see turning_error
    std::optional<SmoothPath> smooth;
    std::optional<SpinSeries> turning;  // of a body in closed form, from the step's start
  };

  void begin_path(int body);
  void begin_linked_paths();
  bool flies_freely(int body) const { return !rotations_.empty() && is_left_alone(body); }
  void lead(LinkedBodies& group);
  RigidBodyState fly(int body, double duration, const VectorXd& start);
  RigidBodyState integrate(int body, double duration, double start_time, const VectorXd& start);
  const VectorXd& units_of(int body);
  Wrench wrench_on(int body, const RigidBodyState& state);
  double torque_bound(int body) const;
  const PrincipalMoments& principal_of(int body);
  double turning_error(int body, double duration);
  bool bound_turning(int body, double duration, collision::MotionBounds& bounds);
  double resolved_duration(int body, double duration, bool measures_path);
  void watch_turning(int body, const RigidBodyState& end, double duration);
  void note_turning(int body, double found, RunWatch::Kind kind, double duration);
  collision::MotionBounds work_out_bounds(int body);
  RigidBodyState still_state(int body, double t) const;

  World world_;
  const Laws& laws_;
  RunCounters& counters_;
  // empty where they were prepared before
  std::vector<collision::CollisionShape> own_shapes_;
  std::vector<const collision::CollisionShape*> shapes_;
  std::vector<RigidBodyState> states_;
  std::vector<int> driven_;  // bodies
  std::vector<std::optional<Rest>> rests_;
  // asked for often: a byte each is read faster than a bit
  std::vector<char> asleep_;
  std::vector<const effects::Effect*> acting_;
  std::vector<Steady> steady_;  // of the effects that act on bodies by themselves
  std::vector<Path> paths_;
  mutable PairCaches caches_;
  std::vector<LinkedBodies> linked_;
  std::vector<int> group_of_;  // by body: place in linked_, -1
  // by body: what contacts press with while lead_pressed integrates, else empty
  std::map<int, Wrench> pressing_;
  double time_ = 0.0, target_ = 0.0;
  // how much of a constant acceleration the laws' integration puts into a path: 1 for order >= 2, 0
  // for Euler
  double path_bend_ = 1.0;
  std::uint64_t integrations_in_step_ = 0;
  std::vector<std::optional<PrincipalMoments>> principal_;  // by body, once asked for
  std::vector<FreeRotation> rotations_;                     // by body; empty: the laws integrate
  bool watches_free_turning_ = false;
  std::map<int, FreeTurning> free_turning_;  // by body, of those that have turned
  // by body: units of its state, once its integration has asked for them
  std::vector<VectorXd> units_;
};

}  // namespace tumble::engines
