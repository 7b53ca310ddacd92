/// Chains, and what a scene says of contact, of how constraints are kept, and of pairs apart, from JSON. For the .cpp files of this folder only.
#pragma once

#include "framework/scene/anchors.h"

namespace tumble::scene {

/// Adds the links and bodies of "chains". The bodies that chains begin and end at must be there.
void read_chains(const Document& document, Anchors& anchors, Scene& scene);

/// Adds contact, stabilisation and pairs apart. All bodies and effects must be there.
/// @throws UserError at the entry that names what is not there or cannot be
void read_links(const Document& document, Anchors& anchors, Scene& scene);

}  // namespace tumble::scene
