// A right solution: the ray by Moeller and Trumbore's cross products, each edge judged by a number
// of its own (their 1 - u - v, taken from the edge bc itself); everything else by components in
// plain loops, the way a first program is written.
#include "assignments/a1_impulse/a1_impulse.h"

#include <array>
#include <cmath>

namespace tumble::a1 {
namespace {

using Matrix = std::array<std::array<double, 3>, 3>;

Vector3d cross(const Vector3d& p, const Vector3d& q) {
  return {p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]};
}

double dot(const Vector3d& p, const Vector3d& q) {
  double sum = 0;
  for (int i = 2; i >= 0; --i) sum += p[i] * q[i];
  return sum;
}

Matrix matrix_of(const Quaterniond& q) {
  const double w = q.w(), x = q.x(), y = q.y(), z = q.z();
  return {{{w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)},
           {2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)},
           {2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z}}};
}

Vector3d to_body(const Matrix& R, const Vector3d& v) {
  Vector3d out = Vector3d::Zero();
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) out[i] += R[k][i] * v[k];
  return out;
}

Vector3d to_world(const Matrix& R, const Vector3d& v) {
  Vector3d out = Vector3d::Zero();
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) out[i] += R[i][k] * v[k];
  return out;
}

Vector3d times(const Matrix3d& m, const Vector3d& v) {
  Vector3d out = Vector3d::Zero();
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) out[i] += m(i, k) * v[k];
  return out;
}

/// I^-1 in the world, applied.
Vector3d turned_by(const Body& body, const Vector3d& angular_impulse_world) {
  const Matrix R = matrix_of(body.world_from_body);
  return to_world(R, times(body.inertia.inverse_inertia_body, to_body(R, angular_impulse_world)));
}

Vector3d velocity_of_point(const Body& body, const Vector3d& p) {
  return body.velocity_world + cross(body.omega_world, p - body.com_world);
}

/// n . ((I^-1 (r x n)) x r), as the equation is printed.
double turning_term(const Body& body, const Contact& contact) {
  const Vector3d r = contact.point_world - body.com_world;
  return dot(contact.normal_b_to_a_world,
             cross(turned_by(body, cross(r, contact.normal_b_to_a_world)), r));
}

/// d . ((p + q) x (q - p)): twice d . (p x q); swapped ends give exactly the opposite number.
double edge(const Vector3d& d, const Vector3d& p, const Vector3d& q) {
  return dot(d, cross(p + q, q - p));
}

}  // namespace

std::optional<RayHit> intersect_ray_triangle(const Ray& ray, const Triangle& triangle) {
  const Vector3d &o = ray.origin_world, &d = ray.direction_world;
  const Vector3d a = triangle.a_world - o, b = triangle.b_world - o, c = triangle.c_world - o;

  // Inside: the signs of the three edges agree.
  const double of_a = edge(d, b, c), of_b = edge(d, c, a), of_c = edge(d, a, b);
  int positive = 0, negative = 0;
  for (const double side : {of_a, of_b, of_c}) {
    if (side > 0) ++positive;
    if (side < 0) ++negative;
  }
  if (positive > 0 && negative > 0) return std::nullopt;

  // Moeller and Trumbore for t, where their determinant is not 0.
  const Vector3d e1 = triangle.b_world - triangle.a_world, e2 = triangle.c_world - triangle.a_world;
  const Vector3d normal = cross(e1, e2);
  const double det = -dot(d, normal), sum = of_a + of_b + of_c;
  if (det == 0 || sum == 0) return std::nullopt;
  const double t = -dot(normal, a) / det;
  if (t < 0) return std::nullopt;
  return RayHit{t, Vector3d(of_a / sum, of_b / sum, of_c / sum)};
}

Wrench wrench_of_point_force(const Vector3d& force_world, const Vector3d& point_world,
                             const Vector3d& com_world) {
  return {force_world, -cross(force_world, point_world - com_world)};
}

Vector3d linear_acceleration(const Body& body, const Vector3d& force_world) {
  if (body.inertia.inverse_mass == 0) return {0, 0, 0};
  return force_world / body.inertia.mass;
}

Vector3d angular_acceleration(const Body& body, const Vector3d& torque_world) {
  if (body.inertia.inverse_mass == 0) return {0, 0, 0};
  const Matrix R = matrix_of(body.world_from_body);
  const Vector3d w = to_body(R, body.omega_world), L = times(body.inertia.inertia_body, w);
  const Vector3d left = to_body(R, torque_world) + cross(L, w);
  return to_world(R, times(body.inertia.inverse_inertia_body, left));
}

double relative_normal_velocity(const Contact& contact, const Body& a, const Body& b) {
  return dot(velocity_of_point(a, contact.point_world), contact.normal_b_to_a_world) -
         dot(velocity_of_point(b, contact.point_world), contact.normal_b_to_a_world);
}

RelativeMotion classify_relative_motion(double normal_velocity, double tolerance) {
  if (normal_velocity > tolerance) return RelativeMotion::kSeparating;
  if (normal_velocity < -tolerance) return RelativeMotion::kApproaching;
  return RelativeMotion::kResting;
}

Vector2d contact_normal_vertex_edge(const Vector2d& vertex_a_world,
                                    const Vector2d& edge_start_b_world,
                                    const Vector2d& edge_end_b_world) {
  // The direction of the edge first, then what is left of the way to the corner: both ways to the
  // side, rounded otherwise.
  const Vector2d along = (edge_end_b_world - edge_start_b_world).normalized(),
                 right(along.y(), -along.x());
  const Vector2d way = vertex_a_world - edge_start_b_world;
  return right.x() * way.x() + right.y() * way.y() < 0 ? Vector2d(-right.x(), -right.y()) : right;
}

Vector2d contact_normal_edge_edge(const Vector2d& edge_start_b_world,
                                  const Vector2d& edge_end_b_world, const Vector2d& com_a_world) {
  return contact_normal_vertex_edge(com_a_world, edge_start_b_world, edge_end_b_world);
}

Vector2d contact_normal_vertex_vertex(const Vector2d& com_a_world, const Vector2d& com_b_world) {
  const double x = com_a_world.x() - com_b_world.x(), y = com_a_world.y() - com_b_world.y(),
               length = std::hypot(x, y);
  return {x / length, y / length};
}

double collision_impulse_without_rotation(const Contact& contact, const Body& a, const Body& b,
                                          double restitution) {
  const double u = dot(contact.normal_b_to_a_world, a.velocity_world) -
                   dot(contact.normal_b_to_a_world, b.velocity_world);
  if (u >= 0) return 0;
  if (a.inertia.inverse_mass == 0 && b.inertia.inverse_mass == 0) return 0;
  return -(1 + restitution) * u / (a.inertia.inverse_mass + b.inertia.inverse_mass);
}

double collision_impulse(const Contact& contact, const Body& a, const Body& b, double restitution) {
  const double u = relative_normal_velocity(contact, a, b);
  if (u >= 0) return 0;
  if (a.inertia.inverse_mass == 0 && b.inertia.inverse_mass == 0) return 0;
  const double k = a.inertia.inverse_mass + b.inertia.inverse_mass + turning_term(a, contact) +
                   turning_term(b, contact);
  return -(u + restitution * u) / k;
}

Velocity apply_impulse(const Body& body, const Vector3d& impulse_world,
                       const Vector3d& point_world) {
  if (body.inertia.inverse_mass == 0) return {body.velocity_world, body.omega_world};
  return {body.velocity_world + impulse_world / body.inertia.mass,
          body.omega_world + turned_by(body, cross(point_world - body.com_world, impulse_world))};
}

CollisionOutcome resolve_collision(const Contact& contact, const Body& a, const Body& b,
                                   double restitution) {
  const double j = collision_impulse(contact, a, b, restitution);
  return {apply_impulse(a, contact.normal_b_to_a_world * j, contact.point_world),
          apply_impulse(b, contact.normal_b_to_a_world * (-j), contact.point_world)};
}

}  // namespace tumble::a1
