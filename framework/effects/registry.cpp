#include "framework/effects/registry.h"

#include "framework/core/error.h"

namespace tumble::effects {

Drawables drawn(const scene::Scene& scene) {
  Drawables drawables;
  for (const Effect* effect : all()) effect->draw(scene, drawables);
  return drawables;
}

bool asks_laws_of(const std::string& assignment, const scene::Scene& scene) {
  for (const Effect* effect : all())
    if (effect->is_asked(scene))
      for (const NeededLaw& law : effect->needed_laws(scene, {}))
        if (law.assignment == assignment) return true;
  return false;
}

}  // namespace tumble::effects

namespace tumble::scene {

const std::vector<const Words*>& all_words() {
  static const std::vector<const Words*> words(effects::all().begin(), effects::all().end());
  return words;
}

}  // namespace tumble::scene
