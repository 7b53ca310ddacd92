/// What a schema cannot say about a scene's checks: what each kind needs, and names that resolve.
#pragma once

#include "framework/scene/names.h"

namespace tumble::scene {

void check_checks(const Scene& scene, const Refuse& refuse);

}  // namespace tumble::scene
