#include "tests/dynamics/contact_scenes.h"

namespace tumble::testing {
namespace {

std::vector<Velocity> velocities_after(const ContactProblem& problem,
                                       const ContactSolution& solution) {
  std::vector<Vector3d> push(problem.bodies.size(), Vector3d::Zero()), twist = push;
  const auto add = [&](int body, const Vector3d& impulse, const Vector3d& angular) {
    push[body] += impulse;
    twist[body] += angular;
  };
  for (std::size_t i = 0; i < problem.contacts.size(); ++i) {
    const PushingContact& c = problem.contacts[i];
    const Vector3d& p = solution.impulses_world[i];
    add(c.body_a, p, (c.point_world - problem.bodies[c.body_a].com_world).cross(p));
    add(c.body_b, -p, -(c.point_world - problem.bodies[c.body_b].com_world).cross(p));
  }
  for (std::size_t i = 0; i < problem.rows.size(); ++i) {
    const Constraint& c = problem.rows[i];
    const double lambda = solution.row_impulses[static_cast<Eigen::Index>(i)];
    add(c.body_a, lambda * c.row.jacobian_a.head<3>(), lambda * c.row.jacobian_a.tail<3>());
    add(c.body_b, lambda * c.row.jacobian_b.head<3>(), lambda * c.row.jacobian_b.tail<3>());
  }
  std::vector<Velocity> after;
  for (std::size_t i = 0; i < problem.bodies.size(); ++i) {
    const PushedBody& b = problem.bodies[i];
    after.push_back({b.velocity_world + b.inverse_mass * push[i],
                     b.omega_world + b.inverse_inertia_world * twist[i]});
  }
  return after;
}

void judge_contact(const PushingContact& c, const Vector3d& impulse, const Vector3d& velocity,
                   double inverse_mass, Verdict& verdict) {
  const Vector3d& n = c.normal_b_to_a_world;
  const double p_n = n.dot(impulse), v_n = n.dot(velocity) - c.target;
  const Vector3d p_t = impulse - p_n * n, v_t = velocity - n.dot(velocity) * n;
  const auto keep = [](double& worst, double value) { worst = std::max(worst, value); };
  keep(verdict.penetration, -v_n);
  keep(verdict.pull, -p_n * inverse_mass);
  keep(verdict.complementarity, std::min(p_n * inverse_mass, v_n));
  keep(verdict.cone, (p_t.norm() - c.friction * p_n) * inverse_mass);
  keep(verdict.stick, std::min(v_t.norm(), (c.friction * p_n - p_t.norm()) * inverse_mass));
  if (!(p_t.norm() > 0)) return;
  const double against = p_t.dot(v_t) / p_t.norm();
  keep(verdict.direction, std::min(against, p_t.norm() * inverse_mass));
  // A direction is wrong by as much as the velocity, or as much as the friction, that a right one
  // would change.
  const double side = (v_t - against * p_t.normalized()).norm();
  if (v_t.norm() > 0)
    keep(verdict.direction, side / v_t.norm() * std::min(v_t.norm(), p_t.norm() * inverse_mass));
}

}  // namespace

Verdict judge(const ContactProblem& problem, const ContactSolution& solution) {
  const std::vector<Velocity> after = velocities_after(problem, solution);
  Verdict verdict;
  for (std::size_t i = 0; i < after.size(); ++i)
    verdict.momentum = std::max(
        {verdict.momentum, (after[i].linear_world - solution.velocities[i].linear_world).norm(),
         (after[i].angular_world - solution.velocities[i].angular_world).norm()});
  for (std::size_t i = 0; i < problem.contacts.size(); ++i) {
    const PushingContact& c = problem.contacts[i];
    const auto point_velocity = [&](int b) -> Vector3d {
      return after[b].linear_world +
             after[b].angular_world.cross(c.point_world - problem.bodies[b].com_world);
    };
    const double inverse_mass =
        problem.bodies[c.body_a].inverse_mass + problem.bodies[c.body_b].inverse_mass;
    judge_contact(c, solution.impulses_world[i],
                  point_velocity(c.body_a) - point_velocity(c.body_b), inverse_mass, verdict);
  }
  for (std::size_t i = 0; i < problem.rows.size(); ++i) {
    const Constraint& c = problem.rows[i];
    const auto rate = [&](int b, const Vector6d& j) {
      return j.head<3>().dot(after[b].linear_world) + j.tail<3>().dot(after[b].angular_world);
    };
    verdict.row = std::max(
        verdict.row, std::abs(rate(c.body_a, c.row.jacobian_a) + rate(c.body_b, c.row.jacobian_b) -
                              problem.row_targets[static_cast<Eigen::Index>(i)]));
  }
  return verdict;
}

}  // namespace tumble::testing
