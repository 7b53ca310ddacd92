/// The laws of a scene with the functions of the module under test.
#pragma once

#include <string>

#include "framework/dynamics/laws.h"
#include "framework/grading/course/course.h"
#include "framework/scene/scene.h"

namespace tumble::grading {

/// The reference implementation, loaded into this process; nothing where the tree has none.
modules::AnyModule reference_of(const Course& course, const modules::ModuleKind& kind);

/// Combines a module with correct versions of the others, so that an error counts once: laws that
/// the scene needs and the module does not implement come from the reference where the tree has
/// one, else from the library.
/// @param module  may be empty: then the others only
/// @param source  of the module, for pictures and records
Laws laws_around(const Course& course, const modules::ModuleKind& kind,
                 const modules::AnyModule& module, const std::string& source,
                 const scene::Scene& scene);

}  // namespace tumble::grading
