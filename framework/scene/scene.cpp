#include "framework/scene/scene.h"

namespace tumble::scene {

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
