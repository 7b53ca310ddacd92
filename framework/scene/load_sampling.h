/// Reads what a scene file says about sampling its worlds.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "framework/scene/sampling_spec.h"
#include "framework/scene/scene.h"

namespace tumble::scene {

struct Document;

/// Nothing where the file has no "sampling".
/// @param scene  of the document, its bodies read
/// @throws UserError with file, line and pointer
std::optional<SamplingSpec> read_sampling(const Document& document, const Scene& scene);

/// The same of a scene that was loaded from a file, and of one that was parsed from a text.
std::optional<SamplingSpec> load_sampling(const Scene& scene);
std::optional<SamplingSpec> parse_sampling(const std::string& text, const Scene& scene);

}  // namespace tumble::scene
