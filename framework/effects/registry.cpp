#include "framework/effects/registry.h"

#include "framework/core/error.h"

namespace tumble::effects {

Drawables drawn(const scene::Scene& scene) {
  Drawables drawables;
  for (const Effect* effect : all()) effect->draw(scene, drawables);
  return drawables;
}

}  // namespace tumble::effects

namespace tumble::scene {

const std::vector<const Words*>& all_words() {
  static const std::vector<const Words*> words(effects::all().begin(), effects::all().end());
  return words;
}

}  // namespace tumble::scene
