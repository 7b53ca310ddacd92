// A right solution that works in the body's frame where it can: vectors are carried into it, and
// the tensor never leaves. The ray is judged in a frame of its own, made of two perpendiculars to
// its direction. Mobility is built from one function of contact and body that also serves the
// application of the impulse.
#include "assignments/a1_impulse/a1_impulse.h"

namespace tumble::a1 {
namespace {

struct SeenCorner {
  double right, up, along;
};

// 2-D area with exact sign or 0: rounding keeps the order of two products.
double area(const SeenCorner& p, const SeenCorner& q) { return p.right * q.up - p.up * q.right; }

// Change of angular velocity by an angular impulse.
Vector3d spin_up(const Body& body, const Vector3d& angular_impulse_world) {
  const Quaterniond body_from_world = body.world_from_body.inverse();
  const Vector3d angular_impulse_body = body_from_world * angular_impulse_world;
  return body.world_from_body * Vector3d(body.inertia.inverse_inertia_body * angular_impulse_body);
}

// Velocity that a unit impulse along n gives to the touching point, along n.
double response(const Body& body, const Contact& contact) {
  const Vector3d arm = contact.point_world - body.com_world;
  Body at_rest = body;
  at_rest.velocity_world.setZero();
  at_rest.omega_world.setZero();
  const Velocity kicked = apply_impulse(at_rest, contact.normal_b_to_a_world, contact.point_world);
  return contact.normal_b_to_a_world.dot(kicked.linear_world + kicked.angular_world.cross(arm));
}

double bounce(double approach, double inverse_mass, double restitution) {
  return approach < 0.0 && inverse_mass > 0.0 ? (1.0 + restitution) * -approach / inverse_mass
                                              : 0.0;
}

Vector2d perpendicular_towards(const Vector2d& start, const Vector2d& end, const Vector2d& target) {
  // Which side: the sign of the area (start, end, target); 0 counts as right.
  const Vector2d e = end - start, g = target - start;
  const double left = e.x() * g.y() - e.y() * g.x();
  const Vector2d n = left > 0.0 ? Vector2d(-e.y(), e.x()) : Vector2d(e.y(), -e.x());
  return n.normalized();
}

}  // namespace

std::optional<RayHit> intersect_ray_triangle(const Ray& ray, const Triangle& triangle) {
  const Vector3d& d = ray.direction_world;
  int least = 0;
  d.cwiseAbs().minCoeff(&least);
  const Vector3d right = d.cross(Vector3d::Unit(least));
  const Vector3d up = d.cross(right);

  const auto seen = [&](const Vector3d& corner_world) -> SeenCorner {
    const Vector3d p = corner_world - ray.origin_world;
    return {p.dot(right), p.dot(up), p.dot(d)};
  };
  const SeenCorner a = seen(triangle.a_world), b = seen(triangle.b_world),
                   c = seen(triangle.c_world);
  double w_a = area(b, c), w_b = area(c, a), w_c = area(a, b);
  if (w_a + w_b + w_c < 0.0) w_a = -w_a, w_b = -w_b, w_c = -w_c;
  if (w_a < 0.0 || w_b < 0.0 || w_c < 0.0) return std::nullopt;
  const double all = w_a + w_b + w_c;
  if (all <= 0.0) return std::nullopt;

  RayHit hit;
  hit.barycentric = Vector3d(w_a, w_b, w_c) / all;
  hit.t = hit.barycentric.dot(Vector3d(a.along, b.along, c.along)) / d.squaredNorm();
  return hit.t < 0.0 ? std::nullopt : std::optional<RayHit>(hit);
}

Wrench wrench_of_point_force(const Vector3d& force_world, const Vector3d& point_world,
                             const Vector3d& com_world) {
  return {force_world, force_world.cross(com_world - point_world)};
}

Vector3d linear_acceleration(const Body& body, const Vector3d& force_world) {
  return force_world * body.inertia.inverse_mass;
}

Vector3d angular_acceleration(const Body& body, const Vector3d& torque_world) {
  const bool immovable = body.inertia.inverse_inertia_body.isZero(0.0);
  if (immovable) return Vector3d::Zero();
  // In the world frame: I w' = tau - w x L with L = I w.
  const Quaterniond body_from_world = body.world_from_body.inverse();
  const Vector3d omega_body = body_from_world * body.omega_world;
  const Vector3d angular_momentum_world =
      body.world_from_body * Vector3d(body.inertia.inertia_body * omega_body);
  return spin_up(body, torque_world - body.omega_world.cross(angular_momentum_world));
}

double relative_normal_velocity(const Contact& contact, const Body& a, const Body& b) {
  const Vector3d& n = contact.normal_b_to_a_world;
  const Vector3d arm_a = contact.point_world - a.com_world,
                 arm_b = contact.point_world - b.com_world;
  // n . (w x r) = w . (r x n)
  return n.dot(a.velocity_world - b.velocity_world) + a.omega_world.dot(arm_a.cross(n)) -
         b.omega_world.dot(arm_b.cross(n));
}

RelativeMotion classify_relative_motion(double normal_velocity, double tolerance) {
  const bool separating = normal_velocity > tolerance, approaching = -normal_velocity > tolerance;
  return approaching  ? RelativeMotion::kApproaching
         : separating ? RelativeMotion::kSeparating
                      : RelativeMotion::kResting;
}

Vector2d contact_normal_vertex_edge(const Vector2d& vertex_a_world,
                                    const Vector2d& edge_start_b_world,
                                    const Vector2d& edge_end_b_world) {
  return perpendicular_towards(edge_start_b_world, edge_end_b_world, vertex_a_world);
}

Vector2d contact_normal_edge_edge(const Vector2d& edge_start_b_world,
                                  const Vector2d& edge_end_b_world, const Vector2d& com_a_world) {
  return perpendicular_towards(edge_start_b_world, edge_end_b_world, com_a_world);
}

Vector2d contact_normal_vertex_vertex(const Vector2d& com_a_world, const Vector2d& com_b_world) {
  return (com_a_world - com_b_world).normalized();
}

double collision_impulse_without_rotation(const Contact& contact, const Body& a, const Body& b,
                                          double restitution) {
  return bounce(contact.normal_b_to_a_world.dot(a.velocity_world - b.velocity_world),
                a.inertia.inverse_mass + b.inertia.inverse_mass, restitution);
}

double collision_impulse(const Contact& contact, const Body& a, const Body& b, double restitution) {
  return bounce(relative_normal_velocity(contact, a, b),
                response(a, contact) + response(b, contact), restitution);
}

Velocity apply_impulse(const Body& body, const Vector3d& impulse_world,
                       const Vector3d& point_world) {
  const Vector3d angular_impulse_world = (point_world - body.com_world).cross(impulse_world);
  return {body.velocity_world + body.inertia.inverse_mass * impulse_world,
          body.omega_world + spin_up(body, angular_impulse_world)};
}

CollisionOutcome resolve_collision(const Contact& contact, const Body& a, const Body& b,
                                   double restitution) {
  const double j = collision_impulse(contact, a, b, restitution);
  return {apply_impulse(a, j * contact.normal_b_to_a_world, contact.point_world),
          apply_impulse(b, -j * contact.normal_b_to_a_world, contact.point_world)};
}

}  // namespace tumble::a1
