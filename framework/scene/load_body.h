/// Reads the entry of a body, or of a lattice of bodies, from JSON. For the .cpp files of this
/// folder only.
#pragma once

#include <string>

#include "framework/scene/document.h"
#include "framework/scene/repeat.h"

namespace tumble::scene {

/// @param value    an entry of the schema's kind "body"
/// @param pointer  its position in the document
/// @throws UserError for what check_body refuses
BodySpec read_body(const nlohmann::json& value, const Document& document,
                   const std::string& pointer);

/// @param value  an entry of the schema's kind "repeat"
RepeatSpec read_repeat(const nlohmann::json& value, const Document& document,
                       const std::string& pointer);

/// "#rrggbb" or three numbers, as linear light.
Vector3d read_color(const nlohmann::json& value);

}  // namespace tumble::scene
