/// A piece of a mountainside for rocks to come down on.
#pragma once

#include "framework/geometry/triangle_mesh.h"

namespace tumble::models {

/// A closed block of ground: x runs downhill from -11.4 to 4.2 m, y from -3.3 to 3.3 m, z is up;
/// the toe of the slope lies a little below z = 0, so that the block stands in a flat valley. 35
/// degrees steep, with a step of rock half way, ridges, gullies and a run-out. Its two sides are
/// alike, so that pieces stand beside each other every 6.6 m without a seam. [m]
TriangleMesh mountainside();

}  // namespace tumble::models
