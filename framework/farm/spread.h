/// Makes the pieces of a work that are missing, each in a process of its own on this machine, or as
/// tasks of a cluster. What a piece gives depends on the piece alone, so that all ways give the
/// same bytes.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "framework/farm/cluster.h"
#include "framework/farm/parts.h"
#include "framework/farm/shard.h"

namespace tumble::farm {

/// A work in pieces.
struct SplitWork {
  std::vector<std::string> names;   // of its pieces: names of their files
  std::vector<std::string> labels;  // of them, for people; empty: as the names
  std::string unit;                 // what one is: "chain"
  /// The bytes of a piece. May run in a forked process; an exception ends the whole work.
  std::function<std::string(std::size_t index)> make;

  const std::string& label(std::size_t index) const {
    return labels.empty() ? names[index] : labels[index];
  }
};

/// A piece that was not made.
struct Lost {
  std::string name;   // of its file
  std::string label;  // for people
  std::string why;    // "its process was ended by signal 9"
};

struct Outcome {
  std::size_t taken_over = 0;  // pieces that an earlier start had finished
  std::vector<Lost> lost;      // in the order of names
};

struct LocalOptions {
  int jobs = 1;                // pieces at a time
  std::optional<Shard> shard;  // only these pieces, which then are all that Outcome tells of
  // after each piece: how many of all are there, and the time that the rest will take [s]
  std::function<void(std::size_t done, std::size_t all, double seconds_left)> progress;
};

/// @pre  this process has no threads and no other children
/// @throws what the first piece threw that could not be made
Outcome make_here(const KeptParts& parts, const SplitWork& work, const LocalOptions& options);

/// @param job  of what the names, counts and conditions are not yet filled in
/// @throws UserError when the scheduler is not there or refuses the job; what a piece threw
Outcome make_on(const KeptParts& parts, const SplitWork& work, ClusterJob job);

}  // namespace tumble::farm
