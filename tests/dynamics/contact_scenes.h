/// Contact problems whose answers are known on paper, and a referee who knows only the law. World
/// frame, SI units, z up.
#pragma once

#include <algorithm>
#include <cmath>
#include <ostream>
#include <vector>

#include "framework/dynamics/contact_problem.h"
#include "framework/dynamics/solve_contacts.h"
#include "tests/dynamics/tops.h"

namespace tumble::testing {

inline constexpr double kGravity = 9.81;   // m/s^2
inline constexpr double kStep = 1.0 / 60;  // s

inline PushedBody fixed_body() {
  PushedBody body;
  body.com_world = body.velocity_world = body.omega_world = Vector3d::Zero();
  return body;
}

inline PushedBody body_at(double mass, const Matrix3d& inertia_world, const Vector3d& com_world) {
  PushedBody body = fixed_body();
  body.inverse_mass = 1 / mass;
  body.inverse_inertia_world = inertia_world.inverse();
  body.com_world = com_world;
  return body;
}

/// A box of full extents `size`, turned.
inline PushedBody box_body(double mass, const Vector3d& size, const Vector3d& com_world,
                           const Matrix3d& world_from_body = Matrix3d::Identity()) {
  const Vector3d s = size.cwiseAbs2(),
                 moments = mass / 12 * Vector3d(s.y() + s.z(), s.x() + s.z(), s.x() + s.y());
  return body_at(mass, world_from_body * moments.asDiagonal() * world_from_body.transpose(),
                 com_world);
}

inline PushedBody ball_body(double mass, double radius, const Vector3d& com_world) {
  return body_at(mass, 0.4 * mass * radius * radius * Matrix3d::Identity(), com_world);
}

inline PushingContact contact_at(int body_a, int body_b, const Vector3d& point_world,
                                 const Vector3d& normal_b_to_a_world, double friction) {
  PushingContact contact;
  contact.body_a = body_a;
  contact.body_b = body_b;
  contact.point_world = point_world;
  contact.normal_b_to_a_world = normal_b_to_a_world;
  contact.friction = friction;
  return contact;
}

/// Four contacts at the corners of a rectangle.
inline void add_patch(ContactProblem& problem, int a, int b, const Vector3d& middle,
                      const Vector3d& half_u, const Vector3d& half_v, const Vector3d& normal,
                      double friction) {
  for (const double su : {-1.0, 1.0})
    for (const double sv : {-1.0, 1.0})
      problem.contacts.push_back(
          contact_at(a, b, middle + su * half_u + sv * half_v, normal, friction));
}

inline void let_fall(ContactProblem& problem, const Vector3d& gravity = Vector3d(0, 0, -kGravity),
                     double step = kStep) {
  for (PushedBody& body : problem.bodies)
    if (body.inverse_mass > 0) body.velocity_world += step * gravity;
}

/// Unit boxes on the floor (body 0), one on another; masses from the bottom up.
inline ContactProblem stack_of_boxes(const std::vector<double>& masses, double friction = 0.5) {
  ContactProblem problem;
  problem.bodies.push_back(fixed_body());
  for (std::size_t i = 0; i < masses.size(); ++i) {
    const double bottom = static_cast<double>(i);
    problem.bodies.push_back(box_body(masses[i], Vector3d::Ones(), Vector3d(0, 0, bottom + 0.5)));
    add_patch(problem, static_cast<int>(i) + 1, static_cast<int>(i), Vector3d(0, 0, bottom),
              0.5 * Vector3d::UnitX(), 0.5 * Vector3d::UnitY(), Vector3d::UnitZ(), friction);
  }
  let_fall(problem);
  return problem;
}

/// A box of 0.4 x 0.3 x 0.2 m on a plane inclined by `angle` about y: the slope falls towards +x.
/// The box is body 1.
inline ContactProblem box_on_slope(double mass, double angle, double friction) {
  const Matrix3d turn = Eigen::AngleAxisd(angle, Vector3d::UnitY()).toRotationMatrix();
  ContactProblem problem;
  problem.bodies = {fixed_body(),
                    box_body(mass, {0.4, 0.3, 0.2}, turn * Vector3d(0, 0, 0.1), turn)};
  add_patch(problem, 1, 0, Vector3d::Zero(), turn * Vector3d(0.2, 0, 0),
            turn * Vector3d(0, 0.15, 0), turn.col(2), friction);
  let_fall(problem);
  return problem;
}

inline Vector3d sum_of_impulses(const ContactSolution& solution, std::size_t first,
                                std::size_t count) {
  Vector3d sum = Vector3d::Zero();
  for (std::size_t i = first; i < first + count; ++i) sum += solution.impulses_world[i];
  return sum;
}

/// What the referee finds: velocities from momentum balance, then the law, each violation in its
/// own unit.
struct Verdict {
  double momentum = 0;         // m/s: velocities told against velocities from the impulses
  double penetration = 0;      // m/s: v_n below target
  double pull = 0;             // m/s: negative p_n, times inverse mass
  double complementarity = 0;  // m/s: min(p_n / m, v_n - target)
  double cone = 0;             // m/s: |p_t| - mu p_n, times inverse mass
  // m/s: sideways speed where the impulse is inside the cone: min(|v_t|, (mu p_n - |p_t|) / m)
  double stick = 0;
  // m/s: friction that does not oppose the sliding: |p_t x v_t| / |p_t|, and v_t . p_t > 0
  double direction = 0;
  double row = 0;  // m/s: J u - target
  double worst() const {
    return std::max({momentum, penetration, pull, complementarity, cone, stick, direction, row});
  }
};

inline std::ostream& operator<<(std::ostream& out, const Verdict& v) {
  return out << "momentum " << v.momentum << " penetration " << v.penetration << " pull " << v.pull
             << " complementarity " << v.complementarity << " cone " << v.cone << " stick "
             << v.stick << " direction " << v.direction << " row " << v.row;
}

Verdict judge(const ContactProblem& problem, const ContactSolution& solution);

}  // namespace tumble::testing
