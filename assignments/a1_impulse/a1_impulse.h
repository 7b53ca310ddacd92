#pragma once

#include <optional>

#include "framework/core/not_implemented.h"
#include "framework/dynamics/body.h"
#include "framework/modules/module.h"

namespace tumble::a1 {

std::optional<RayHit> intersect_ray_triangle(const Ray& ray, const Triangle& triangle);
Wrench wrench_of_point_force(const Vector3d& force_world, const Vector3d& point_world, const Vector3d& com_world);
Vector3d linear_acceleration(const Body& body, const Vector3d& force_world);
Vector3d angular_acceleration(const Body& body, const Vector3d& torque_world);
double relative_normal_velocity(const Contact& contact, const Body& a, const Body& b);

enum class RelativeMotion { kApproaching, kResting, kSeparating };
RelativeMotion classify_relative_motion(double normal_velocity, double tolerance);

Vector2d contact_normal_vertex_edge(const Vector2d& vertex_a, const Vector2d& edge_start_b, const Vector2d& edge_end_b);
Vector2d contact_normal_edge_edge(const Vector2d& edge_start_b, const Vector2d& edge_end_b, const Vector2d& com_a);
Vector2d contact_normal_vertex_vertex(const Vector2d& com_a, const Vector2d& com_b);

double collision_impulse_without_rotation(const Contact& contact, const Body& a, const Body& b, double restitution);
double collision_impulse(const Contact& contact, const Body& a, const Body& b, double restitution);
Velocity apply_impulse(const Body& body, const Vector3d& impulse_world, const Vector3d& point_world);

}  // namespace tumble::a1

TUMBLE_MODULE(a1, intersect_ray_triangle, wrench_of_point_force, linear_acceleration, angular_acceleration,
              relative_normal_velocity, classify_relative_motion, contact_normal_vertex_edge, contact_normal_edge_edge,
              contact_normal_vertex_vertex, collision_impulse_without_rotation, collision_impulse, apply_impulse);
