// A right solution, written the way the handout reads: inertia tensors as world matrices, each term
// as it stands in the equation, the ray by three volumes.
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

/// Twice d . (p x q), written so that p and q swapped give exactly the opposite number, and that a
/// far origin (large p and q, small q - p) costs few digits.
double volume(const Vector3d& d, const Vector3d& p, const Vector3d& q) {
  return d.dot((p + q).cross(q - p));
}

}  // namespace

std::optional<RayHit> intersect_ray_triangle(const Ray& ray, const Triangle& triangle) {
  const Vector3d& d = ray.direction_world;
  const Vector3d a = triangle.a_world - ray.origin_world;
  const Vector3d b = triangle.b_world - ray.origin_world;
  const Vector3d c = triangle.c_world - ray.origin_world;

  // The ray passes each edge on one side or the other: the sign of the volume that it spans with
  // the edge.
  const double side_bc = volume(d, b, c);
  const double side_ca = volume(d, c, a);
  const double side_ab = volume(d, a, b);
  const bool inside_front = side_bc >= 0 && side_ca >= 0 && side_ab >= 0;
  const bool inside_back = side_bc <= 0 && side_ca <= 0 && side_ab <= 0;
  if (!inside_front && !inside_back) return std::nullopt;

  const double sum = side_bc + side_ca + side_ab;
  if (sum == 0) return std::nullopt;
  const Vector3d weights(side_bc / sum, side_ca / sum, side_ab / sum);

  // The point hit, seen from the origin, is t d.
  int k = 0;
  d.cwiseAbs().maxCoeff(&k);
  const double t = (weights[0] * a[k] + weights[1] * b[k] + weights[2] * c[k]) / d[k];
  if (t < 0) return std::nullopt;
  return RayHit{t, weights};
}

Wrench wrench_of_point_force(const Vector3d& force_world, const Vector3d& point_world,
                             const Vector3d& com_world) {
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

Vector2d contact_normal_vertex_edge(const Vector2d& vertex_a_world,
                                    const Vector2d& edge_start_b_world,
                                    const Vector2d& edge_end_b_world) {
  const Vector2d edge = edge_end_b_world - edge_start_b_world;
  Vector2d normal(edge.y(), -edge.x());
  normal /= normal.norm();
  if (normal.dot(vertex_a_world - edge_start_b_world) < 0) normal = -normal;
  return normal;
}

Vector2d contact_normal_edge_edge(const Vector2d& edge_start_b_world,
                                  const Vector2d& edge_end_b_world, const Vector2d& com_a_world) {
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

double collision_impulse_without_rotation(const Contact& contact, const Body& a, const Body& b,
                                          double restitution) {
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
  const double denominator =
      a.inertia.inverse_mass + b.inertia.inverse_mass + n.dot(turning_a + turning_b);
  if (u >= 0 || denominator == 0) return 0;
  return -(1 + restitution) * u / denominator;
}

Velocity apply_impulse(const Body& body, const Vector3d& impulse_world,
                       const Vector3d& point_world) {
  const Vector3d r = point_world - body.com_world;
  Velocity after;
  after.linear_world = body.velocity_world + impulse_world * body.inertia.inverse_mass;
  after.angular_world = body.omega_world + inverse_inertia_world(body) * r.cross(impulse_world);
  return after;
}

CollisionOutcome resolve_collision(const Contact& contact, const Body& a, const Body& b,
                                   double restitution) {
  const double j = collision_impulse(contact, a, b, restitution);
  const Vector3d J = j * contact.normal_b_to_a_world;
  CollisionOutcome after;
  after.a = apply_impulse(a, J, contact.point_world);
  after.b = apply_impulse(b, -J, contact.point_world);
  return after;
}

}  // namespace tumble::a1
