/// What a schema cannot say about a scene: names that resolve, masses that fit, matrices that are inertias.
#pragma once

#include <functional>
#include <string>

#include "framework/scene/scene.h"

namespace tumble::scene {

/// Called with a place (a key of the body, or a JSON pointer of the scene), what is wrong there, and what to do. Must throw.
using Refuse = std::function<void(const std::string& place, const std::string& problem, const std::string& remedy)>;

/// Everything that one body's entry must hold on its own.
void check_body(const BodySpec& body, const Refuse& refuse);

/// Everything between entries. @pre names of bodies are different, and those that links name are there
void check_scene(const Scene& scene, const Refuse& refuse);

}  // namespace tumble::scene
