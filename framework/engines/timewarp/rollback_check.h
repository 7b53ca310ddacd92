/// A debug mode of timewarp: now and then everything is rolled back to one time, goes on from there, and is rolled back to the same time
/// again. Rolled back means as if it had never been, so what stands there both times must be the same bytes; and since the run then goes on
/// from there, its committed trace must be what it is without.
#pragma once

#include <functional>
#include <string>

namespace tumble::engines {

/// What stands in a timewarp at one time, as bytes. Nothing in them tells how it came about: numbers that are never used twice (tickets,
/// passages), places in memory and what is stale are left out.
struct Standing {
  std::string states;   // by body: local virtual time, every flight that is kept
  std::string groups;   // by flight on a passage: who moves together, from what state, the steps so far, all that the same event began
  std::string events;   // that wait and are to come; that were worked at and are not taken back; which callbacks were called
  std::string cells;    // boxes swept from global to local virtual time, the cells they touch, who stands in which, which overlap
};

struct RollbackWatch {
  int every = 0;        // events (with several threads: rounds) between two trials, at least; 0: never
  int most_steps = 50;  // that processes take in between, one with the other: 1 to this, each number in its turn (with several threads: rounds)
  int first = 0;        // where in that row the first trial is
  /// @param t      to which all went back [s]
  /// @param steps  that were taken in between
  std::function<void(double t, int steps, const Standing& before, const Standing& after)> tell;
};

}  // namespace tumble::engines
