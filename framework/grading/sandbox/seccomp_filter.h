/// The system calls that are denied to a sandboxed program.
#pragma once

namespace tumble::grading {

/// A descriptor (close-on-exec, at its start) with the compiled filter, for bubblewrap's --seccomp.
/// The caller closes it.
/// @throws std::runtime_error when it cannot be created: a program must not run without it
int make_seccomp_filter();

}  // namespace tumble::grading
