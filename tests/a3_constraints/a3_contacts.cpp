#include "tests/a3_constraints/a3_contacts.h"

namespace tumble::a3_testing {

VectorXd forces_of(const MatrixXd& A, const VectorXd& b) {
  const VectorXd f = a3_module().contact_forces(A, b);
  return f.size() == b.size() ? f : VectorXd(VectorXd::Constant(b.size(), kUnset));
}

Contacts stack_of_boxes(int n) {
  Rig rig;
  rig.bodies.push_back(ceiling());
  for (int i = 1; i <= n; ++i) {
    rig.bodies.push_back(movable(1, Matrix3d::Identity() * 6));
    for (int corner = 0; corner < 4; ++corner) {
      const Vector3d below((corner & 1) - 0.5, (corner >> 1) - 0.5, -0.5);
      rig.rows.push_back(
          rod_between(i, below, i - 1, Vector3d(below.x(), below.y(), 0.5), Vector3d::UnitZ()));
    }
  }
  return {dense_matrix(rig), accelerations_of_rows(rig, VectorXd::Zero(rig.size()))};
}

Contacts random_contacts(Random& random, int m) {
  const int rank = 1 + static_cast<int>(random.between(0, m));
  const bool whole_numbers = random.between(0, 1) < 0.3, repeats = random.between(0, 1) < 0.5,
             parts = random.between(0, 1) < 0.3;
  const auto number = [&](double size) {
    return whole_numbers ? std::round(random.between(-size, size)) : random.between(-size, size);
  };
  MatrixXd G(m, rank);
  for (int i = 0; i < m; ++i)
    for (int k = 0; k < rank; ++k) G(i, k) = number(2);
  for (int i = 1; repeats && i < m; ++i)
    if (random.between(0, 1) < 0.4) G.row(i) = G.row(static_cast<int>(random.between(0, i))).eval();
  VectorXd u(rank);
  for (int k = 0; k < rank; ++k) u[k] = number(3);
  Contacts contacts{G * G.transpose(), G * u};
  for (int i = 0; parts && i < m; ++i)
    contacts.b[i] += whole_numbers ? std::round(random.between(0, 2)) : random.between(0, 1);
  return contacts;
}

void expect_complementary(const Contacts& contacts, const std::string& scene) {
  const auto& [A, b] = contacts;
  const VectorXd f = forces_of(A, b), a = A * f + b;
  const double size = std::max(1e-3, b.cwiseAbs().maxCoeff()), allowed = 1e-10 * size;
  const std::string where = scene + ": " + std::to_string(b.size()) + " contacts, |b| up to " +
                            show_scale(size) + " m/s^2";
  if (!f.allFinite()) {
    expect_true(false, "forces", "NaN, or not one a contact",
                {.scene = where,
                 .slip = "redundant contacts: A is singular, and a pivot of 0 is divided by",
                 .handout = equation(9)});
    return;
  }
  expect_true(f.minCoeff() >= 0, "no force < 0", "a force of " + show(f.minCoeff()) + " N",
              {.scene = where,
               .slip = "negative forces: a contact pushes, it never pulls",
               .handout = equation(9)});
  expect_true(a.minCoeff() >= -allowed, "no acceleration < " + show_scale(-allowed) + " m/s^2",
              show(a.minCoeff()) + " m/s^2",
              {.scene = where,
               .slip = a.minCoeff() > -0.05 * size
                           ? "an iteration that stops too early: bodies sink into each other slowly"
                           : "A f + b < 0: bodies enter each other; more contacts must push",
               .handout = equation(9)});
  const double product = f.cwiseProduct(a.cwiseAbs()).maxCoeff();
  expect_true(product <= allowed * std::max(1.0, f.maxCoeff()), "f . a = 0",
              "f a = " + show(product) + " N m/s^2 at one contact",
              {.scene = where,
               .slip = "without complementarity: a force acts where the bodies part; a "
                       "contact that lets go changes what the others must do",
               .handout = equation(9)});
}

bool something_is_held() {
  const VectorXd f = forces_of(MatrixXd::Constant(1, 1, 0.5), vector({-1}));
  expect_true(
      f.allFinite() && f[0] > 0, "a force", "none",
      {.scene =
           "this test's own answer is \"nothing\", so this is asked before it: a ball on the floor",
       .slip = "the function gives nothing (0 or NaN) where there is an answer",
       .handout = equation(9)});
  return f.allFinite() && f[0] > 0;
}

}  // namespace tumble::a3_testing
