/// What a schema cannot say about rods, joints, motors and contact: what is impossible or would do nothing.
#pragma once

#include "framework/scene/names.h"

namespace tumble::scene {

void check_links(const Scene& scene, const Refuse& refuse);

/// Refuses a link from a body to itself, and one of which neither end can move. @param who  such as "spring 'a'"
void check_ends(const std::string& who, const AnchorSpec& a, const AnchorSpec& b, const std::string& pointer, const BodiesByName& bodies, const Refuse& refuse);

}  // namespace tumble::scene
