/// Indices of the geometries that every stage has; models follow. Internal to framework/render.
#pragma once

namespace tumble::render {

constexpr int kBallLevels = 4;  // of detail: 80, 320, 1280, 5120 faces
constexpr int kCoilLevels = 3;  // of turns
enum {
  kBall,
  kBoxGeometry = kBall + kBallLevels,
  kPlate,
  kArrow,
  kTube,
  kRod,
  kCoil,
  kFirstMesh = kCoil + kCoilLevels
};

/// The coarsest level whose outline is within a third of a pixel of a circle.
/// Level k splits an icosahedron's edge of 63.4 degrees into 2^(k+1), and the distance between a
/// chord over the angle e and its arc is r (1 - cos(e / 2)): 0.038 r, 0.0095 r, 0.0024 r, 0.0006 r.
/// @param radius_pixels  of the ball in the picture; below 0 where it is behind the eye
constexpr int ball_level(double radius_pixels) {
  return radius_pixels < 8 ? 0 : radius_pixels < 32 ? 1 : radius_pixels < 128 ? 2 : 3;
}

/// 10, 20 or 40 turns: long thin springs have more than short ones.
constexpr int coil_turns(int level) { return 10 << level; }

}  // namespace tumble::render
