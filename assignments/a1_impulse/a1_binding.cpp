#include "assignments/a1_impulse/a1_binding.h"

#include "assignments/a1_impulse/a1_truths.h"
#include "framework/cost/showcase.h"
#include "framework/live/showcase.h"

namespace tumble::a1 {

void bind(const Module& module, Laws& laws) {
  laws.relative_normal_velocity = module.relative_normal_velocity;
  laws.collision_impulse = module.collision_impulse;
  laws.apply_impulse = module.apply_impulse;
  laws.wrench_of_point_force = module.wrench_of_point_force;
  laws.intersect_ray_triangle = module.intersect_ray_triangle;
}

void register_module(modules::Registry& registry) {
  registry.add<Module>(bind);
  registry.set_note(Module::kId, cost::CostShowcase{"collide_off_centre_e05", 2.0, true});
  registry.set_note(Module::kId, live::Showcase{"poked_box"});
  register_truths(registry);
}

}  // namespace tumble::a1
