#include "framework/dynamics/contact_system.h"

#include <cmath>
#include <limits>

#include "framework/dynamics/contact_cone.h"

namespace tumble::contacts {
namespace {

/// Lower triangular root of a symmetric positive semidefinite matrix. A direction in which nothing
/// moves gets a zero column.
Matrix3d lower_root(const Matrix3d& a) {
  // a pivot below this share of the trace is rounding of a zero
  constexpr double kRelative = 1e-15;
  const double least = kRelative * a.trace();
  Matrix3d root = Matrix3d::Zero();
  for (int j = 0; j < 3; ++j) {
    const double pivot = a(j, j) - root.row(j).head(j).squaredNorm();
    if (!(pivot > least)) continue;
    root(j, j) = std::sqrt(pivot);
    for (int i = j + 1; i < 3; ++i)
      root(i, j) = (a(i, j) - root.row(i).head(j).dot(root.row(j).head(j))) / root(j, j);
  }
  return root;
}

/// Rows n, t1, t2: right-handed, the tangents as far from the normal's largest part as can be.
Matrix3d contact_frame(const Vector3d& n) {
  const double x = std::abs(n[0]), y = std::abs(n[1]), z = std::abs(n[2]);
  const Vector3d other =
      x <= y && x <= z ? Vector3d::UnitX() : (y <= z ? Vector3d::UnitY() : Vector3d::UnitZ());
  const Vector3d t1 = other.cross(n).normalized();
  Matrix3d frame;
  frame << n.transpose(), t1.transpose(), n.cross(t1).transpose();
  return frame;
}

bool can_be_pushed(const System& system, int body) {
  return system.root_inverse_mass[body] > 0 || !system.root_inverse_inertia[body].isZero(0);
}

/// Row of G for the direction d at the arm r: v_point . d = v . d + omega . (r x d).
void fill_row(const System& system, int body, const Vector3d& arm, const Vector3d& direction,
              Jacobian& g, int row) {
  g.row(row).head<3>() = system.root_inverse_mass[body] * direction.transpose();
  g.row(row).tail<3>().noalias() =
      arm.cross(direction).transpose() * system.root_inverse_inertia[body];
}

void fill_side(const System& system, int body, const Vector3d& arm, double sign,
               const ContactBlock& block, Jacobian& g) {
  for (int k = 0; k < (block.is_frictional() ? 3 : 1); ++k)
    fill_row(system, body, arm, sign * block.contact_from_world.row(k).transpose(), g, k);
}

ContactBlock build_contact(const ContactProblem& problem, const PushingContact& contact,
                           System& system) {
  const PushedBody& a = problem.bodies[contact.body_a];
  const PushedBody& b = problem.bodies[contact.body_b];
  const Vector3d arm_a = contact.point_world - a.com_world,
                 arm_b = contact.point_world - b.com_world;
  ContactBlock block;
  block.friction = contact.friction;
  block.contact_from_world = contact_frame(contact.normal_b_to_a_world);
  if (can_be_pushed(system, contact.body_a)) {
    block.body_a = contact.body_a;
    fill_side(system, contact.body_a, arm_a, 1, block, block.g_a);
  }
  if (can_be_pushed(system, contact.body_b)) {
    block.body_b = contact.body_b;
    fill_side(system, contact.body_b, arm_b, -1, block, block.g_b);
  }
  const Vector3d v_a = a.velocity_world + a.omega_world.cross(arm_a),
                 v_b = b.velocity_world + b.omega_world.cross(arm_b);
  block.base = block.contact_from_world * (v_a - v_b);
  block.base[0] -= contact.target;
  block.base.tail<2>() -= (block.contact_from_world * contact.slip_target_world).tail<2>();
  if (!block.is_frictional()) block.base.tail<2>().setZero();
  block.inverse_effective_mass = diagonal_mean(block);
  system.speed = std::max({system.speed, v_a.norm(), v_b.norm(), std::abs(contact.target)});
  return block;
}

Vector6d weighted(const System& system, int body, const Vector6d& jacobian) {
  Vector6d g;
  g.head<3>() = system.root_inverse_mass[body] * jacobian.head<3>();
  g.tail<3>().noalias() = system.root_inverse_inertia[body].transpose() * jacobian.tail<3>();
  return g;
}

RowBlock build_row(const ContactProblem& problem, const Constraint& constraint, double target,
                   System& system) {
  RowBlock block;
  const auto rate = [&](int body, const Vector6d& jacobian) {
    return jacobian.head<3>().dot(problem.bodies[body].velocity_world) +
           jacobian.tail<3>().dot(problem.bodies[body].omega_world);
  };
  const double rate_a = rate(constraint.body_a, constraint.row.jacobian_a),
               rate_b = rate(constraint.body_b, constraint.row.jacobian_b);
  if (can_be_pushed(system, constraint.body_a)) {
    block.body_a = constraint.body_a;
    block.g_a = weighted(system, block.body_a, constraint.row.jacobian_a);
    block.inverse_effective_mass += block.g_a.squaredNorm();
  }
  if (can_be_pushed(system, constraint.body_b)) {
    block.body_b = constraint.body_b;
    block.g_b = weighted(system, block.body_b, constraint.row.jacobian_b);
    block.inverse_effective_mass += block.g_b.squaredNorm();
  }
  block.base = rate_a + rate_b - target;
  system.speed = std::max({system.speed, std::abs(rate_a), std::abs(rate_b), std::abs(target)});
  return block;
}

}  // namespace

double diagonal_mean(const ContactBlock& block) {
  double sum = 0;
  const int n = block.is_frictional() ? 3 : 1;
  if (block.body_a != kFixed) sum += block.g_a.topRows(n).squaredNorm();
  if (block.body_b != kFixed) sum += block.g_b.topRows(n).squaredNorm();
  return sum / n;
}

System build_system(const ContactProblem& problem) {
  System system;
  system.root_inverse_mass.reserve(problem.bodies.size());
  system.root_inverse_inertia.reserve(problem.bodies.size());
  for (const PushedBody& body : problem.bodies) {
    system.root_inverse_mass.push_back(std::sqrt(body.inverse_mass));
    system.root_inverse_inertia.push_back(lower_root(body.inverse_inertia_world));
  }
  system.contacts.reserve(problem.contacts.size());
  for (const PushingContact& contact : problem.contacts)
    system.contacts.push_back(build_contact(problem, contact, system));
  system.rows.reserve(problem.rows.size());
  for (std::size_t i = 0; i < problem.rows.size(); ++i)
    system.rows.push_back(build_row(problem, problem.rows[i],
                                    problem.row_targets[static_cast<Eigen::Index>(i)], system));
  return system;
}

Impulses warm_start_of(const System& system, const ContactProblem& problem) {
  Impulses impulses;
  impulses.rows.assign(system.rows.size(), 0.0);
  impulses.contacts.reserve(system.contacts.size());
  for (std::size_t i = 0; i < system.contacts.size(); ++i) {
    const ContactBlock& block = system.contacts[i];
    const Vector3d warm_start = block.contact_from_world * problem.contacts[i].warm_start_world;
    impulses.contacts.push_back(coulomb_projection(warm_start, block.friction));
  }
  sum_impulses(system, impulses);
  return impulses;
}

void sum_impulses(const System& system, Impulses& impulses) {
  impulses.y.assign(system.root_inverse_mass.size(), Vector6d::Zero());
  for (std::size_t i = 0; i < system.contacts.size(); ++i)
    push(system.contacts[i], impulses.contacts[i], impulses.y);
  for (std::size_t i = 0; i < system.rows.size(); ++i)
    push(system.rows[i], impulses.rows[i], impulses.y);
}

Violation measure_violation(const System& system, const Impulses& impulses) {
  Violation violation;
  const auto take = [&](double square) {
    violation.largest = std::max(violation.largest, square);
    violation.squares += square;
  };
  for (std::size_t i = 0; i < system.contacts.size(); ++i) {
    const ContactBlock& block = system.contacts[i];
    // between two bodies that nothing pushes there is no impulse to find
    if (!(block.inverse_effective_mass > 0)) continue;
    const Vector3d& p = impulses.contacts[i];
    const Vector3d v = yielding_velocity(block, p, impulses.y);
    take(block.inverse_effective_mass * block.inverse_effective_mass *
         (p - coulomb_projection(p - v / block.inverse_effective_mass, block.friction))
             .squaredNorm());
  }
  for (std::size_t i = 0; i < system.rows.size(); ++i)
    if (system.rows[i].inverse_effective_mass > 0)
      take(std::pow(row_velocity(system.rows[i], impulses.y), 2));
  violation.largest = std::sqrt(violation.largest);
  return violation;
}

double rounding_of(double largest) {
  // a contact's impulse goes through about so many operations on its way to a velocity
  constexpr double kRoundings = 16;
  return kRoundings * std::numeric_limits<double>::epsilon() * largest;
}

double rounding_floor(const System& system, const Impulses& impulses) {
  double largest = 0;
  for (std::size_t i = 0; i < system.contacts.size(); ++i)
    largest = std::max(largest, system.contacts[i].inverse_effective_mass *
                                    impulses.contacts[i].cwiseAbs().maxCoeff());
  for (std::size_t i = 0; i < system.rows.size(); ++i)
    largest = std::max(largest, system.rows[i].inverse_effective_mass * std::abs(impulses.rows[i]));
  return rounding_of(largest);
}

}  // namespace tumble::contacts
