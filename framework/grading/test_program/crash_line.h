/// The line of the user's file in which a test died: of a process that holds the user's own code,
/// and that is this program's fork, so that both have the same addresses.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string>

namespace tumble::grading {

/// Where a process was when a signal ended it, innermost first. In memory that it shares with its
/// parent.
struct DyingPlaces {
  static constexpr std::size_t kMost = 32;
  std::atomic<std::size_t> count{0};
  std::uintptr_t places[kMost] = {};  // addresses of instructions
};

/// From here on a deadly signal of this process is noted, and then ends it as it would have.
/// @param places  lives as long as the process
void note_places_when_dying(DyingPlaces& places);

/// @param source  the user's file
/// @return "a1_impulse.cpp:26", the innermost line in that file; empty where none is found
std::string line_of_crash(const DyingPlaces& places, const std::string& source);

/// The first "FILE:LINE" of addr2line that is of the file: its name with the line.
std::string line_in_source(const std::string& told, const std::string& source);

}  // namespace tumble::grading
