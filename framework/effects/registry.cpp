#include "framework/effects/registry.h"

#include <algorithm>
#include <array>

#include "framework/core/error.h"

namespace tumble::effects {

Drawables drawn(const scene::Scene& scene) {
  Drawables drawables;
  for (const Effect* effect : all()) effect->draw(scene, drawables);
  return drawables;
}

std::vector<std::string> authors_of_listed_laws(const scene::Scene& scene, const Laws& laws) {
  const std::array named = {LawList::kNoSource, laws.impulse_source, laws.integrator_source,
                            laws.constraint_source};
  std::vector<std::string> authors;
  for (const Effect* effect : all()) {
    if (!effect->is_asked(scene)) continue;
    for (const NeededLaw& law : effect->needed_laws(scene, laws)) {
      if (std::find(named.begin(), named.end(), law.source) != named.end()) continue;
      const std::string author = law.what + " by " + law.source;
      if (std::find(authors.begin(), authors.end(), author) == authors.end())
        authors.push_back(author);
    }
  }
  return authors;
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
