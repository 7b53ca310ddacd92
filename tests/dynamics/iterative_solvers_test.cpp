// Iterative solvers and root finders to compare with: what they solve, and that their tolerance is
// what they keep.
#include <cmath>

#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/dynamics/iterative_solvers.h"
#include "framework/dynamics/root_methods.h"

namespace tumble {
namespace {

constexpr int kLinks = 6;

/// A chain of six bodies, each held to the one before; the first is infinitely heavy. Rows along
/// directions that turn, off the centres.
struct Chain {
  std::vector<Constraint> constraints;
  std::vector<ConstrainedBody> bodies;
};

Chain chain() {
  Chain chain;
  for (int i = 0; i <= kLinks; ++i) {
    ConstrainedBody body{
        i == 0 ? 0.0 : 1.0 / i,
        i == 0 ? Matrix3d(Matrix3d::Zero()) : Matrix3d(Vector3d(1.0, 2.0, 3.0).asDiagonal()),
        Vector6d::Zero()};
    if (i > 0) body.free_acceleration << 0.1 * i, 0.0, -9.81, 0.3, -0.2 * i, 0.1;
    chain.bodies.push_back(body);
    if (i == 0) continue;
    ConstraintRow row;
    const Vector3d n(std::cos(i), std::sin(i), 0.5), arm(0.1, 0.2 * i, -0.1);
    row.jacobian_a << n, arm.cross(n);
    row.jacobian_b << -n, arm.cross(-n);
    row.value = 0.01 * i;
    row.rate = 0.0;
    row.velocity_product = 0.2 * i;
    chain.constraints.push_back({i, i - 1, row});
  }
  return chain;
}

/// J u of every row, where a row's bodies go by u.
double along(const Constraint& constraint, const std::vector<Vector6d>& u) {
  return constraint.row.jacobian_a.dot(u[constraint.body_a]) +
         constraint.row.jacobian_b.dot(u[constraint.body_b]);
}

/// How far C'' is from what is wanted, with the multipliers applied as forces.
double residual_of(const Chain& chain, const VectorXd& lambda, const VectorXd& wanted) {
  std::vector<Vector6d> u;
  for (const ConstrainedBody& body : chain.bodies) u.push_back(body.free_acceleration);
  for (std::size_t i = 0; i < chain.constraints.size(); ++i)
    for (const auto& [body, jacobian] :
         {std::pair{chain.constraints[i].body_a, chain.constraints[i].row.jacobian_a},
          std::pair{chain.constraints[i].body_b, chain.constraints[i].row.jacobian_b}}) {
      u[body].head<3>() += chain.bodies[body].inverse_mass * lambda[static_cast<Eigen::Index>(i)] *
                           jacobian.head<3>();
      u[body].tail<3>() += chain.bodies[body].inverse_inertia_world *
                           (lambda[static_cast<Eigen::Index>(i)] * jacobian.tail<3>());
    }
  double most = 0.0;
  for (std::size_t i = 0; i < chain.constraints.size(); ++i)
    most = std::max(
        most, std::abs(along(chain.constraints[i], u) + chain.constraints[i].row.velocity_product -
                       wanted[static_cast<Eigen::Index>(i)]));
  return most;
}

TEST(Gradients, MultipliersHoldTheLinksToTheTolerance) {
  const Chain links = chain();
  const VectorXd wanted = VectorXd::LinSpaced(kLinks, -1.0, 1.0);
  for (const double tolerance : {1e-2, 1e-6, 1e-12}) {
    Laws laws;
    solve_links_by_gradients(tolerance, laws);
    // The right-hand side is below 40 m/s^2 in every row, 100 in the 2-norm.
    EXPECT_LE(
        residual_of(links, laws.constraint_multipliers(links.constraints, links.bodies, wanted),
                    wanted),
        100.0 * tolerance)
        << tolerance;
  }
}

TEST(Gradients, CorrectionBringsEveryRowBack) {
  const Chain links = chain();
  const VectorXd error = VectorXd::LinSpaced(kLinks, 0.01, 0.06);
  Laws laws;
  solve_links_by_gradients(1e-13, laws);
  const VectorXd change = laws.constraint_correction(links.constraints, links.bodies, error);
  ASSERT_EQ(change.size(), 6 * (kLinks + 1));
  std::vector<Vector6d> u;
  for (int k = 0; k <= kLinks; ++k) u.push_back(change.segment<6>(6 * k));
  // 1e-13 of 0.1, some roundings
  for (int i = 0; i < kLinks; ++i) EXPECT_NEAR(along(links.constraints[i], u), -error[i], 1e-12);
}

TEST(Sweeps, ForcesPushOnlyAndOnlyWhereBodiesTouch) {
  MatrixXd A(3, 3);
  A << 2.0, 0.5, 0.1, 0.5, 1.5, -0.2, 0.1, -0.2, 1.0;
  const VectorXd b = (VectorXd(3) << -4.0, -1.0, 2.0).finished();  // the third wants to part
  Laws laws;
  solve_contacts_by_sweeps(1e-13, laws);
  const VectorXd f = laws.contact_forces(A, b), a = A * f + b;
  for (int i = 0; i < 3; ++i) {
    EXPECT_GE(f[i], 0.0);
    EXPECT_GE(a[i], -1e-11);  // 1e-13 of the largest force, times entries of A
    EXPECT_NEAR(f[i] * a[i], 0.0, 1e-10);
  }
  EXPECT_GT(f[0], 0.0);
  EXPECT_EQ(f[2], 0.0);
}

/// Eight bodies of 1 kg one on the other, the lowest on the ground, each touching the next in one
/// point below its centre, after a step's fall.
ContactProblem tower() {
  constexpr int kBodies = 8;
  ContactProblem problem;
  for (int i = 0; i <= kBodies; ++i) {
    PushedBody body;
    body.com_world = Vector3d(0.0, 0.0, i);
    body.velocity_world = body.omega_world = Vector3d::Zero();
    if (i > 0) {
      body.inverse_mass = 1.0;
      body.inverse_inertia_world = Matrix3d::Identity();
      body.velocity_world.z() = -9.81 / 60.0;
    }
    problem.bodies.push_back(body);
    if (i == 0) continue;
    PushingContact contact;
    contact.body_a = i;
    contact.body_b = i - 1;
    contact.point_world = Vector3d(0.0, 0.0, i - 0.5);
    contact.normal_b_to_a_world = Vector3d::UnitZ();
    contact.friction = 0.5;
    problem.contacts.push_back(contact);
  }
  return problem;
}

/// Farthest that an impulse is from what lies above it. [N s]
double farthest_from_weights(const ContactSolution& solution) {
  double most = 0.0;
  const double weight = 9.81 / 60.0;
  for (std::size_t i = 0; i < solution.impulses_world.size(); ++i)
    most = std::max(
        most, (solution.impulses_world[i] -
               Vector3d(0.0, 0.0, weight * static_cast<double>(solution.impulses_world.size() - i)))
                  .norm());
  return most;
}

TEST(Sweeps, WithFrictionEndAtTheirToleranceAndTightOnesTakeMore) {
  Laws loose, tight, newton;
  solve_contacts_by_sweeps(1e-2, loose);
  solve_contacts_by_sweeps(1e-10, tight);
  solve_contacts_by_newton(1e-10, newton);
  const ContactSolution coarse = loose.friction_impulses(tower(), {}),
                        fine = tight.friction_impulses(tower(), {}),
                        direct = newton.friction_impulses(tower(), {});
  EXPECT_TRUE(coarse.converged && fine.converged && direct.converged);
  EXPECT_LE(fine.residual, 1e-10);
  EXPECT_GT(fine.sweeps, 2 * coarse.sweeps);
  // Velocities are right to the tolerance times 0.16 m/s; impulses are the sums of eight of them,
  // over the least eigenvalue of the tower (4 sin^2(pi / 34) = 0.034): 1e-10 * 0.16 * 8 / 0.034.
  // The loose ones are off by far more than that.
  EXPECT_LT(farthest_from_weights(fine), 4e-9);
  EXPECT_LT(farthest_from_weights(direct), 4e-9);
  EXPECT_GT(farthest_from_weights(coarse), 1e-3);
  EXPECT_LT(direct.sweeps, fine.sweeps);
}

TEST(RootMethods, ReachTheirToleranceOnAFallingBody) {
  // 2 - t - 4.905 t^2, which closes at (-1 + sqrt(1 + 8 4.905)) / (2 4.905); a bracket of half a
  // second.
  const ScalarFunction gap = [](double t) { return 2.0 - t - 4.905 * t * t; },
                       rate = [](double t) { return -1.0 - 9.81 * t; };
  const double exact = (-1.0 + std::sqrt(1.0 + 8.0 * 4.905)) / (2.0 * 4.905);
  for (const RootMethod& method : root_methods())
    for (const double tolerance : {1e-3, 1e-6, 1e-9, 1e-12}) {
      const RootResult found = method.find(gap, rate, 0.3, 0.8, tolerance);
      EXPECT_EQ(found.status, RootStatus::kConverged) << method.word;
      EXPECT_NEAR(found.time, exact, tolerance) << method.word;
      EXPECT_GT(found.evaluations, 0) << method.word;
    }
}

// The springs and rows that it leaves alone keep their author.
TEST(IterativeSolvers, NameThemselvesBesideTheModuleWhoseSpringsStay) {
  Laws laws;
  laws.constraint_source = "a3 student";
  solve_links_by_gradients(1e-6, laws);
  EXPECT_EQ(laws.constraint_source, "a3 student");
  EXPECT_EQ(laws.source_of_links(), "conjugate gradients");
  EXPECT_EQ(laws.source_of_contacts(), "a3 student");
  solve_contacts_by_sweeps(1e-6, laws);
  EXPECT_EQ(laws.constraint_source, "a3 student");
  EXPECT_EQ(laws.source_of_contacts(), "Gauss-Seidel sweeps");
}

TEST(RootMethods, SayWhereThereIsNoSignChange) {
  for (const RootMethod& method : root_methods())
    EXPECT_EQ(
        method.find([](double) { return 1.0; }, [](double) { return 0.0; }, 0.0, 1.0, 1e-6).status,
        RootStatus::kNoSignChange)
        << method.word;
  EXPECT_THROW(root_method_named("newtn"), UserError);
}

// 200 halvings of [0, 1] leave 2^-200 = 6e-61 around a root at 1e-200: far from the tolerance.
TEST(RootMethods, SayWhereTheirIterationsRunOut) {
  const ScalarFunction gap = [](double t) { return 1e-200 - t; },
                       rate = [](double) { return -1.0; };
  const RootMethod& bisection = root_method_named("bisection");
  EXPECT_EQ(bisection.find(gap, rate, 0.0, 1.0, 1e-220).status, RootStatus::kNotConverged);
  EXPECT_EQ(bisection.find(gap, rate, 0.0, 1.0, 1e-50).status, RootStatus::kConverged);
}

TEST(RootMethods, NewtonLooksAtFewerGapsThanBisection) {
  const ScalarFunction gap = [](double t) { return 2.0 - t - 4.905 * t * t; },
                       rate = [](double t) { return -1.0 - 9.81 * t; };
  EXPECT_LT(3 * root_method_named("newton").find(gap, rate, 0.3, 0.8, 1e-12).evaluations,
            root_method_named("bisection").find(gap, rate, 0.3, 0.8, 1e-12).evaluations);
}

}  // namespace
}  // namespace tumble
