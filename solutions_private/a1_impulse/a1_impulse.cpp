// Reference solution of assignment 1. Equation numbers (A1.n): handouts/a1_impulse.md.
#include "assignments/a1_impulse/a1_impulse.h"

#include <array>
#include <cmath>

namespace tumble::a1 {
namespace {

/// Signed area (twice) of the triangle (0, p, q); positive when q is counter-clockwise of p.
double cross(const Vector2d& p, const Vector2d& q) { return p.x() * q.y() - p.y() * q.x(); }

/// R I_body^-1 R^T v without forming the tensor in the world frame.
Vector3d inverse_inertia_world_times(const Body& body, const Vector3d& v_world) {
  const Vector3d v_body = body.world_from_body.conjugate() * v_world;
  return body.world_from_body * (body.inertia.inverse_inertia_body * v_body);
}

Vector3d velocity_of_point(const Body& body, const Vector3d& point_world) {
  return body.velocity_world + body.omega_world.cross(point_world - body.com_world);
}

/// What one body adds to the denominator of (A1.9): 1/m + n . ((I^-1 (r x n)) x r), the last being
/// (r x n) . I^-1 (r x n).
double inverse_mass_along(const Body& body, const Contact& contact) {
  const Vector3d r_cross_n =
      (contact.point_world - body.com_world).cross(contact.normal_b_to_a_world);
  return body.inertia.inverse_mass + r_cross_n.dot(inverse_inertia_world_times(body, r_cross_n));
}

/// j = -(1 + e) u_n / k; nothing to do for bodies that do not approach, and nothing that can be
/// done to two walls.
double impulse(double normal_velocity, double inverse_mass, double restitution) {
  if (normal_velocity >= 0.0 || inverse_mass == 0.0) return 0.0;
  return -(1.0 + restitution) * normal_velocity / inverse_mass;
}

}  // namespace

// (A1.1), solved by looking along the ray: the corners, seen from o, are projected along d onto a
// plane, where the ray is the origin and each weight is the area of the triangle that the origin
// makes with the opposite edge (Woop). Why nothing slips through a seam: two triangles that share a
// corner compute the same projected point for it, and the sign of p.x q.y - p.y q.x is never wrong
// in floating point, at worst 0, because rounding two products keeps their order. So both see the
// same closed figures in the plane, and 0 counts as inside.
std::optional<RayHit> intersect_ray_triangle(const Ray& ray, const Triangle& triangle) {
  const Vector3d& d = ray.direction_world;

  // Project along the largest component of d. Multiplying through by it, where Woop divides, rounds
  // nothing in easy cases.
  int z = 0;
  d.cwiseAbs().maxCoeff(&z);
  const int x = (z + 1) % 3, y = (z + 2) % 3;
  const std::array<Vector3d, 3> corner{triangle.a_world - ray.origin_world,
                                       triangle.b_world - ray.origin_world,
                                       triangle.c_world - ray.origin_world};
  std::array<Vector2d, 3> seen;
  for (int i = 0; i < 3; ++i) {
    seen[i] = {corner[i][x] * d[z] - corner[i][z] * d[x],
               corner[i][y] * d[z] - corner[i][z] * d[y]};
  }

  const Vector3d area(cross(seen[1], seen[2]), cross(seen[2], seen[0]), cross(seen[0], seen[1]));
  const bool inside = (area.array() >= 0.0).all() || (area.array() <= 0.0).all();  // front or back
  const double total = area.sum();
  if (!inside || total == 0.0) return std::nullopt;  // total 0: the triangle is seen edge-on

  RayHit hit;
  hit.barycentric = area / total;
  hit.t = hit.barycentric.dot(Vector3d(corner[0][z], corner[1][z], corner[2][z])) / d[z];
  if (!(hit.t >= 0.0)) return std::nullopt;
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
  // The one formula that needs I itself, which a body of infinite mass does not have.
  if (body.inertia.inverse_mass == 0.0) return Vector3d::Zero();

  // (A1.4) in the body frame:  I w' = tau - w x (I w)
  const Quaterniond body_from_world = body.world_from_body.conjugate();
  const Vector3d w = body_from_world * body.omega_world;
  const Vector3d tau = body_from_world * torque_world;
  const Matrix3d& I = body.inertia.inertia_body;
  return body.world_from_body * (body.inertia.inverse_inertia_body * (tau - w.cross(I * w)));
}

double relative_normal_velocity(const Contact& contact, const Body& a, const Body& b) {
  const Vector3d u_world =
      velocity_of_point(a, contact.point_world) - velocity_of_point(b, contact.point_world);
  return contact.normal_b_to_a_world.dot(u_world);
}

RelativeMotion classify_relative_motion(double normal_velocity, double tolerance) {
  if (normal_velocity < -tolerance) return RelativeMotion::kApproaching;
  if (normal_velocity > tolerance) return RelativeMotion::kSeparating;
  return RelativeMotion::kResting;
}

Vector2d contact_normal_vertex_edge(const Vector2d& vertex_a_world,
                                    const Vector2d& edge_start_b_world,
                                    const Vector2d& edge_end_b_world) {
  const Vector2d edge = edge_end_b_world - edge_start_b_world;
  const Vector2d right_of_edge = Vector2d(edge.y(), -edge.x()).normalized();
  return right_of_edge.dot(vertex_a_world - edge_start_b_world) >= 0.0 ? right_of_edge
                                                                       : Vector2d(-right_of_edge);
}

Vector2d contact_normal_edge_edge(const Vector2d& edge_start_b_world,
                                  const Vector2d& edge_end_b_world, const Vector2d& com_a_world) {
  // The same perpendicular; A's centre says the side better than A's edge, which lies on the line.
  return contact_normal_vertex_edge(com_a_world, edge_start_b_world, edge_end_b_world);
}

Vector2d contact_normal_vertex_vertex(const Vector2d& com_a_world, const Vector2d& com_b_world) {
  return (com_a_world - com_b_world).normalized();
}

double collision_impulse_without_rotation(const Contact& contact, const Body& a, const Body& b,
                                          double restitution) {
  const double normal_velocity =
      contact.normal_b_to_a_world.dot(a.velocity_world - b.velocity_world);
  return impulse(normal_velocity, a.inertia.inverse_mass + b.inertia.inverse_mass, restitution);
}

double collision_impulse(const Contact& contact, const Body& a, const Body& b, double restitution) {
  return impulse(relative_normal_velocity(contact, a, b),
                 inverse_mass_along(a, contact) + inverse_mass_along(b, contact), restitution);
}

Velocity apply_impulse(const Body& body, const Vector3d& impulse_world,
                       const Vector3d& point_world) {
  const Vector3d r_world = point_world - body.com_world;
  return {body.velocity_world + impulse_world * body.inertia.inverse_mass,
          body.omega_world + inverse_inertia_world_times(body, r_world.cross(impulse_world))};
}

CollisionOutcome resolve_collision(const Contact& contact, const Body& a, const Body& b,
                                   double restitution) {
  const Vector3d impulse_world =
      collision_impulse(contact, a, b, restitution) * contact.normal_b_to_a_world;
  return {apply_impulse(a, impulse_world, contact.point_world),
          apply_impulse(b, -impulse_world, contact.point_world)};
}

}  // namespace tumble::a1
