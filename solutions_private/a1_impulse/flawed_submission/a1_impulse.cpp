// A submission as they come in the evening before the deadline: most of it right, the inertia
// tensor in the wrong frame, a missing (1 + e), a crash where nothing was hit, and the last
// function not begun.
#include "assignments/a1_impulse/a1_impulse.h"

#include <cmath>

namespace tumble::a1 {

namespace {

// Plane first, then the weights. Returns nothing for a ray that never reaches the plane.
const Vector3d* plane_point(const Ray& ray, const Triangle& triangle, Vector3d& storage) {
  const Vector3d normal =
      (triangle.b_world - triangle.a_world).cross(triangle.c_world - triangle.a_world);
  const double slope = normal.dot(ray.direction_world);
  if (slope == 0) return nullptr;
  const double t = normal.dot(triangle.a_world - ray.origin_world) / slope;
  if (t < 0) return nullptr;
  storage = ray.origin_world + t * ray.direction_world;
  return &storage;
}

}  // namespace

std::optional<RayHit> intersect_ray_triangle(const Ray& ray, const Triangle& triangle) {
  Vector3d storage;
  // there is always a point, isn't there?
  const Vector3d& p = *plane_point(ray, triangle, storage);
  const Vector3d normal =
      (triangle.b_world - triangle.a_world).cross(triangle.c_world - triangle.a_world);
  const double w_a = normal.dot((triangle.c_world - triangle.b_world).cross(p - triangle.b_world)) /
                     normal.squaredNorm();
  const double w_b = normal.dot((triangle.a_world - triangle.c_world).cross(p - triangle.c_world)) /
                     normal.squaredNorm();
  const double w_c = 1 - w_a - w_b;
  if (w_a < 0 || w_b < 0 || w_c < 0) return std::nullopt;
  RayHit hit;
  hit.t = (p - ray.origin_world).dot(ray.direction_world) / ray.direction_world.squaredNorm();
  hit.barycentric = Vector3d(w_a, w_b, w_c);
  return hit;
}

Wrench wrench_of_point_force(const Vector3d& force_world, const Vector3d& point_world,
                             const Vector3d& com_world) {
  return {force_world, (point_world - com_world).cross(force_world)};
}

Vector3d linear_acceleration(const Body& body, const Vector3d& force_world) {
  return force_world * body.inertia.inverse_mass;
}

Vector3d angular_acceleration(const Body& body, const Vector3d& torque_world) {
  return body.inertia.inverse_inertia_body * torque_world;
}

double relative_normal_velocity(const Contact& contact, const Body& a, const Body& b) {
  const Vector3d u_a = a.velocity_world + a.omega_world.cross(contact.point_world - a.com_world);
  const Vector3d u_b = b.velocity_world + b.omega_world.cross(contact.point_world - b.com_world);
  return contact.normal_b_to_a_world.dot(u_a - u_b);
}

RelativeMotion classify_relative_motion(double normal_velocity, double tolerance) {
  if (std::abs(normal_velocity) <= tolerance) return RelativeMotion::kResting;
  return normal_velocity < 0 ? RelativeMotion::kApproaching : RelativeMotion::kSeparating;
}

Vector2d contact_normal_vertex_edge(const Vector2d& vertex_a_world,
                                    const Vector2d& edge_start_b_world,
                                    const Vector2d& edge_end_b_world) {
  const Vector2d edge = edge_end_b_world - edge_start_b_world;
  const Vector2d normal = Vector2d(edge.y(), -edge.x()).normalized();
  return normal.dot(vertex_a_world - edge_start_b_world) < 0 ? Vector2d(-normal) : normal;
}

Vector2d contact_normal_edge_edge(const Vector2d& edge_start_b_world,
                                  const Vector2d& edge_end_b_world, const Vector2d& com_a_world) {
  return contact_normal_vertex_edge(com_a_world, edge_start_b_world, edge_end_b_world);
}

Vector2d contact_normal_vertex_vertex(const Vector2d& com_a_world, const Vector2d& com_b_world) {
  return com_a_world - com_b_world;
}

double collision_impulse_without_rotation(const Contact& contact, const Body& a, const Body& b,
                                          double restitution) {
  const double u = contact.normal_b_to_a_world.dot(a.velocity_world - b.velocity_world);
  if (u >= 0) return 0;
  return -restitution * u / (a.inertia.inverse_mass + b.inertia.inverse_mass);
}

double collision_impulse(const Contact& contact, const Body& a, const Body& b, double restitution) {
  const Vector3d& n = contact.normal_b_to_a_world;
  const double u = relative_normal_velocity(contact, a, b);
  if (u >= 0) return 0;
  const Vector3d r_a = contact.point_world - a.com_world, r_b = contact.point_world - b.com_world;
  const double turning = n.dot((a.inertia.inverse_inertia_body * r_a.cross(n)).cross(r_a)) +
                         n.dot((b.inertia.inverse_inertia_body * r_b.cross(n)).cross(r_b));
  return -(1 + restitution) * u / (a.inertia.inverse_mass + b.inertia.inverse_mass + turning);
}

Velocity apply_impulse(const Body& body, const Vector3d& impulse_world,
                       const Vector3d& point_world) {
  const Vector3d r = point_world - body.com_world;
  return {body.velocity_world + impulse_world * body.inertia.inverse_mass,
          body.omega_world + body.inertia.inverse_inertia_body * r.cross(impulse_world)};
}

CollisionOutcome resolve_collision(const Contact&, const Body&, const Body&, double) {
  throw NotImplemented("resolve_collision", "handouts/a1_impulse.md#hint-resolve");
}

}  // namespace tumble::a1
