/// Rules for links (springs, rods, joints) that a schema cannot express.
#pragma once

#include "framework/scene/names.h"

namespace tumble::scene {

/// Refuses two links with one name.
void check_links(const Scene& scene, const Refuse& refuse);

/// The body of an anchor, for errors: "the world", "'bob'".
std::string ending(const AnchorSpec& anchor);
/// Refuses a link from a body to itself, and one with two immovable ends. @param who  such as
/// "spring 'a'"
void check_ends(const std::string& who, const AnchorSpec& a, const AnchorSpec& b,
                const std::string& pointer, const BodiesByName& bodies, const Refuse& refuse);

}  // namespace tumble::scene
