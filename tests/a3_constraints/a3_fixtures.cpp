#include "tests/a3_constraints/a3_fixtures.h"

#include "framework/core/decompositions.h"

namespace tumble::a3_testing {

Body resting_at(const Vector3d& com_world) {
  return {{2.0, 0.5, Vector3d(1, 2, 4).asDiagonal(), Vector3d(1, 0.5, 0.25).asDiagonal()},
          com_world,
          Quaterniond::Identity(),
          Vector3d::Zero(),
          Vector3d::Zero()};
}

Vector3d random_vector(Random& random, double size) {
  const double x = random.between(-size, size), y = random.between(-size, size),
               z = random.between(-size, size);
  return {x, y, z};
}

Quaterniond random_rotation(Random& random) {
  for (;;) {
    const Vector3d v = random_vector(random, 1);
    const Quaterniond q(random.between(-1, 1), v.x(), v.y(), v.z());
    if (q.norm() > 0.1 && q.norm() < 1) return q.normalized();
  }
}

Body random_body(Random& random) {
  Body body = resting_at(random_vector(random, 2));
  body.world_from_body = random_rotation(random);
  body.velocity_world = random_vector(random, 3);
  body.omega_world = random_vector(random, 3);
  return body;
}

Vector6d velocity_of(const Body& body) {
  Vector6d u;
  u << body.velocity_world, body.omega_world;
  return u;
}

ConstrainedBody movable(double mass, const Matrix3d& inverse_inertia_world) {
  Vector6d falling = Vector6d::Zero();
  falling[2] = -kGravity;
  return {1 / mass, inverse_inertia_world, falling};
}

ConstrainedBody point_mass(double mass) {
  return movable(mass, Matrix3d::Identity() / (0.01 * mass));
}

ConstrainedBody ceiling() { return {0.0, Matrix3d::Zero(), Vector6d::Zero()}; }

Constraint rod_between(int a, const Vector3d& arm_a, int b, const Vector3d& arm_b,
                       const Vector3d& n, double velocity_product) {
  Constraint c;
  c.body_a = a;
  c.body_b = b;
  c.row.jacobian_a << n, arm_a.cross(n);
  c.row.jacobian_b << -n, -arm_b.cross(n);
  c.row.value = 0.0;
  c.row.rate = 0.0;
  c.row.velocity_product = velocity_product;
  return c;
}

Rig hanging_chain(const std::vector<double>& masses) {
  Rig rig;
  rig.bodies.push_back(ceiling());
  for (std::size_t i = 0; i < masses.size(); ++i) {
    rig.bodies.push_back(point_mass(masses[i]));
    const int lower = static_cast<int>(i) + 1;
    // Every other rod has its upper body as A, so that both sides of a row are tested.
    if (i % 2 == 0)
      rig.rows.push_back(
          rod_between(lower, Vector3d::Zero(), lower - 1, Vector3d::Zero(), -Vector3d::UnitZ()));
    else
      rig.rows.push_back(
          rod_between(lower - 1, Vector3d::Zero(), lower, Vector3d::Zero(), Vector3d::UnitZ()));
  }
  rig.wanted = VectorXd::Zero(rig.size());
  return rig;
}

Rig random_rig(Random& random, int bodies, int extra_rows) {
  Rig rig;
  rig.scene = std::to_string(bodies) +
              " random bodies tied to each other and to the ceiling by random rods";
  rig.bodies.push_back(ceiling());
  for (int i = 1; i <= bodies; ++i) {
    const Matrix3d R = random_rotation(random).toRotationMatrix();
    const double mass = random.between(0.5, 3);
    const Vector3d inverse_moments(random.between(1, 5), random.between(1, 5),
                                   random.between(1, 5));
    ConstrainedBody body = movable(mass, R * inverse_moments.asDiagonal() * R.transpose());
    body.free_acceleration << random_vector(random, 5), random_vector(random, 5);
    rig.bodies.push_back(body);
  }
  const auto tie = [&](int a, int b) {
    const Vector3d arm_a = random_vector(random, 1), arm_b = random_vector(random, 1);
    rig.rows.push_back(rod_between(a, arm_a, b, arm_b, random_rotation(random) * Vector3d::UnitX(),
                                   random.between(-2, 2)));
  };
  for (int i = 1; i <= bodies; ++i) {
    const int other = static_cast<int>(random.between(0, i));
    if (i % 2 == 0)
      tie(i, other);
    else
      tie(other, i);
  }
  for (int i = 0; i < extra_rows; ++i) {
    const int a = 1 + static_cast<int>(random.between(0, bodies)),
              b = static_cast<int>(random.between(0, a));
    tie(a, b);
  }
  rig.wanted = VectorXd::Zero(rig.size());
  for (Eigen::Index i = 0; i < rig.size(); ++i) rig.wanted[i] = random.between(-3, 3);
  return rig;
}

namespace {

VectorXd accelerated(const Rig& rig, VectorXd forces) {
  for (std::size_t i = 0; i < rig.bodies.size(); ++i) {
    const Eigen::Index at = 6 * static_cast<Eigen::Index>(i);
    forces.segment<3>(at) *= rig.bodies[i].inverse_mass;
    forces.segment<3>(at + 3) =
        (rig.bodies[i].inverse_inertia_world * forces.segment<3>(at + 3)).eval();
  }
  return forces;
}

double row_times(const Constraint& c, const VectorXd& u) {
  return c.row.jacobian_a.dot(u.segment<6>(6 * c.body_a)) +
         c.row.jacobian_b.dot(u.segment<6>(6 * c.body_b));
}

}  // namespace

VectorXd forces_on_bodies(const Rig& rig, const VectorXd& lambda) {
  VectorXd forces = VectorXd::Zero(6 * static_cast<Eigen::Index>(rig.bodies.size()));
  if (lambda.size() != rig.size()) return VectorXd::Constant(forces.size(), kUnset);
  for (Eigen::Index i = 0; i < rig.size(); ++i) {
    const Constraint& c = rig.rows[static_cast<std::size_t>(i)];
    forces.segment<6>(6 * c.body_a) += lambda[i] * c.row.jacobian_a;
    forces.segment<6>(6 * c.body_b) += lambda[i] * c.row.jacobian_b;
  }
  return forces;
}

VectorXd accelerations_of_rows(const Rig& rig, const VectorXd& lambda) {
  VectorXd u = accelerated(rig, forces_on_bodies(rig, lambda));
  for (std::size_t i = 0; i < rig.bodies.size(); ++i)
    u.segment<6>(6 * static_cast<Eigen::Index>(i)) += rig.bodies[i].free_acceleration;
  VectorXd result(rig.size());
  for (Eigen::Index i = 0; i < rig.size(); ++i)
    result[i] = row_times(rig.rows[static_cast<std::size_t>(i)], u) +
                rig.rows[static_cast<std::size_t>(i)].row.velocity_product;
  return result;
}

MatrixXd dense_matrix(const Rig& rig) {
  MatrixXd J = MatrixXd::Zero(rig.size(), 6 * static_cast<Eigen::Index>(rig.bodies.size())), W = J;
  for (Eigen::Index i = 0; i < rig.size(); ++i) {
    const Constraint& c = rig.rows[static_cast<std::size_t>(i)];
    J.row(i).segment<6>(6 * c.body_a) += c.row.jacobian_a.transpose();
    J.row(i).segment<6>(6 * c.body_b) += c.row.jacobian_b.transpose();
    W.row(i) = accelerated(rig, J.row(i).transpose()).transpose();
  }
  return J * W.transpose();
}

double size_of_terms(const Rig& rig) {
  double size = 1.0;
  for (std::size_t i = 0; i < rig.bodies.size(); ++i)
    size = std::max(size, rig.bodies[i].free_acceleration.cwiseAbs().maxCoeff());
  if (rig.size() == 0) return size;
  const VectorXd lambda = least_squares(
      dense_matrix(rig), rig.wanted - accelerations_of_rows(rig, VectorXd::Zero(rig.size())));
  for (Eigen::Index i = 0; i < rig.size(); ++i) {
    const Constraint& c = rig.rows[static_cast<std::size_t>(i)];
    size = std::max(
        {size, std::abs(lambda[i]) * rig.bodies[static_cast<std::size_t>(c.body_a)].inverse_mass,
         std::abs(lambda[i]) * rig.bodies[static_cast<std::size_t>(c.body_b)].inverse_mass});
  }
  return size;
}

}  // namespace tumble::a3_testing
