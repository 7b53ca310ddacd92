#include "framework/render/camera.h"

#include <cmath>
#include <numbers>

#include "framework/core/error.h"

namespace tumble::render {

View view_of(const scene::CameraSpec& camera, const Vector3d& shift_world) {
  const Vector3d sight = camera.target_m - camera.eye_m;
  if (!(sight.norm() > 0.0))
    throw UserError("camera", "eye and target are the same point", "Move one of them.");
  const double degrees = camera.field_of_view_deg;
  if (!(degrees > 0.0 && degrees < 180.0))
    throw UserError("camera", "a field of view of " + std::to_string(degrees) + " degrees",
                    "Choose one between 0 and 180, e.g. 40.");
  View view;
  view.eye_world = camera.eye_m + shift_world;
  view.forward_world = sight.normalized();
  // World z is up in the picture; world y for a vertical line of sight.
  const Vector3d z = Vector3d::UnitZ();
  // sine of the angle: below it the azimuth is round-off
  const bool vertical = view.forward_world.cross(z).norm() < 1e-6;
  const Vector3d upward = vertical ? Vector3d(Vector3d::UnitY()) : z;
  view.right_world = view.forward_world.cross(upward).normalized();
  view.up_world = view.right_world.cross(view.forward_world);
  view.tan_half_height = std::tan(degrees * std::numbers::pi / 360.0);
  return view;
}

Ray pixel_ray(const View& view, int width, int height, double x, double y) {
  const double half_height = view.tan_half_height, half_width = half_height * width / height;
  const double right = (2.0 * x / width - 1.0) * half_width,
               up = (1.0 - 2.0 * y / height) * half_height;
  return {view.eye_world,
          (view.forward_world + right * view.right_world + up * view.up_world).normalized()};
}

Ray pixel_ray(const scene::CameraSpec& camera, int width, int height, double x, double y) {
  return pixel_ray(view_of(camera), width, height, x, y);
}

std::optional<Vector2d> project(const View& view, int width, int height,
                                const Vector3d& point_world) {
  const Vector3d sight = point_world - view.eye_world;
  const double depth = sight.dot(view.forward_world);
  if (!(depth > 0.0)) return std::nullopt;
  const double half_height = view.tan_half_height * depth,
               half_width = half_height * width / height;
  return Vector2d(0.5 * width * (1.0 + sight.dot(view.right_world) / half_width),
                  0.5 * height * (1.0 - sight.dot(view.up_world) / half_height));
}

double metres_per_pixel(const View& view, int height, const Vector3d& point_world) {
  return 2.0 * view.tan_half_height * (point_world - view.eye_world).dot(view.forward_world) /
         height;
}

}  // namespace tumble::render
