/// The speed at which bounces end in rest, where a scene does not say it.
#pragma once

#include "framework/scene/scene.h"

namespace tumble::engines {

/// Of the smallest body's radius: how high the last bounce is, at most, by a rest speed that the
/// scene does not give.
inline constexpr double kLastBounceOfRadius = 1e-5;

/// @return what the scene gives; or else its default, 1 mm/s, which is less where bodies are small
///   or slow: such that the last bounce of the smallest is at most kLastBounceOfRadius of its
///   radius high, and without gravity a hundredth of the fastest speed at the start. [m/s]
double rest_speed_of(const scene::Scene& scene);

}  // namespace tumble::engines
