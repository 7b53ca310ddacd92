/// Which laws stand together: modules over each other, and the library's laws of motion between them. The one place that composes laws.
///
/// From the bottom: modules that a scene does not need (what may still be asked for, such as a push by hand), the library's laws of motion,
/// then modules that the scene needs or that somebody named. No scheduler is taken over from below.
#pragma once

#include <string>

#include "framework/dynamics/laws.h"
#include "framework/modules/registry.h"

namespace tumble::modules {

/// Puts a module's functions into the laws that it is about, and notes in each of these laws' sources whose they are.
/// @param source  for people and records: "a2 reference", "submission"
void bind_laws(const ModuleKind& kind, const AnyModule& module, const std::string& source, Laws& laws);

/// Over modules that the scene does not need: motion by the library, no scheduler.
void set_library_motion(Laws& laws);

}  // namespace tumble::modules
