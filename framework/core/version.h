/// Which program made an output.
#pragma once

namespace tumble {

/// "0.1.0 (25ccc19a01)": the project's version, and the commit at configuration where the tree has
/// a history. It does not say whether files have changed since that commit.
extern const char* const kProgramVersion;

}  // namespace tumble
