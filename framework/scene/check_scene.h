/// What a schema cannot say about a scene: names that resolve, masses that fit, matrices that are inertias.
#pragma once

#include "framework/scene/names.h"
#include "framework/scene/scene.h"

namespace tumble::scene {

/// Everything that one body's entry must hold on its own.
void check_body(const BodySpec& body, const Refuse& refuse);

/// That no ellipsoid may meet anything but planes.
void check_ellipsoids(const Scene& scene, const Refuse& refuse);

/// Everything between entries. @pre names of bodies are different, and those that links name are there
void check_scene(const Scene& scene, const Refuse& refuse);

}  // namespace tumble::scene
