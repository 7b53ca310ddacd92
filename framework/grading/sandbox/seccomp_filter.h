/// The system calls that are denied to a sandboxed program.
#pragma once

#include <linux/filter.h>
#include <sys/types.h>

#include <vector>

namespace tumble::grading {

struct FilterRules {
  bool is_on_host = false;  // it shares the user's processes and files with others
  // SandboxJob::is_alone; only on the host, where no process 1 needs to start the program
  bool is_alone = false;
  // a list of what is allowed, in place of one of what is refused: nothing can be opened
  bool has_no_files = false;
  pid_t self = 0;  // of the program, which may signal itself: abort() does
};

/// A descriptor (close-on-exec, at its start) with the compiled filter, for bubblewrap's --seccomp.
/// The caller closes it.
/// @throws std::runtime_error when it cannot be created: a program must not run without it
int make_seccomp_filter();

/// A filter for this process.
class SeccompFilter {
 public:
  /// @throws std::runtime_error as above
  explicit SeccompFilter(const FilterRules& rules);
  /// Puts it in force, for this process and its descendants. Allocates no memory.
  /// @pre  no_new_privs is set
  /// @throws std::runtime_error when the kernel refuses
  void restrict_self();

 private:
  std::vector<sock_filter> program_;
};

}  // namespace tumble::grading
