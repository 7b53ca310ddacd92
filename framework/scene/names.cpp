#include "framework/scene/names.h"

#include <algorithm>

#include "framework/core/nearest_word.h"
#include "framework/scene/anchors.h"

namespace tumble::scene {

void Names::expect(const std::string& name, const std::string& pointer,
                   const Refuse& refuse) const {
  if (std::find(names_.begin(), names_.end(), name) != names_.end()) return;
  refuse(pointer, "no " + what_ + " is named '" + name + "'." + did_you_mean(name, names_),
         names_.empty() ? "The scene has none." : plural_ + ": " + listed(names_) + ".");
}

Names names_of_bodies(const Scene& scene) {
  std::vector<std::string> names;
  for (const auto& body : scene.bodies) names.push_back(body.name);
  return Names("body", "Bodies", std::move(names));
}

}  // namespace tumble::scene
