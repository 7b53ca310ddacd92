#include "framework/grading/course/laws_around.h"

#include <algorithm>
#include <filesystem>

#include "framework/modules/load.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;
using modules::AnyModule;
using modules::ModuleKind;

bool needs(const scene::Scene& scene, const std::string& id) { return std::find(scene.needs.begin(), scene.needs.end(), id) != scene.needs.end(); }

}  // namespace

// (Not called bind: std::bind would be found through the arguments, and silently do nothing.)
void put_into(const ModuleKind& kind, const AnyModule& module, const std::string& source, Laws& laws) {
  kind.bind(module, laws);
  Laws alone;  // shows which laws this module is about
  kind.bind(module, alone);
  if (alone.collision_impulse) laws.impulse_source = source;
  if (alone.integrate_step) laws.integrator_source = source;
  if (alone.constraint_multipliers) laws.constraint_source = source;
  if (alone.scheduling) laws.scheduling_source = source;
}

AnyModule reference_of(const Course& course, const ModuleKind& kind) {
  const fs::path file = built_module(course, kind.id, "reference");
  return fs::exists(file) ? modules::load_module(kind, file) : nullptr;
}

Laws laws_around(const Course& course, const ModuleKind& kind, const AnyModule& module, const std::string& source, const scene::Scene& scene) {
  Laws laws = library_laws();
  for (const bool needed : {false, true}) {
    if (needed) {  // over what nobody asked for stand the library's laws of motion
      const Laws library = library_laws();
      laws.integrate_step = library.integrate_step;
      laws.state_derivative = library.state_derivative;
      laws.renormalize = library.renormalize;
      laws.find_impact_time = library.find_impact_time;
      laws.integrator_source = library.integrator_source;
    }
    for (const ModuleKind* other : course.registry->all())
      if (other->id != kind.id && needs(scene, other->id) == needed)
        if (const AnyModule reference = reference_of(course, *other)) put_into(*other, reference, "reference", laws);
  }
  if (!needs(scene, kind.id)) laws.scheduling = {};   // a reference's, that nobody asked for
  if (module) put_into(kind, module, source, laws);
  return laws;
}

}  // namespace tumble::grading
