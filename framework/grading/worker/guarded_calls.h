/// Runs the user's own module in this process, at full speed, and guards its calls: a crash, an
/// exception or an endless loop in one of its functions ends the run with a message that names the
/// function. Modules of others run in the sandbox instead (worker_connection.h): this protects
/// against mistakes, not against attacks.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "framework/modules/registry.h"

namespace tumble::grading {

/// A longer call counts as an endless loop [s of wall-clock time, so that sleeping is found too].
/// Right calls take microseconds; the limit is long, so that a loaded machine ends no right call.
constexpr double kGuardedCallLimit = 10.0;

/// For a process of which another tells the user: another limit for all its guarded calls [s], and
/// a line "frame OBJECT 0xOFFSET" for each place in the stack, innermost first, before the message.
/// @param say_more  called behind these lines, in a signal handler: writes lines of its own to
///   stderr, with say_in_handler() alone; may be null
void guard_for_another(double seconds, void (*say_more)() = nullptr);

/// Writes to stderr, as a signal handler may. A number in decimal.
void say_in_handler(const char* text);
void say_in_handler(std::uint64_t number);

/// The same module with guarded calls. On a signal or an endless loop the process prints a message
/// to stderr and exits with 1; an exception of the module itself becomes a CallEnded, which stops a
/// run with its reason.
/// @param file  the module's source, for messages
modules::AnyModule guarded(const modules::ModuleKind& kind, const modules::AnyModule& module,
                           const std::string& file);

/// Runs `load`, which may execute a module's static initialisers, under the same guard.
modules::AnyModule guarded_load(const std::string& file,
                                const std::function<modules::AnyModule()>& load);

}  // namespace tumble::grading
