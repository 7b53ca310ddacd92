/// What a run must not keep to itself: links that come apart, projections and contact problems that
/// end unsolved, energy that nothing brings in, bodies that turn farther in a step than it can see,
/// bodies that are left in one another.
///
/// Every stage of every engine notes here what it could not do (the watch is part of RunCounters,
/// which each stage has and which threads and processes add up); at the end the run's faults are
/// judged as checks that failed (judge.h), so that they stand in the table, in --json and in the
/// exit code. What stays below the limits is not kept: the limits are what a solver's tolerance and
/// rounding leave, and a reader would see.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <numbers>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "framework/core/numbers.h"
#include "framework/dynamics/world.h"
#include "framework/trajectory/trajectory.h"

namespace tumble::engines {

/// A link counts as closed up to this part of its size (a rod's length, the arms of a joint), or
/// this angle [rad]. Projection leaves 1e-13; a check of a joint's gap asks for 1e-6 to 1e-9 m; a
/// picture shows 1e-3.
inline constexpr double kLinkClosed = 1e-6;
/// With Baumgarte's term or no stabilisation links drift by design: up to here they are the
/// mechanism that the scene asks for.
inline constexpr double kLinkDrifts = 1e-2;
/// An answer to a contact problem stands up to this violation of Signorini's and Coulomb's
/// conditions, as a part of the speed that the problem has to take away: what is wrong with the
/// energy goes with its square, and with its first power over the contact's other impulses.
inline constexpr double kContactSolved = 1e-3;
/// Energy may rise above the least it has been by this part of what the scene has to give
/// (EnergyWatch): methods of order 4 whose step is within reach of the motion lose a thousandth.
inline constexpr double kEnergyRises = 1e-2;
/// Bodies that nothing takes energy from may lose this part of the most that has moved, been stored
/// or come down among them (EnergyLoss): as much as may rise. Runge and Kutta's method of order 4
/// takes (w h)^5 / 72 of a swing's energy each radian: at 25 steps a swing 1 % in 117 swings.
inline constexpr double kEnergyLost = 1e-2;
/// Of the energy's error: by the methods that scenes are run with, and where contacts act, which a
/// step meets by impulses, whatever the method.
inline constexpr double kOrderOfMethods = 4.0, kOrderAtContacts = 1.0;
/// The same where rods and joints take energy out: near places where a mechanism can go two ways
/// methods lose their order.
inline constexpr double kOrderOfLinks = 2.0;
/// A step may turn a body by half a turn [rad]: farther, what a method samples cannot be told from
/// a turn the other way round.
inline constexpr double kTurnResolved = std::numbers::pi;
/// A run's steps may turn by this angle wrong what nothing turns [rad]: pictures show it. Runge and
/// Kutta's method of order 4 takes (w h)^4 / 5120 of each radian: at 25 steps a turn this much in
/// 20,000 turns, at 6 steps in 68.
inline constexpr double kTurnsRight = 0.1;

/// Two bodies count as apart up to an overlap of this part of the smaller one's radius: a picture
/// shows it. Position correction leaves none.
inline constexpr double kApart = 1e-3;

class RunWatch {
 public:
  enum class Kind : std::uint8_t {
    kLinkOpen,
    kProjectionOpen,
    kContactUnsolved,
    kEnergyRises,
    kEnergyLost,
    kTurnUnresolved,
    kTurnsWrong,
    kOverlapLeft
  };
  struct Size {
    double found, allowed;  // relative, [rad] of an angle
    double time, step;      // [s]
    // with which power of the step the energy that it makes goes
    double order = kOrderOfMethods;
    double whole = kUnset;  // of an energy, what it is a part of [J]
    // a step that mends it, where one is known [s]; and words of what else does, instead of its
    // kind's: known ones first
    double mending_step = kUnset;
    std::string first_remedy = {}, remedy = {};
    std::string meaning = {};  // instead of its kind's
  };

  /// Keeps what is above what is allowed, or is not a number.
  void note(Kind kind, const std::string& subject, const Size& size);
  /// What a reader is to know, and is no fault: of each subject what was said of it first.
  void say(const std::string& subject, double time, const std::string& words);
  /// Whether something of that subject is said as of t or before. [s]
  bool has_said(const std::string& subject, double t) const;
  /// An island has been solved in steps, not at instants (contact/large_islands.cpp).
  void note_large_island(double time) { large_island_at_ = std::min(large_island_at_, time); }
  bool has_large_islands() const { return large_island_at_ < kInfinity; }
  /// Adds what another has noted: a thread, or a part of the world. The sum does not depend on the
  /// order of adding.
  void add(const RunWatch& other);
  /// Drops the kinds, and what was said of subjects, that were first noted after t. [s]
  void drop_after(double t);
  bool empty() const { return incidents_.empty() && notices_.empty() && !has_large_islands(); }
  /// A step that a stability criterion names for the scene: the remedy then. [s]
  void name_step(double step);
  /// One a kind, in the order of kinds.
  std::vector<RunFault> faults() const;
  /// What was said, in the order of time.
  std::vector<std::string> notices() const;

 private:
  struct Incident {
    Size first, worst;
    std::string worst_subject;
    std::set<std::string> subjects;
    std::uint64_t count = 0;
  };

  using Notice = std::pair<double, std::string>;  // when it was said first [s], and the words

  std::map<Kind, Incident> incidents_;
  std::map<std::string, Notice> notices_;  // by subject
  double large_island_at_ = kInfinity;     // the first [s]
  double named_step_ = kUnset;             // [s]
};

/// "'a', 'b' and 3 more". @param bodies  of the world
std::string names_of(const World& world, const std::vector<int>& bodies);

}  // namespace tumble::engines
