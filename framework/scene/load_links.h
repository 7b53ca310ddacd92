/// Reads chains, contact, stabilisation, and pairs that do not collide from JSON. For the .cpp
/// files of this folder only.
#pragma once

#include "framework/scene/anchors.h"

namespace tumble::scene {

/// Adds the links and bodies of "chains". The bodies at the ends of chains must exist.
void read_chains(const Document& document, Anchors& anchors, Scene& scene);

/// Adds contact, stabilisation and pairs that do not collide. All bodies and effects must exist.
/// @throws UserError at the entry that names something missing or impossible
void read_links(const Document& document, Anchors& anchors, Scene& scene);

}  // namespace tumble::scene
