/// A program that may start, and never another after it: a first filter asks the keeper about every
/// execve, the keeper permits one and hangs up, and the kernel refuses all later ones.
///
/// So a filter can be in force before the first instruction of the program, although a filter
/// cannot tell one execve from the next.
#pragma once

namespace tumble::grading {

/// Installs the first filter in this process, and sends its descriptor.
/// @param socket  a Unix socket to the keeper
/// @pre  no_new_privs is set
/// @throws std::runtime_error when the kernel refuses
void send_start_permit(int socket);

/// The keeper's side: receives the descriptor, permits the next execve, closes the descriptor.
/// Returns early when the child has ended instead.
void permit_one_start(int socket);

}  // namespace tumble::grading
