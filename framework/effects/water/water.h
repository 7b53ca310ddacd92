/// Water below a level: buoyancy of what lies under it (Archimedes), and a drag spread evenly over
/// that.
///   dF = rho (g up - k (v - u)) dV,    v = v_c + w x r,   u: the stream
///   F   = rho (V g up - k (V (v_c - u) + w x f))
///   tau = rho (f x g up - k (f x (v_c - u) + tr(S) w - S w))        about the centre of mass
///   E   = rho g int (level - z) dV                                  of the buoyancy
/// with the volume V, first moment f and second moment S of what is under the level, about the
/// centre of mass (submerged.h). It gives no added mass and no waves, and what lies over the
/// water's edge does not spill it.
#pragma once

#include <string>

#include "framework/effects/water/submerged.h"
#include "framework/scene/scene.h"

namespace tumble::effects {

/// What a scene says of it, at most once.
struct WaterSpec {
  Vector3d surface_m = Vector3d::Zero();  // a point of its surface
  double density_kg_m3 = 1000.0;
  double drag_1_s = 0.0;                   // k
  Vector3d stream_m_s = Vector3d::Zero();  // u, world
  // JSON pointer of the entry that asked for it, for messages; empty: made in memory
  std::string pointer{};
};

/// What a world holds of it: one for each movable body.
struct Floating {
  int body;
  WaterSpec water;
  double gravity;  // g [m/s^2]
  Floatable solid;
};

}  // namespace tumble::effects
