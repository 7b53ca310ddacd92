/// A person's own module in this process, at full speed, and still no dump and no hang: a crash, an exception or a loop
/// without end in one of its functions ends the run with words that name the function. What somebody else wrote runs in
/// the sandbox instead (worker_connection.h): this guards against slips, not against intent.
#pragma once

#include <functional>
#include <string>

#include "framework/modules/registry.h"

namespace tumble::grading {

/// A call that lasts longer is a loop without end [s]: right calls take microseconds. By the clock, so that a call that
/// sleeps is found too; long, so that a loaded machine ends no right one.
constexpr double kGuardedCallLimit = 10.0;

/// The same module, each call guarded. A signal or a loop without end says so on stderr and exits with 1; an exception that
/// is the module's own becomes a CallEnded, which stops a run with its reason.
/// @param file  the module's source, for people
modules::AnyModule guarded(const modules::ModuleKind& kind, const modules::AnyModule& module, const std::string& file);

/// Runs `load`, which may run a module's static initialisers, under the same guard.
modules::AnyModule guarded_load(const std::string& file, const std::function<modules::AnyModule()>& load);

}  // namespace tumble::grading
