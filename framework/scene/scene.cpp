#include "framework/scene/scene.h"

#include "framework/core/error.h"

namespace tumble::scene {

Coordinates coordinates_named(const std::string& word, const std::string& where) {
  if (word == "maximal") return Coordinates::kMaximal;
  if (word == "reduced") return Coordinates::kReduced;
  if (word == "auto") return Coordinates::kAutomatic;
  throw UserError(where + " " + word, "expected maximal, reduced or auto",
                  "For example --coordinates reduced.");
}

int line_of(const Scene& scene, std::string pointer) {
  while (!scene.lines.contains(pointer) && !pointer.empty()) pointer.erase(pointer.rfind('/'));
  const auto found = scene.lines.find(pointer);
  return found == scene.lines.end() || pointer.empty() ? 0 : found->second;
}

std::string place_of(const Scene& scene, const std::string& pointer) {
  if (scene.lines.empty()) return scene.name;
  const int line = line_of(scene, pointer);
  return scene.file.string() + (line > 0 ? ':' + std::to_string(line) : "") + ": " + pointer;
}

}  // namespace tumble::scene
