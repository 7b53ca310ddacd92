/// Whether statics alone tell what each rod and joint carries, and whether any force could.
#pragma once

#include <optional>
#include <string>

#include "framework/dynamics/laws.h"
#include "framework/scene/scene.h"

namespace tumble::engines {

/// Where more rods and joints hold bodies than their weight could tell apart, as three rods a beam:
/// that what is recorded of each is one of many ways to share the load, and of which. Looked at
/// where the scene begins, under gravity; in loops of at most 120 rows.
/// @return nothing where each force is the only one
std::optional<std::string> notice_of_shared_forces(const scene::Scene& scene, const Laws& laws);

/// Where bodies begin to move as rods and joints allow to first order and not to second, as the
/// middle of a rope of two rods that is stretched straight between two walls: that no finite force
/// holds them, and by which. Looked at as above, in loops of any size: of more rows iteratively, as
/// far as that leads in a time of some tenths of a second.
std::optional<std::string> notice_of_stretched_links(const scene::Scene& scene, const Laws& laws);

}  // namespace tumble::engines
