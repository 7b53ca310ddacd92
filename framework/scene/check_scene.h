/// Rules for a scene that a schema cannot express: names that resolve, consistent masses, valid
/// inertia tensors.
#pragma once

#include "framework/scene/names.h"
#include "framework/scene/scene.h"

namespace tumble::scene {

/// Checks the entry of one body by itself.
void check_body(const BodySpec& body, const Refuse& refuse);

/// Refuses ellipsoids that may collide with anything but planes.
void check_ellipsoids(const Scene& scene, const Refuse& refuse);

/// Checks the relations between entries. @pre names of bodies are different, and those that links
/// name exist
void check_scene(const Scene& scene, const Refuse& refuse);

}  // namespace tumble::scene
