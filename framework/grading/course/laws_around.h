/// The laws of a scene with one module's functions in their place.
#pragma once

#include <string>

#include "framework/dynamics/laws.h"
#include "framework/grading/course/course.h"
#include "framework/scene/scene.h"

namespace tumble::grading {

/// The course's own module, loaded into this process; nothing where the tree has none.
modules::AnyModule reference_of(const Course& course, const modules::ModuleKind& kind);

/// Right neighbours around a module, so that a slip is seen once: what the scene needs and the module is not about is the reference's
/// where the tree has one, else the library's.
/// @param module  may be empty: then nothing is put over the neighbours
/// @param source  whose it is, for pictures and records
Laws laws_around(const Course& course, const modules::ModuleKind& kind, const modules::AnyModule& module, const std::string& source, const scene::Scene& scene);

}  // namespace tumble::grading
