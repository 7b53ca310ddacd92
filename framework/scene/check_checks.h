/// Rules for a scene's checks that a schema cannot express: what each kind needs, and names that
/// resolve.
#pragma once

#include "framework/scene/names.h"

namespace tumble::scene {

void check_checks(const Scene& scene, const Refuse& refuse);

}  // namespace tumble::scene
