/// What a timewarp scheduler did, in the order in which it did it: the way of every local virtual time. An engine may record it; pages draw it.
#pragma once

#include <string>
#include <vector>

namespace tumble {

struct VirtualTimes {
  /// One process (body, group, multibody) integrated on, or rolled back where `to_s` is not later than `from_s`
  /// (equal: it forgets what it did at that very time).
  struct Move {
    int process;
    double from_s, to_s;              // its local virtual time before and after
    double global_virtual_time_s;     // after the move; never falls
  };
  std::vector<std::string> processes;
  std::vector<Move> moves;
};

}  // namespace tumble
