#include "framework/scene/json_text.h"

#include "framework/scene/document.h"

namespace tumble::scene {

void require_json(const std::string& text, const std::filesystem::path& file) {
  parse_document(text, file);
}

}  // namespace tumble::scene
