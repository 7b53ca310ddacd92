/// What a schema cannot say about springs, rods, joints, motors and contact: what is impossible or would do nothing.
#pragma once

#include "framework/scene/names.h"

namespace tumble::scene {

void check_links(const Scene& scene, const Refuse& refuse);

}  // namespace tumble::scene
