/// Comparisons of the a1 module's functions with reference values: impulses, and rays against
/// triangles.
#pragma once

#include "framework/modules/registry.h"

namespace tumble::a1 {

/// impulse_sphere_sphere, impulse_rod_ball, impulse_box_corner, impulse_random, ray_triangle.
void register_truths(modules::Registry& registry);

}  // namespace tumble::a1
