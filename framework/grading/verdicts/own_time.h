/// Own time of a process: the time that it computes and sleeps, without the time that it waits for
/// a core.
///
///   own = max( CPU time, wall time - run delay )
/// The run delay is the time that its first thread was ready and had no core (Linux,
/// /proc/PID/schedstat). Load on the machine increases wall time and run delay equally, so a limit
/// on own time ends the same code at the same point on an idle and on a loaded machine. Sleep is
/// not run delay, so it counts. Where the kernel does not report the delay, own time is wall time.
#pragma once

#include <sys/types.h>

#include <vector>

namespace tumble::grading {

/// The kernel's times of a process since it started.
struct ProcessTimes {
  double cpu_s = 0.0;     // of all its threads
  double delay_s = 0.0;   // of its first thread
  double age_s = 0.0;     // since it started
  bool is_known = false;  // false: there is no such process
};
/// Cost: about 10 us
ProcessTimes process_times(pid_t process);

/// Own time between two readings of one process.
/// @param wall_s  wall time between them
double own_time(const ProcessTimes& from, const ProcessTimes& to, double wall_s);

/// The children of a process, including zombies. Cost: one file of /proc, or all of /proc where the
/// kernel does not list children.
std::vector<pid_t> children_of(pid_t process);

/// The process at the end of a chain of first children; for a sandbox's keeper this is the program
/// inside.
/// @return -1 while the chain is shorter than `depth`
pid_t first_descendant(pid_t process, int depth);
/// Total CPU time and run delay of a process and its descendants [s]: constant while all of them
/// sleep or wait for input.
double activity_below(pid_t process);
/// Whether this kernel lists children (CONFIG_PROC_CHILDREN), which is needed to find the program
/// inside a sandbox.
bool shows_children();

/// Wall-clock limits are this many times the limit on own time, because on a loaded machine they
/// are not the submission's fault; a verdict by a wall clock is not final.
inline constexpr double kPatience = 30.0;

}  // namespace tumble::grading
