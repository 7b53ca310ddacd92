// A right solution: the ray by Woop's own order of evaluation (shear first, then edge functions),
// bodies as 6 x 6 blocks, the impulse from the mobility matrix of the touching point, Newton-Euler
// in the axes of the world.
#include "assignments/a1_impulse/a1_impulse.h"

#include <cmath>
#include <utility>

namespace tumble::a1 {
namespace {

/// [r] with [r] v = r x v.
Matrix3d cross_matrix(const Vector3d& r) {
  Matrix3d m;
  m << 0, -r.z(), r.y(), r.z(), 0, -r.x(), -r.y(), r.x(), 0;
  return m;
}

using Row36 = Eigen::Matrix<double, 3, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// Velocity of a point from (v, w): (1, -[r]).
Row36 jacobian(const Body& body, const Vector3d& point_world) {
  Row36 J;
  J << Matrix3d::Identity(), -cross_matrix(point_world - body.com_world);
  return J;
}

/// M^-1 of one body, world axes.
Matrix6 inverse_mass_matrix(const Body& body) {
  const Matrix3d R = body.world_from_body.toRotationMatrix();
  Matrix6 W = Matrix6::Zero();
  W.topLeftCorner<3, 3>().diagonal().setConstant(body.inertia.inverse_mass);
  W.bottomRightCorner<3, 3>() = (R * body.inertia.inverse_inertia_body) * R.transpose();
  return W;
}

Vector6 motion(const Body& body) {
  Vector6 u;
  u << body.velocity_world, body.omega_world;
  return u;
}

Matrix3d mobility(const Body& body, const Vector3d& point_world) {
  const Row36 J = jacobian(body, point_world);
  return J * inverse_mass_matrix(body) * J.transpose();
}

Vector2d perpendicular(const Vector2d& start, const Vector2d& end, const Vector2d& towards) {
  const Vector2d e = end - start, p = towards - start;
  const double left_of = e.x() * p.y() - e.y() * p.x();
  const double length = std::hypot(e.x(), e.y());
  return left_of > 0 ? Vector2d(-e.y() / length, e.x() / length)
                     : Vector2d(e.y() / length, -e.x() / length);
}

}  // namespace

std::optional<RayHit> intersect_ray_triangle(const Ray& ray, const Triangle& triangle) {
  const Vector3d& d = ray.direction_world;
  int kz = 0;
  d.cwiseAbs().maxCoeff(&kz);
  int kx = (kz + 1) % 3, ky = (kx + 1) % 3;
  if (d[kz] < 0) std::swap(kx, ky);
  const double Sx = d[kx] / d[kz], Sy = d[ky] / d[kz], Sz = 1.0 / d[kz];

  const Vector3d A = triangle.a_world - ray.origin_world, B = triangle.b_world - ray.origin_world,
                 C = triangle.c_world - ray.origin_world;
  const double Ax = A[kx] - Sx * A[kz], Ay = A[ky] - Sy * A[kz];
  const double Bx = B[kx] - Sx * B[kz], By = B[ky] - Sy * B[kz];
  const double Cx = C[kx] - Sx * C[kz], Cy = C[ky] - Sy * C[kz];

  const double U = Cx * By - Cy * Bx, V = Ax * Cy - Ay * Cx, W = Bx * Ay - By * Ax;
  if ((U < 0 || V < 0 || W < 0) && (U > 0 || V > 0 || W > 0)) return std::nullopt;
  const double det = U + V + W;
  if (det == 0) return std::nullopt;
  const double T = U * Sz * A[kz] + V * Sz * B[kz] + W * Sz * C[kz];
  if (det < 0 ? T > 0 : T < 0) return std::nullopt;
  const double rcp = 1.0 / det;
  return RayHit{T * rcp, Vector3d(U * rcp, V * rcp, W * rcp)};
}

Wrench wrench_of_point_force(const Vector3d& force_world, const Vector3d& point_world,
                             const Vector3d& com_world) {
  return {force_world, cross_matrix(point_world - com_world) * force_world};
}

Vector3d linear_acceleration(const Body& body, const Vector3d& force_world) {
  return (inverse_mass_matrix(body) * (Vector6() << force_world, Vector3d::Zero()).finished())
      .head<3>();
}

Vector3d angular_acceleration(const Body& body, const Vector3d& torque_world) {
  if (std::isinf(body.inertia.mass)) return Vector3d::Zero();
  const Matrix3d R = body.world_from_body.toRotationMatrix();
  const Matrix3d inertia_world = R * body.inertia.inertia_body * R.transpose();
  const Vector3d angular_momentum = inertia_world * body.omega_world;
  return inverse_mass_matrix(body).bottomRightCorner<3, 3>() *
         (torque_world - cross_matrix(body.omega_world) * angular_momentum);
}

double relative_normal_velocity(const Contact& contact, const Body& a, const Body& b) {
  const Vector3d& n = contact.normal_b_to_a_world;
  return (n.transpose() * jacobian(a, contact.point_world)).dot(motion(a)) -
         (n.transpose() * jacobian(b, contact.point_world)).dot(motion(b));
}

RelativeMotion classify_relative_motion(double normal_velocity, double tolerance) {
  return normal_velocity > tolerance     ? RelativeMotion::kSeparating
         : normal_velocity >= -tolerance ? RelativeMotion::kResting
                                         : RelativeMotion::kApproaching;
}

Vector2d contact_normal_vertex_edge(const Vector2d& vertex_a_world,
                                    const Vector2d& edge_start_b_world,
                                    const Vector2d& edge_end_b_world) {
  return perpendicular(edge_start_b_world, edge_end_b_world, vertex_a_world);
}

Vector2d contact_normal_edge_edge(const Vector2d& edge_start_b_world,
                                  const Vector2d& edge_end_b_world, const Vector2d& com_a_world) {
  return perpendicular(edge_start_b_world, edge_end_b_world, com_a_world);
}

Vector2d contact_normal_vertex_vertex(const Vector2d& com_a_world, const Vector2d& com_b_world) {
  const Vector2d d = com_a_world - com_b_world;
  return d / std::hypot(d.x(), d.y());
}

double collision_impulse_without_rotation(const Contact& contact, const Body& a, const Body& b,
                                          double restitution) {
  const Vector3d& n = contact.normal_b_to_a_world;
  const double u = n.dot(a.velocity_world) - n.dot(b.velocity_world),
               k = a.inertia.inverse_mass + b.inertia.inverse_mass;
  return u < 0 && k > 0 ? -u * (1 + restitution) / k : 0.0;
}

double collision_impulse(const Contact& contact, const Body& a, const Body& b, double restitution) {
  const Vector3d& n = contact.normal_b_to_a_world;
  const Matrix3d K = mobility(a, contact.point_world) + mobility(b, contact.point_world);
  const double u = relative_normal_velocity(contact, a, b), k = n.transpose() * K * n;
  return u < 0 && k > 0 ? -u * (1 + restitution) / k : 0.0;
}

Velocity apply_impulse(const Body& body, const Vector3d& impulse_world,
                       const Vector3d& point_world) {
  const Vector6 after =
      motion(body) +
      inverse_mass_matrix(body) * (jacobian(body, point_world).transpose() * impulse_world);
  return {after.head<3>(), after.tail<3>()};
}

CollisionOutcome resolve_collision(const Contact& contact, const Body& a, const Body& b,
                                   double restitution) {
  const double j = collision_impulse(contact, a, b, restitution);
  if (j == 0) return {{a.velocity_world, a.omega_world}, {b.velocity_world, b.omega_world}};
  return {apply_impulse(a, j * contact.normal_b_to_a_world, contact.point_world),
          apply_impulse(b, -j * contact.normal_b_to_a_world, contact.point_world)};
}

}  // namespace tumble::a1
