/// A debug mode of timewarp: at intervals all processes are rolled back to one time, advance, and
/// are rolled back to the same time again. A rolled-back state must be as if its future had never
/// been computed, so both snapshots must have the same bytes; and the run continues from there, so
/// its committed trace must be that of a run without this mode.
#pragma once

#include <functional>
#include <string>

namespace tumble::engines {

/// The state of a timewarp at one time, as bytes. It does not depend on how the state came about:
/// numbers that are used only once (versions, segments), addresses in memory and stale items are
/// left out.
struct StateSnapshot {
  std::string states;  // by body: local virtual time and every saved flight
  // by flight on a segment: the island's members, start state, steps so far, and all flights that
  // began with the same event
  std::string groups;
  // the pending events; the executed events that are not rolled back; the callbacks that have been
  // executed
  std::string events;
  // boxes swept from global to local virtual time, their cells, the bodies of each bucket, and the
  // overlapping pairs
  std::string cells;
};

struct RollbackCheck {
  // events (with several threads: epochs) between two injections, at least; 0: never
  int every = 0;
  // of processes between the two rollbacks, in total: 1 to this number, each in turn (with several
  // threads: epochs)
  int most_steps = 50;
  int first = 0;  // place of the first injection in that sequence
  /// @param t      the time of both rollbacks [s]
  /// @param steps  taken between them
  std::function<void(double t, int steps, const StateSnapshot& before, const StateSnapshot& after)>
      report;
};

}  // namespace tumble::engines
