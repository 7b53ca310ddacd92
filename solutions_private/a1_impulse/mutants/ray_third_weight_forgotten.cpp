// mutant: ray_third_weight_forgotten - u and v tested, u + v not
// caught-by: all three weights must be >= 0
#include "assignments/a1_impulse/a1_impulse.h"

#include <cmath>

namespace tumble::a1 {

namespace {

Matrix3d inverse_inertia_world(const Body& body) {
  const Matrix3d R = body.world_from_body.toRotationMatrix();
  return R * body.inertia.inverse_inertia_body * R.transpose();
}

Vector3d point_velocity(const Body& body, const Vector3d& point_world) {
  const Vector3d r = point_world - body.com_world;
  return body.velocity_world + body.omega_world.cross(r);
}

}  // namespace

std::optional<RayHit> intersect_ray_triangle(const Ray& ray, const Triangle& triangle) {
  // Moeller-Trumbore, as printed.
  const Vector3d d = ray.direction_world;
  const Vector3d edge_ab = triangle.b_world - triangle.a_world;
  const Vector3d edge_ac = triangle.c_world - triangle.a_world;
  const Vector3d p = d.cross(edge_ac);
  const double determinant = edge_ab.dot(p);
  if (determinant == 0) return std::nullopt;
  const Vector3d from_a = ray.origin_world - triangle.a_world;
  const double u = from_a.dot(p) / determinant;
  const Vector3d q = from_a.cross(edge_ab);
  const double v = d.dot(q) / determinant;
  if (u < 0 || v < 0 || u > 1 || v > 1) return std::nullopt;
  const double t = edge_ac.dot(q) / determinant;
  if (t < 0) return std::nullopt;
  return RayHit{t, Vector3d(1 - u - v, u, v)};
}

Wrench wrench_of_point_force(const Vector3d& force_world, const Vector3d& point_world, const Vector3d& com_world) {
  const Vector3d r = point_world - com_world;
  return Wrench{force_world, r.cross(force_world)};
}

Vector3d linear_acceleration(const Body& body, const Vector3d& force_world) {
  return body.inertia.inverse_mass * force_world;
}

Vector3d angular_acceleration(const Body& body, const Vector3d& torque_world) {
  if (body.inertia.inverse_mass == 0) return Vector3d::Zero();
  const Matrix3d R = body.world_from_body.toRotationMatrix();
  const Vector3d omega_body = R.transpose() * body.omega_world;
  const Vector3d torque_body = R.transpose() * torque_world;
  const Vector3d angular_momentum_body = body.inertia.inertia_body * omega_body;
  const Vector3d gyroscopic_body = omega_body.cross(angular_momentum_body);
  return R * (body.inertia.inverse_inertia_body * (torque_body - gyroscopic_body));
}

double relative_normal_velocity(const Contact& contact, const Body& a, const Body& b) {
  const Vector3d u_a = point_velocity(a, contact.point_world);
  const Vector3d u_b = point_velocity(b, contact.point_world);
  return contact.normal_b_to_a_world.dot(u_a - u_b);
}

RelativeMotion classify_relative_motion(double normal_velocity, double tolerance) {
  if (std::abs(normal_velocity) <= tolerance) return RelativeMotion::kResting;
  return normal_velocity < 0 ? RelativeMotion::kApproaching : RelativeMotion::kSeparating;
}

Vector2d contact_normal_vertex_edge(const Vector2d& vertex_a_world, const Vector2d& edge_start_b_world, const Vector2d& edge_end_b_world) {
  const Vector2d edge = edge_end_b_world - edge_start_b_world;
  Vector2d normal(edge.y(), -edge.x());
  normal /= normal.norm();
  if (normal.dot(vertex_a_world - edge_start_b_world) < 0) normal = -normal;
  return normal;
}

Vector2d contact_normal_edge_edge(const Vector2d& edge_start_b_world, const Vector2d& edge_end_b_world, const Vector2d& com_a_world) {
  const Vector2d edge = edge_end_b_world - edge_start_b_world;
  Vector2d normal(edge.y(), -edge.x());
  normal /= normal.norm();
  if (normal.dot(com_a_world - edge_start_b_world) < 0) normal = -normal;
  return normal;
}

Vector2d contact_normal_vertex_vertex(const Vector2d& com_a_world, const Vector2d& com_b_world) {
  const Vector2d line = com_a_world - com_b_world;
  return line / line.norm();
}

double collision_impulse_without_rotation(const Contact& contact, const Body& a, const Body& b, double restitution) {
  const double u = contact.normal_b_to_a_world.dot(a.velocity_world - b.velocity_world);
  const double denominator = a.inertia.inverse_mass + b.inertia.inverse_mass;
  if (u >= 0 || denominator == 0) return 0;
  return -(1 + restitution) * u / denominator;
}

double collision_impulse(const Contact& contact, const Body& a, const Body& b, double restitution) {
  const Vector3d& n = contact.normal_b_to_a_world;
  const Vector3d r_a = contact.point_world - a.com_world;
  const Vector3d r_b = contact.point_world - b.com_world;
  const double u = relative_normal_velocity(contact, a, b);
  const Vector3d turning_a = (inverse_inertia_world(a) * r_a.cross(n)).cross(r_a);
  const Vector3d turning_b = (inverse_inertia_world(b) * r_b.cross(n)).cross(r_b);
  const double denominator = a.inertia.inverse_mass + b.inertia.inverse_mass + n.dot(turning_a + turning_b);
  if (u >= 0 || denominator == 0) return 0;
  return -(1 + restitution) * u / denominator;
}

Velocity apply_impulse(const Body& body, const Vector3d& impulse_world, const Vector3d& point_world) {
  const Vector3d r = point_world - body.com_world;
  Velocity after;
  after.linear_world = body.velocity_world + impulse_world * body.inertia.inverse_mass;
  after.angular_world = body.omega_world + inverse_inertia_world(body) * r.cross(impulse_world);
  return after;
}

CollisionOutcome resolve_collision(const Contact& contact, const Body& a, const Body& b, double restitution) {
  const double j = collision_impulse(contact, a, b, restitution);
  const Vector3d J = j * contact.normal_b_to_a_world;
  CollisionOutcome after;
  after.a = apply_impulse(a, J, contact.point_world);
  after.b = apply_impulse(b, -J, contact.point_world);
  return after;
}

}  // namespace tumble::a1
