// mutant: all_zeros - every function returns 0
// caught-by: gives nothing
#include "assignments/a1_impulse/a1_impulse.h"

#include <cmath>

namespace tumble::a1 {

// Nothing here is computed: what the tests still give for it is what they give for nothing.
std::optional<RayHit> intersect_ray_triangle(const Ray&, const Triangle&) { return std::nullopt; }
Wrench wrench_of_point_force(const Vector3d&, const Vector3d&, const Vector3d&) {
  return {Vector3d::Zero(), Vector3d::Zero()};
}
Vector3d linear_acceleration(const Body&, const Vector3d&) { return Vector3d::Zero(); }
Vector3d angular_acceleration(const Body&, const Vector3d&) { return Vector3d::Zero(); }
double relative_normal_velocity(const Contact&, const Body&, const Body&) { return 0.0; }
RelativeMotion classify_relative_motion(double, double) { return RelativeMotion{}; }
Vector2d contact_normal_vertex_edge(const Vector2d&, const Vector2d&, const Vector2d&) {
  return Vector2d::Zero();
}
Vector2d contact_normal_edge_edge(const Vector2d&, const Vector2d&, const Vector2d&) {
  return Vector2d::Zero();
}
Vector2d contact_normal_vertex_vertex(const Vector2d&, const Vector2d&) { return Vector2d::Zero(); }
double collision_impulse_without_rotation(const Contact&, const Body&, const Body&, double) {
  return 0.0;
}
double collision_impulse(const Contact&, const Body&, const Body&, double) { return 0.0; }
Velocity apply_impulse(const Body&, const Vector3d&, const Vector3d&) {
  return {Vector3d::Zero(), Vector3d::Zero()};
}
CollisionOutcome resolve_collision(const Contact&, const Body&, const Body&, double) {
  return {{Vector3d::Zero(), Vector3d::Zero()}, {Vector3d::Zero(), Vector3d::Zero()}};
}

}  // namespace tumble::a1
