/// The key of this machine, with which a grader signs its records, so that it never reuses a record
/// that was written elsewhere.
///
/// The key file is $TUMBLE_GRADER_KEY, else $XDG_STATE_HOME/tumble/grader.key, else
/// ~/.local/state/tumble/grader.key: 32 random bytes, mode 0600, created on first use, never in a
/// folder of results. Losing it costs time: everything is graded again, and a
/// score that comes out lower than the ledger's waits for `tumble regrade`.
#pragma once

#include <filesystem>
#include <string>

namespace tumble::grading {

struct MachineKey {
  std::string bytes;  // 32
  // empty: the key could not be stored, and is lost with this process
  std::filesystem::path file;
  // for the user: why the key is new, or is not stored; empty: it existed
  std::string notice;
};

/// Path of the key, which may not exist.
std::filesystem::path machine_key_file();

/// Reads the key, or creates it. A machine that cannot store a key grades everything again each
/// time.
/// @throws UserError when the file exists and is not a key, or others can read it: it is never
///   overwritten
MachineKey machine_key();

}  // namespace tumble::grading
