/// Whether a text is JSON, for files that are no scenes.
#pragma once

#include <filesystem>
#include <string>

namespace tumble::scene {

/// @throws UserError with line and column for text that is no JSON, a key twice in one object, or a
///   number beyond 1e60
void require_json(const std::string& text, const std::filesystem::path& file);

}  // namespace tumble::scene
