/// From world coordinates to pixels and back. Without OpenGL: `poke --pixel` uses it too.
///
/// Pixels: (0, 0) is the top left corner of the picture, x to the right, y down; the centre of the
/// first pixel is (0.5, 0.5).
#pragma once

#include <optional>

#include "framework/dynamics/body.h"
#include "framework/scene/scene.h"

namespace tumble::render {

/// A camera at one instant, with its axes. World frame, unit vectors.
struct View {
  Vector3d eye_world;  // [m]
  Vector3d right_world, up_world, forward_world;
  double tan_half_height;  // tangent of half the vertical field of view [-]

  bool operator==(const View&) const = default;
};

/// @param shift_world  displacement of the followed body; zero where the camera follows nothing [m]
/// @throws UserError when eye and target coincide or the field of view is not in (0, 180) degrees
View view_of(const scene::CameraSpec& camera, const Vector3d& shift_world = Vector3d::Zero());

/// The ray from the eye through a point of a picture of width x height pixels; its direction is a
/// unit vector.
Ray pixel_ray(const View& view, int width, int height, double x, double y);
Ray pixel_ray(const scene::CameraSpec& camera, int width, int height, double x, double y);

/// Image of a point, in pixels; nothing for a point that is not in front of the eye.
std::optional<Vector2d> project(const View& view, int width, int height,
                                const Vector3d& point_world);

/// Size of one pixel at a point's depth [m].
double metres_per_pixel(const View& view, int height, const Vector3d& point_world);

}  // namespace tumble::render
