/// Runs isolated pieces of work, each in a process of its own, a few at a time.
#pragma once

#include <cstddef>
#include <functional>

namespace tumble::farm {

/// Runs work(0) ... work(count - 1), each in a forked process; an exception ends that process with
/// code 1.
/// On SIGINT, SIGTERM or SIGHUP all started processes and their descendants are killed and reaped,
/// `cleared` is called, then this process ends by the signal. A call of `done` is never
/// interrupted.
/// @param done  called in this process as each ends, in that order: index, wait status, duration
///   [s]; an exception of it ends those that run, and goes on to the caller
/// @pre  this process has no threads and no other children. The children die with it.
void run_in_processes(
    std::size_t count, int jobs, const std::function<void(std::size_t)>& work,
    const std::function<void(std::size_t index, int status, double seconds)>& done,
    const std::function<void()>& cleared = {});

}  // namespace tumble::farm
