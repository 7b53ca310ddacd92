/// The only place that composes laws: from modules in layers, and the library's laws of motion.
///
/// From the bottom: modules that the scene does not need (for interactive use, such as `poke`), the
/// library's laws of motion, then modules that the scene needs or that the user has named. A
/// scheduler of the lowest layer is dropped.
#pragma once

#include <string>

#include "framework/dynamics/laws.h"
#include "framework/modules/registry.h"

namespace tumble::modules {

/// Sets the laws that a module implements to its functions, and the sources of these laws to
/// `source`.
/// @param source  for messages and records: "a2 reference", "submission"
void bind_laws(const ModuleKind& kind, const AnyModule& module, const std::string& source,
               Laws& laws);

/// The second layer: sets motion by the library, and no scheduler.
void set_library_motion(Laws& laws);

}  // namespace tumble::modules
