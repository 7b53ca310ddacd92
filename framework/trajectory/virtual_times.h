/// The moves of a timewarp scheduler in execution order: the history of every local virtual time.
/// An engine may record it; pages draw it.
#pragma once

#include <string>
#include <vector>

namespace tumble {

struct VirtualTimes {
  /// One logical process (body, island, multibody) advances, or rolls back where `to_s` is not
  /// later than `from_s` (equal: it undoes its events at exactly that time).
  struct Move {
    int process;
    double from_s, to_s;           // its local virtual time before and after
    double global_virtual_time_s;  // after the move; never decreases
  };
  std::vector<std::string> processes;
  std::vector<Move> moves;
  // the engine made more moves than it records: these are the first ones
  bool is_cut = false;
};

}  // namespace tumble
