/// The frames through which the path of a body is drawn. Internal to framework/render; without
/// OpenGL.
#pragma once

#include <cstddef>
#include <vector>

#include "framework/trajectory/trajectory.h"

namespace tumble::render {

/// A subset of the run's frames, in order, from its first frame with a finite pose: no point of a
/// frame that is left out is farther than 1.5 `slack_m` from the line between its neighbours in the
/// subset. For every frame between two neighbours the same holds for the line from the former
/// neighbour to it, so a path may end at any frame.
/// Frames with a pose that is not finite are left out.
/// Source: C. M. Williams, Computer Graphics and Image Processing 8(2), 1978, for planar curves; in
///   space the intersection of two cones is replaced by the largest cone within it.
/// Cost: O(frames)
/// @param slack_m  above 0
std::vector<std::size_t> path_frames(const Trajectory& run, std::size_t body, double slack_m);

}  // namespace tumble::render
