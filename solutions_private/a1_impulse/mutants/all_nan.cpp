// mutant: all_nan - every function returns NaN
// caught-by: gives nothing
#include "assignments/a1_impulse/a1_impulse.h"

#include <cmath>

namespace tumble::a1 {

// Nothing here is computed: what the tests still give for it is what they give for nothing.
std::optional<RayHit> intersect_ray_triangle(const Ray&, const Triangle&) { return RayHit{}; }
Wrench wrench_of_point_force(const Vector3d&, const Vector3d&, const Vector3d&) {
  return {Vector3d::Constant(std::nan("")), Vector3d::Constant(std::nan(""))};
}
Vector3d linear_acceleration(const Body&, const Vector3d&) {
  return Vector3d::Constant(std::nan(""));
}
Vector3d angular_acceleration(const Body&, const Vector3d&) {
  return Vector3d::Constant(std::nan(""));
}
double relative_normal_velocity(const Contact&, const Body&, const Body&) { return std::nan(""); }
RelativeMotion classify_relative_motion(double, double) { return static_cast<RelativeMotion>(-1); }
Vector2d contact_normal_vertex_edge(const Vector2d&, const Vector2d&, const Vector2d&) {
  return Vector2d::Constant(std::nan(""));
}
Vector2d contact_normal_edge_edge(const Vector2d&, const Vector2d&, const Vector2d&) {
  return Vector2d::Constant(std::nan(""));
}
Vector2d contact_normal_vertex_vertex(const Vector2d&, const Vector2d&) {
  return Vector2d::Constant(std::nan(""));
}
double collision_impulse_without_rotation(const Contact&, const Body&, const Body&, double) {
  return std::nan("");
}
double collision_impulse(const Contact&, const Body&, const Body&, double) { return std::nan(""); }
Velocity apply_impulse(const Body&, const Vector3d&, const Vector3d&) { return {}; }
CollisionOutcome resolve_collision(const Contact&, const Body&, const Body&, double) {
  return {{}, {}};
}

}  // namespace tumble::a1
