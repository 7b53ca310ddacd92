/// What a schema cannot say about links: springs, rods, joints.
#pragma once

#include "framework/scene/names.h"

namespace tumble::scene {

/// Refuses two links of one name.
void check_links(const Scene& scene, const Refuse& refuse);

/// What an anchor belongs to, as an error calls it: "the world", "'bob'".
std::string ending(const AnchorSpec& anchor);
/// Refuses a link from a body to itself, and one of which neither end can move. @param who  such as "spring 'a'"
void check_ends(const std::string& who, const AnchorSpec& a, const AnchorSpec& b, const std::string& pointer, const BodiesByName& bodies, const Refuse& refuse);

}  // namespace tumble::scene
