/// The time that a process takes for itself: what it computes and what it sleeps, without what it waits for a core.
///
///   own = max( CPU time, wall time - run delay )
/// The run delay is how long its first thread was ready and had no core (Linux, /proc/PID/schedstat). A loaded machine adds to wall time and
/// run delay alike, so that a limit on own time ends the same code at the same point on an idle machine and beside busy loops; sleep is
/// no run delay, so it counts. Where the kernel does not say, own time is wall time.
#pragma once

#include <sys/types.h>

#include <vector>

namespace tumble::grading {

/// What the kernel has counted of a process since it began.
struct ProcessTimes {
  double cpu_s = 0.0;     // of all its threads
  double delay_s = 0.0;   // of its first thread
  double age_s = 0.0;     // since it began
  bool is_known = false;  // false: there is no such process
};
/// Cost: some 10 us
ProcessTimes process_times(pid_t process);

/// Own time between two readings of one process, and the wall time between them.
double own_time(const ProcessTimes& from, const ProcessTimes& to, double wall_s);

/// The children of a process, the dead that nobody has waited for among them. Cost: a file of /proc, or all of /proc where the kernel shows no children.
std::vector<pid_t> children_of(pid_t process);

/// The process at the end of a chain of first children: of a sandbox's keeper the program inside.
/// @return -1 while the chain is shorter than `depth`
pid_t first_descendant(pid_t process, int depth);
/// CPU time and run delay of a process and all below it [s]: what does not grow while all of them sleep or wait for something.
double activity_below(pid_t process);
/// Whether this kernel shows children (CONFIG_PROC_CHILDREN), without which no program inside a sandbox is found.
bool shows_children();

/// A wall clock says nothing of a submission on a loaded machine. So many times a limit on own time it waits; what it ends is not final.
inline constexpr double kPatience = 30.0;

}  // namespace tumble::grading
