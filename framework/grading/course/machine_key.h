/// The key of this machine: what a grader signs its own records with, so that it takes over nothing that somebody else wrote.
///
/// It lies in $TUMBLE_GRADER_KEY, else $XDG_STATE_HOME/tumble/grader.key, else ~/.local/state/tumble/grader.key: 32 random bytes, mode
/// 0600, made on first use. Never in a folder of results. Losing it costs time only: everything is graded again.
#pragma once

#include <filesystem>
#include <string>

namespace tumble::grading {

struct MachineKey {
  std::string bytes;             // 32
  std::filesystem::path file;    // where it lies; empty: it could not be kept, and ends with this process
  std::string notice;            // for the person at the terminal: why it is new, or is not kept; empty: it was there
};

/// Where the key lies, or would.
std::filesystem::path machine_key_file();

/// Reads the key, or makes it. A key that others can read or that is no key is replaced by a new one, and the notice says so.
/// Never throws: a machine that keeps no key grades everything anew each time.
MachineKey machine_key();

}  // namespace tumble::grading
