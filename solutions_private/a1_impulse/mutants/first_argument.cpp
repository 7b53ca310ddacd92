// mutant: first_argument - every function returns its first argument, or what is nearest to it
// caught-by: gives nothing
#include "assignments/a1_impulse/a1_impulse.h"

#include <cmath>

namespace tumble::a1 {

// Nothing here is computed: what the tests still give for it is what they give for nothing.
std::optional<RayHit> intersect_ray_triangle(const Ray&, const Triangle&) { return std::nullopt; }
Wrench wrench_of_point_force(const Vector3d& force_world, const Vector3d&, const Vector3d&) {
  return {force_world, force_world};
}
Vector3d linear_acceleration(const Body& body, const Vector3d&) { return body.velocity_world; }
Vector3d angular_acceleration(const Body& body, const Vector3d&) { return body.omega_world; }
double relative_normal_velocity(const Contact& contact, const Body&, const Body&) {
  return contact.normal_b_to_a_world.z();
}
RelativeMotion classify_relative_motion(double, double) { return RelativeMotion::kResting; }
Vector2d contact_normal_vertex_edge(const Vector2d& first, const Vector2d&, const Vector2d&) {
  return first;
}
Vector2d contact_normal_edge_edge(const Vector2d& first, const Vector2d&, const Vector2d&) {
  return first;
}
Vector2d contact_normal_vertex_vertex(const Vector2d& first, const Vector2d&) { return first; }
double collision_impulse_without_rotation(const Contact& contact, const Body&, const Body&,
                                          double) {
  return contact.normal_b_to_a_world.z();
}
double collision_impulse(const Contact& contact, const Body&, const Body&, double) {
  return contact.normal_b_to_a_world.z();
}
Velocity apply_impulse(const Body& body, const Vector3d&, const Vector3d&) {
  return {body.velocity_world, body.omega_world};
}
CollisionOutcome resolve_collision(const Contact&, const Body& a, const Body& b, double) {
  return {{a.velocity_world, a.omega_world}, {b.velocity_world, b.omega_world}};
}

}  // namespace tumble::a1
