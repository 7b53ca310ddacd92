/// Drag: resistance of a medium at low speed, in proportion to the velocity.
///   F = -linear v,    tau = -angular w        (on the centre of mass, world frame)
#pragma once

#include <string>

namespace tumble::effects {

/// What a scene says of it.
struct DragSpec {
  std::string body;
  double linear_n_s_m = 0.0;
  double angular_n_m_s = 0.0;
  // JSON pointer of the entry that asked for it, for messages; empty: made in memory
  std::string pointer{};
};

/// What a world holds of it.
struct Drag {
  int body;
  double linear;   // [N s/m]
  double angular;  // [N m s]
};

}  // namespace tumble::effects
