/// An effect: a force, a potential or a constraint, as one folder. This is all that the rest of the
/// program knows of it.
///
/// A folder says what its effect is in a scene (scene/words.h), what becomes of that in a world,
/// how it acts there, what it does to the world's energy, what it asks of a step, and what of it is
/// drawn. Each part that an effect does not have is left out: what stands here does nothing. A
/// world whose scene does not ask for an effect holds no object of it, so that no step pays for it.
///
/// An effect acts in one of two ways:
///   steady forces   on each body by itself, constant within a step: the body stays one that flies
///       alone (gravity, a point force)
///   a group's terms on bodies that are integrated together as one system of equations, asked at
///   every stage of the method (all others)
///
/// Frames and units as in dynamics/body.h. How to add one: README.md beside this.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "framework/dynamics/laws.h"
#include "framework/dynamics/tree_link.h"
#include "framework/dynamics/world.h"
#include "framework/effects/body_index.h"
#include "framework/effects/drawables.h"
#include "framework/scene/words.h"
#include "framework/trajectory/trajectory.h"

namespace tumble::effects {

/// What an effect acts with: the world that holds its entries, the laws that it asks, and its own
/// count of calls.
struct Acting {
  const World& world;
  const Laws& laws;
  std::uint64_t& calls;
};

/// Numbers that entries remember from an instant at which they change to the next, by entry. Beside
/// the states of bodies they are all that a process goes on from, so that an engine can go back in
/// time.
using Memory = std::map<int, std::array<double, 3>>;

/// An instant at which an entry begins or ends to act, known before the run.
struct Switch {
  int entry;
  bool on;
  Event event;  // body_a: the body that it acts on
};

/// Forces that are constant within a step, on each body by itself.
class SteadyForces {
 public:
  virtual ~SteadyForces() = default;

  /// Adds what acts on a body in a state. @param body  in the world
  virtual void add(int body, const RigidBodyState& state, Wrench& sum) = 0;
  /// Adds the acceleration of the body's centre. [m/s^2]
  virtual void add_acceleration(int body, Vector3d& sum_world) const = 0;
  /// The work of what acts on the body now, along the way from one state of it to another. [J]
  virtual double work(int body, const RigidBodyState& from, const RigidBodyState& to) const = 0;
  /// Bounds the torque about the body's centre. [N m]
  virtual double torque_bound(int) const { return 0.0; }
  /// Whether nothing of this acts on the body now but what World::gravity_world says.
  virtual bool leaves_flight(int) const { return true; }

  /// What has to be switched where the time is `time`, in the order of entries.
  virtual std::vector<Switch> due(double) const { return {}; }
  /// Switches one of these. @param states  by body of the world
  virtual void turn(const Switch&, const std::vector<RigidBodyState>&) {}
  /// Stands at another time, in other states: what acts then does so as `memory` says, or as it
  /// would where it begins now.
  /// @return when the next entry is switched; infinite without [s]
  virtual double stand_at(double, const Memory&, const std::vector<RigidBodyState>&) {
    return std::numeric_limits<double>::infinity();
  }
  /// What acts now goes on from.
  virtual Memory memory() const { return {}; }
};

/// The bodies of a group, and where an effect finds them in the lists that it is asked with. Asked
/// only while the group is put together.
class GroupPlaces {
 public:
  virtual ~GroupPlaces() = default;
  /// Whether the group moves this body.
  virtual bool has(int body) const = 0;
  /// Its place among the group's bodies; of an immovable one, or of the world (-1), its place
  /// behind them.
  virtual int place_of(int body) = 0;
};

/// A law that looks at its bodies at instants of its own, and holds what it has decided until it
/// looks again.
class Control {
 public:
  virtual ~Control() = default;
  /// Looks, where its time has come. @param bodies  by place @return when it looks next [s]
  virtual double look(double time, const std::vector<Body>& bodies) = 0;
  /// What it holds, by entry; and the same brought back: entries that it does not name look at
  /// once.
  virtual Memory memory() const = 0;
  virtual void remember(const Memory& memory) = 0;
  /// Its next look comes at once; what it remembers beside that stays.
  virtual void look_again() = 0;
  /// Whether it drives bodies otherwise than by what it held before, beyond what those of bodies at
  /// rest change.
  virtual bool differs_from(const Memory& before) const = 0;
};

/// Called with a link that is open, and by which part of its size or which angle.
using NoteOpen = std::function<void(const std::string& name, double open)>;

/// What an effect adds to the equations of motion of one group: forces, or equations that hold
/// (rows), or a control law.
class GroupTerms {
 public:
  virtual ~GroupTerms() = default;

  /// Adds forces and torques. @param bodies, wrenches  by place
  virtual void add_forces(const std::vector<Body>&, std::vector<Wrench>&) {}

  /// How many equations hold its bodies; append_rows appends them where the bodies are now.
  /// @param bodies  by place, which rows name them by
  virtual std::size_t row_count() const { return 0; }
  virtual void append_rows(const std::vector<Body>&, std::vector<Constraint>&) {}
  /// The same as joints of a tree, one for each entry, with the rows that are its; an effect that
  /// has rows and no joints keeps its bodies out of joint coordinates.
  virtual void append_joints(std::vector<TreeLink>&) const {}
  /// The largest length that they keep: what errors of places are compared with. [m]
  virtual double size() const { return 0.0; }
  /// The largest length over which they act, kept or not: what a tolerance of places is a part of.
  /// [m]
  virtual double reach() const { return size(); }
  virtual void note_open(const std::vector<Body>&, const NoteOpen&) const {}

  /// nullptr where it looks at nothing.
  virtual Control* control() { return nullptr; }

  /// What its entries pull with; Effect::measured_as says where it is recorded.
  /// @param multipliers  of its rows, in their order
  /// @param forces  by entry of the world: those of the group are filled in
  virtual void measure(const std::vector<Body>&, const VectorXd&, std::vector<double>&) {}
};

/// Potential energies as they are added up: all of them, and where that is asked for those of each
/// body.
class EnergySum {
 public:
  EnergySum() = default;
  /// @param by_body  what each body has is added there [J]
  explicit EnergySum(std::vector<double>& by_body) : by_body_(&by_body) {}

  /// @param body  that has it; of an entry between two bodies either of those that can move
  void add(int body, double energy) {
    whole_ += energy;
    if (by_body_ != nullptr) (*by_body_)[static_cast<std::size_t>(body)] += energy;
  }
  double whole() const { return whole_; }

 private:
  double whole_ = 0.0;
  std::vector<double>* by_body_ = nullptr;
};

/// What an effect brought into a world. [J]
struct Work {
  double done = 0.0;  // as far as it is known
  double most = 0.0;  // besides, at most; infinite: it is not known
};
class WorkMeter {
 public:
  virtual ~WorkMeter() = default;
  /// Whether it must be asked after each step: what it brings in depends on all of the way. Else
  /// it may be asked less often.
  virtual bool needs_steps() const { return true; }
  /// Adds what it brought in since it was asked last. @param states  by body of the world that it
  /// was made for  @param brought  by body: either of those that it acts on and that can move
  virtual void add_work(double time, const std::vector<RigidBodyState>& states,
                        std::vector<Work>& brought) = 0;
};

/// What an entry takes out of a world, beside what its work_meter says.
enum class Takes : std::uint8_t {
  kNothing,
  kPower,    // Effect::power_taken says how much
  kUnknown,  // nobody watches what its bodies lose
};

/// Takes evenly from the velocities of a body: m v' = -linear v, I w' = -angular w.
struct Drain {
  int body;
  double linear, angular;  // [N s/m], [N m s]
  std::string of, remedy;  // in words: "the resistance of body 'a'", "less resistance"
};

/// Draws bodies back along one direction: K = J^T stiffness J, C = J^T damping J. What swings
/// fastest by all of these limits the step.
struct StiffRow {
  int body_a, body_b;               // -1: the world
  Vector6d jacobian_a, jacobian_b;  // (6): (linear, angular), world
  double stiffness, damping;        // along it [N/m], [N s/m]
  std::string of;                   // in words: "spring 'a'"
  std::string remedy;               // beside a shorter step: "a softer spring or more damping"
  std::string last_remedy;          // where the method follows it at no step: "damp the spring"
};

/// Something that keeps two anchors at a distance, or at one place, and carries what hangs on it.
struct Carrier {
  Anchor a, b;
  double length;  // 0: at one place [m]
  bool turns;     // bodies turn about the place
  int entry;      // of its effect
  // from the centre of each end's body to the place, or to the axis about which bodies turn there;
  // 0 for the world [m]
  double arm_a = 0.0, arm_b = 0.0;
};

/// What pulls at bodies at an instant, for what is said of a run that gets out of hand.
struct Pull {
  int body_a, body_b;  // -1: the world
  double force;        // its size [N]
  std::string words;   // what pulls, by which law: "spring 'a' (spring_force of reference)"
};

/// Where a body of a scene is in a frame, by its name; nullptr for the world (an empty name).
using PoseOf = std::function<const BodyPose*(const std::string& body)>;

/// A law that an effect asks, and whether a module provides it.
struct NeededLaw {
  bool is_there;
  std::string what;        // "the force of a spring"
  std::string assignment;  // "a3"
  // of a listed law: which module provides it
  std::string source = LawList::kNoSource;
};

/// A law that is listed by its type (dynamics/law_list.h).
template <class Law>
NeededLaw needed_law(const Laws& laws) {
  return {laws.has<Law>(), Law::kWords.what, Law::kWords.assignment, laws.source_of<Law>()};
}

using scene::Traits;

class Effect : public scene::Words {
 public:
  /// Whether a scene's lists hold an entry of this effect.
  virtual bool is_kept_in(const TypedLists& lists) const = 0;
  bool is_asked(const scene::Scene& scene) const final { return is_kept_in(scene.effects); }

  // In a world ------------------------------------------------------------------------------------

  /// Turns what the scene says into entries of the world: names into indices, points into frames.
  /// Bodies are there.
  virtual void build(const scene::Scene& scene, const BodyIndex& index, World& world) const = 0;
  /// How many entries of it a world holds; 0 where it does not act.
  virtual int count_in(const World& world) const = 0;
  /// The bodies that an entry names; -1 is the world.
  virtual std::vector<int> bodies_of(const World& world, int entry) const = 0;
  /// Copies entries into a part of the world, in this order.
  /// @param in_part  by body of the whole: its index in the part; -1 stays
  virtual void copy_entries(const World& whole, const std::vector<int>& entries,
                            const std::function<int(int body)>& in_part, World& part) const = 0;

  // How it acts: none of both where it does not act in this world ---------------------------------

  virtual std::unique_ptr<SteadyForces> steady_forces(const Acting&) const { return nullptr; }
  /// @param entries  those that name bodies of the group, ascending; one at least
  virtual std::unique_ptr<GroupTerms> group_terms(const Acting&,
                                                  const std::vector<int>& /*entries*/,
                                                  GroupPlaces&) const {
    return nullptr;
  }
  virtual std::vector<NeededLaw> needed_laws(const scene::Scene&, const Laws&) const { return {}; }

  /// All switches of a run, in the order of entries.
  virtual std::vector<Switch> switches(const World&) const { return {}; }
  /// Whether something steady, but for what World::gravity_world says, acts on the body at this
  /// time or later.
  virtual bool pushes(const World&, int, double) const { return false; }

  // Energy ----------------------------------------------------------------------------------------

  /// Adds the potential energy of its entries in these states. [J]
  /// @param states  by body; of immovable bodies the place alone is looked at
  virtual void add_potential_energy(const World&, const std::vector<RigidBodyState>&,
                                    EnergySum&) const {}
  /// Adds the size of the terms that this energy is a sum of, each as large as its parts make it:
  /// what rounding is relative to. [J]
  virtual void add_energy_terms(const World&, const std::vector<RigidBodyState>&, double&) const {}
  /// For an effect that brings energy in; nothing for one that keeps it or takes it out.
  virtual std::unique_ptr<WorkMeter> work_meter(const World&) const { return nullptr; }
  /// Whether an entry takes energy out. Nothing is said of energy that is lost by bodies that an
  /// entry of an unknown kind acts on.
  virtual Takes takes(const World&, int /*entry*/) const { return Takes::kUnknown; }
  /// At most, in these states. [W]
  virtual double power_taken(const World&, const std::vector<RigidBodyState>&,
                             int /*entry*/) const {
    return 0.0;
  }

  // What it asks of a step ------------------------------------------------------------------------

  virtual void append_drains(const World&, std::vector<Drain>&) const {}
  /// Where the run starts. @param start  by body
  virtual void append_stiff_rows(const World&, const std::vector<RigidBodyState>&,
                                 std::vector<StiffRow>&) const {}
  /// The directions in which its entries let nothing move: rows between bodies of the world (-1:
  /// the world itself).
  virtual void append_held_rows(const World&, const std::vector<RigidBodyState>&,
                                std::vector<Constraint>&) const {}
  virtual void append_carriers(const World&, std::vector<Carrier>&) const {}

  /// How long the next step may be from these states, for methods that sample it to see all that
  /// acts: what begins or ends within so short a way that a step passes over it is met by shorter
  /// ones. @param asked  the step that is to be taken [s] @return  infinite: any. [s]
  virtual double longest_step(const World&, const std::vector<RigidBodyState>& /*states*/,
                              double /*asked*/) const {
    return std::numeric_limits<double>::infinity();
  }

  // What is recorded and reported of it -----------------------------------------------------------

  /// Where a frame keeps what its entries pull with; nullptr where nothing of it is recorded.
  virtual std::vector<double> Frame::*measured_as() const { return nullptr; }
  /// @param measured  what group_terms have measured, by entry; empty where they measure nothing
  virtual void append_pulls(const World&, const std::vector<RigidBodyState>&,
                            const std::vector<double>&, const Laws&, std::vector<Pull>&) const {}

  /// How far an entry is off in a frame, by the places of bodies alone, and what is found: of one
  /// of its link_checks.
  virtual std::pair<double, std::string> error_of(const std::string&, const scene::Scene&,
                                                  std::size_t, const PoseOf&) const {
    return {0.0, ""};
  }

  // What is drawn of it ---------------------------------------------------------------------------

  virtual void draw(const scene::Scene&, Drawables&) const {}
};

}  // namespace tumble::effects
