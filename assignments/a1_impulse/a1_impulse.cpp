// Your work for assignment 1. Replace each body; the comment above its declaration in a1_impulse.h
// says what it must do.
#include "assignments/a1_impulse/a1_impulse.h"

namespace tumble::a1 {

std::optional<RayHit> intersect_ray_triangle(const Ray&, const Triangle&) {
  throw NotImplemented("intersect_ray_triangle", "handouts/a1_impulse.md#hint-ray");
}

Wrench wrench_of_point_force(const Vector3d&, const Vector3d&, const Vector3d&) {
  throw NotImplemented("wrench_of_point_force", "handouts/a1_impulse.md#hint-wrench");
}

Vector3d linear_acceleration(const Body&, const Vector3d&) {
  throw NotImplemented("linear_acceleration", "handouts/a1_impulse.md#hint-linear");
}

Vector3d angular_acceleration(const Body&, const Vector3d&) {
  throw NotImplemented("angular_acceleration", "handouts/a1_impulse.md#hint-angular");
}

double relative_normal_velocity(const Contact&, const Body&, const Body&) {
  throw NotImplemented("relative_normal_velocity", "handouts/a1_impulse.md#hint-relative");
}

RelativeMotion classify_relative_motion(double, double) {
  throw NotImplemented("classify_relative_motion", "handouts/a1_impulse.md#hint-cases");
}

Vector2d contact_normal_vertex_edge(const Vector2d&, const Vector2d&, const Vector2d&) {
  throw NotImplemented("contact_normal_vertex_edge", "handouts/a1_impulse.md#hint-normals");
}

Vector2d contact_normal_edge_edge(const Vector2d&, const Vector2d&, const Vector2d&) {
  throw NotImplemented("contact_normal_edge_edge", "handouts/a1_impulse.md#hint-normals");
}

Vector2d contact_normal_vertex_vertex(const Vector2d&, const Vector2d&) {
  throw NotImplemented("contact_normal_vertex_vertex", "handouts/a1_impulse.md#hint-normals");
}

double collision_impulse_without_rotation(const Contact&, const Body&, const Body&, double) {
  throw NotImplemented("collision_impulse_without_rotation", "handouts/a1_impulse.md#hint-impulse");
}

double collision_impulse(const Contact&, const Body&, const Body&, double) {
  throw NotImplemented("collision_impulse", "handouts/a1_impulse.md#hint-impulse");
}

Velocity apply_impulse(const Body&, const Vector3d&, const Vector3d&) {
  throw NotImplemented("apply_impulse", "handouts/a1_impulse.md#hint-apply");
}

CollisionOutcome resolve_collision(const Contact&, const Body&, const Body&, double) {
  throw NotImplemented("resolve_collision", "handouts/a1_impulse.md#hint-resolve");
}

}  // namespace tumble::a1
