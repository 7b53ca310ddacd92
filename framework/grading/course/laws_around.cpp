#include "framework/grading/course/laws_around.h"

#include <algorithm>
#include <filesystem>

#include "framework/modules/bind_laws.h"
#include "framework/modules/load.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;
using modules::AnyModule;
using modules::ModuleKind;

bool needs(const scene::Scene& scene, const std::string& id) {
  return std::find(scene.needs.begin(), scene.needs.end(), id) != scene.needs.end();
}

}  // namespace

AnyModule reference_of(const Course& course, const ModuleKind& kind) {
  const fs::path file = built_module(course, kind.id, "reference");
  return fs::exists(file) ? modules::load_module(kind, file) : nullptr;
}

Laws laws_around(const Course& course, const ModuleKind& kind, const AnyModule& module,
                 const std::string& source, const scene::Scene& scene) {
  Laws laws;
  const auto add_neighbours = [&](bool needed) {
    for (const ModuleKind* other : course.registry->all())
      if (other->id != kind.id && needs(scene, other->id) == needed)
        if (const AnyModule reference = reference_of(course, *other))
          modules::bind_laws(*other, reference, "reference", laws);
  };
  add_neighbours(false);
  modules::set_library_motion(laws);
  add_neighbours(true);
  // the reference's scheduler, which the scene does not need
  if (!needs(scene, kind.id)) laws.scheduling = {};
  if (module) modules::bind_laws(kind, module, source, laws);
  return laws;
}

}  // namespace tumble::grading
