// The projecting stabilisation (A3.8).
#include <Eigen/LU>

#include "tests/a3_constraints/a3_fixtures.h"

namespace tumble::a3_testing {
namespace {

VectorXd corrected(const Rig& rig, const VectorXd& error) {
  const VectorXd x = a3_module().constraint_correction(rig.rows, rig.bodies, error);
  const Eigen::Index size = 6 * static_cast<Eigen::Index>(rig.bodies.size());
  return x.size() == size ? x : VectorXd(VectorXd::Constant(size, kUnset));
}

VectorXd rows_times(const Rig& rig, const VectorXd& x) {
  VectorXd result(rig.size());
  for (Eigen::Index i = 0; i < rig.size(); ++i) {
    const Constraint& c = rig.rows[static_cast<std::size_t>(i)];
    result[i] = c.row.jacobian_a.dot(x.segment<6>(6 * c.body_a)) +
                c.row.jacobian_b.dot(x.segment<6>(6 * c.body_b));
  }
  return result;
}

TEST(ConstraintCorrection, SharesTheWayByInverseMass) {
  // 1 and 3 kg on a rod along x that is 0.4 m too long: the light one moves by three quarters of
  // it.
  Rig rig;
  rig.bodies = {point_mass(1), point_mass(3)};
  rig.rows.push_back(rod_between(0, Vector3d::Zero(), 1, Vector3d::Zero(), Vector3d::UnitX()));
  const VectorXd found = corrected(rig, vector({0.4}));
  VectorXd expected = VectorXd::Zero(12);
  expected[0] = -0.3;
  expected[6] = 0.1;
  VectorXd halves = expected, by_mass = expected;
  halves[0] = -0.2, halves[6] = 0.2;
  by_mass[0] = -0.1, by_mass[6] = 0.3;
  expect_near(found, expected, 20 * kEps, "m (and rad)",
              {.scene = "1 kg (A) and 3 kg (B) on a rod along x, C = 0.4 m too long",
               .slip = likely<VectorXd>(
                   found,
                   Slips<VectorXd>{{-expected, "the sign is wrong: J x = -error"},
                                   {halves, "the masses are forgotten: x = -M^-1 J^T lambda"},
                                   {by_mass, "mass for inverse mass: the heavier body moves less"}},
                   "x = -M^-1 J^T lambda, A lambda = error"),
               .handout = equation(8)});
}

TEST(ConstraintCorrection, RemovesEveryError) {
  Random random(302);
  for (int i = 0; i < 10; ++i) {
    const Rig rig = random_rig(random, 6, 4);
    const VectorXd error = rig.wanted, x = corrected(rig, error);
    // Condition of A below 1e4 for these; one backward stable solution.
    expect_near(rows_times(rig, x), VectorXd(-error), 1e-10, "m (J x)",
                {.scene = rig.scene + ", number " + std::to_string(i),
                 .slip = distance(rows_times(rig, x), error) < 1e-8
                             ? "the sign is wrong: J x = -error"
                             : "J x = -error in every row at once: A is not diagonal",
                 .handout = equation(8)});
  }
}

TEST(ConstraintCorrection, LeavesWallsAlone) {
  Rig rig = hanging_chain({1, 2});
  const VectorXd found = corrected(rig, vector({0.1, -0.2}));
  // Rod 1 holds body 1 (A) below the ceiling, rod 2 body 2 (B) below body 1: z of body 1 rises by
  // 0.1, that of body 2 by 0.1 - 0.2.
  VectorXd expected = VectorXd::Zero(18);
  expected[8] = 0.1;
  expected[14] = -0.1;
  expect_near(found, expected, 50 * kEps, "m (and rad)",
              {.scene = "two weights below the ceiling (body 0), the first rod 0.1 m too long, the "
                        "second 0.2 m too short",
               .slip = "the ceiling moves, a sign, or a side of the second rod",
               .handout = equation(8)});
}

TEST(ConstraintCorrection, IsTheSmallestOfAll) {
  // The minimal x . M x with J x = -error is orthogonal, in the kinetic (mass) metric, to every
  // motion that the rods allow.
  Random random(303);
  Rig rig = random_rig(random, 5, 2);
  const VectorXd x = corrected(rig, rig.wanted);
  const auto weighted = [&](const VectorXd& u) {
    VectorXd w = u;
    for (std::size_t i = 1; i < rig.bodies.size(); ++i) {
      const Eigen::Index at = 6 * static_cast<Eigen::Index>(i);
      w.segment<3>(at) /= rig.bodies[i].inverse_mass;
      w.segment<3>(at + 3) = rig.bodies[i].inverse_inertia_world.inverse() * u.segment<3>(at + 3);
    }
    return w;
  };
  if (!(x.norm() > 0.01)) {
    expect_true(false, "a change", "none",
                {.scene = rig.scene,
                 .slip = "the function gives nothing (0 or NaN)",
                 .handout = equation(8)});
    return;
  }
  // Motions that the rods allow: a random u minus its other part, by a projection in plain numbers.
  MatrixXd J = MatrixXd::Zero(rig.size(), x.size());
  for (Eigen::Index i = 0; i < rig.size(); ++i) {
    const Constraint& c = rig.rows[static_cast<std::size_t>(i)];
    J.row(i).segment<6>(6 * c.body_a) += c.row.jacobian_a.transpose();
    J.row(i).segment<6>(6 * c.body_b) += c.row.jacobian_b.transpose();
  }
  J.leftCols(6).setZero();  // the ceiling is fixed
  for (int k = 0; k < 5; ++k) {
    VectorXd u(x.size());
    for (Eigen::Index i = 0; i < u.size(); ++i) u[i] = random.between(-1, 1);
    u.head(6).setZero();
    for (int sweep = 0; sweep < 4000; ++sweep)  // Kaczmarz: onto one row after the other
      for (Eigen::Index i = 0; i < J.rows(); ++i)
        u -= J.row(i).dot(u) / J.row(i).squaredNorm() * J.row(i).transpose();
    expect_near(
        u.dot(weighted(x)), 0.0, 1e-8 * weighted(x).norm() * u.norm(), "kg m^2",
        {.scene = rig.scene + "; x against a motion that no rod minds",
         .slip =
             "the masses are forgotten: x = -M^-1 J^T lambda, so that nothing moves that need not",
         .handout = equation(8)});
  }
}

TEST(ConstraintCorrection, BearsRodsThatAreThereTwice) {
  Rig rig = hanging_chain({1, 2, 4});
  rig.bodies.push_back(ceiling());
  rig.rows.push_back(rig.rows[1]);
  rig.rows.push_back(rod_between(0, Vector3d::Zero(), 4, Vector3d::Zero(), Vector3d::UnitZ()));
  const VectorXd found = corrected(rig, vector({0.1, 0.2, -0.1, 0.2, 0.3}));
  VectorXd expected = VectorXd::Zero(30);
  expected[8] = 0.1;
  expected[14] = 0.3;
  expected[20] = 0.2;
  expect_near(found, expected, 1e-10, "m (and rad)",
              {.scene = "three weights below each other, the second rod there twice, and a rod "
                        "from wall to wall",
               .slip = "singular rows: a pivot of 0, or of round-off, is divided by",
               .handout = equation(8),
               .no_number = "singular rows: a pivot of 0 is divided by",
               .iterates = true});
}

}  // namespace
}  // namespace tumble::a3_testing
