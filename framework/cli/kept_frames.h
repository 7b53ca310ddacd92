/// How many frames a run keeps in memory: as many as a picture, a page or a file asks for, and for
/// a run that only its numbers judge no more than an ordinary run has.
#pragma once

#include <cstddef>
#include <string>

namespace tumble::cli {

/// A run of up to so long keeps all of its frames. [s]
inline constexpr double kOrdinaryRun = 600.0;

struct KeptFrames {
  double rate_hz;       // of the run's frames
  std::string notice;   // how they were thinned, for the run's notices; empty: they are not
  std::string warning;  // how much memory they take, before the run; empty: little
};

/// @param rate_hz   of an ordinary run
/// @param is_shown  whether the run is drawn or recorded: then all are kept
KeptFrames kept_frames(double rate_hz, double duration_s, std::size_t bodies, bool is_shown);

}  // namespace tumble::cli
