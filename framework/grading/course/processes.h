/// Pieces of work that must not touch each other: a process each, a few at a time.
#pragma once

#include <cstddef>
#include <functional>

namespace tumble::grading {

/// Runs work(0) ... work(count - 1), each in a forked process that ends with it; an exception ends it with code 1.
/// SIGINT, SIGTERM and SIGHUP end it in an orderly way: every process that was started, and what those started, is ended and
/// reaped, `cleared` is called, then this process ends by the signal. No `done` is cut in two.
/// @param done  called here as each ends, in the order in which they end: index, wait status, seconds it took
/// @pre  this process runs no thread, and has no other children. They die with it.
void run_in_processes(std::size_t count, int jobs, const std::function<void(std::size_t)>& work,
                      const std::function<void(std::size_t index, int status, double seconds)>& done, const std::function<void()>& cleared = {});

}  // namespace tumble::grading
