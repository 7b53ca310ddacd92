#include "assignments/a1_impulse/a1_binding.h"

namespace tumble::a1 {

void bind(const Module& module, Laws& laws) {
  laws.relative_normal_velocity = module.relative_normal_velocity;
  laws.collision_impulse = module.collision_impulse;
  laws.apply_impulse = module.apply_impulse;
  laws.wrench_of_point_force = module.wrench_of_point_force;
  laws.intersect_ray_triangle = module.intersect_ray_triangle;
}

}  // namespace tumble::a1
