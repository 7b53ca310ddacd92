/// The system calls that a sandboxed program is refused.
#pragma once

namespace tumble::grading {

/// A descriptor (close-on-exec, read from its start) holding the compiled filter, as bubblewrap's --seccomp wants it.
/// The caller closes it.
/// @throws std::runtime_error when it cannot be made: a program must not run without it
int make_seccomp_filter();

}  // namespace tumble::grading
