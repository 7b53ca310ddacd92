/// What ties, slows and drives bodies, from JSON: rods, joints, motors, contact. For the .cpp files of this folder only.
#pragma once

#include "framework/scene/anchors.h"

namespace tumble::scene {

/// Adds the links and bodies of "chains". The bodies that chains begin and end at must be there.
void read_chains(const Document& document, Anchors& anchors, Scene& scene);

/// Adds rods, joints, motors and contact. All bodies must be there.
/// @throws UserError at the entry that names what is not there or cannot be
void read_links(const Document& document, Anchors& anchors, Scene& scene);

}  // namespace tumble::scene
