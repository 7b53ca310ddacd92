#include "framework/dynamics/body.h"

#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "framework/core/error.h"

namespace tumble {

Inertia finite_inertia(double mass, const Matrix3d& inertia_body) {
  require(std::isfinite(mass) && mass > 0, "finite_inertia: mass must be positive and finite");
  const Eigen::LLT<Matrix3d> cholesky(inertia_body);
  require(cholesky.info() == Eigen::Success &&
              (cholesky.matrixL().toDenseMatrix().diagonal().array() > 0).all(),
          "finite_inertia: the inertia tensor must be symmetric positive definite");
  Inertia inertia;
  inertia.mass = mass;
  inertia.inverse_mass = 1.0 / mass;
  inertia.inertia_body = inertia_body;
  // A diagonal tensor is inverted entry by entry, so that a needle (moments 1e-6 : 1) loses no
  // digits to elimination.
  const Vector3d moments = inertia_body.diagonal();
  inertia.inverse_inertia_body = inertia_body.isDiagonal(0.0)
                                     ? Matrix3d(moments.cwiseInverse().asDiagonal())
                                     : Matrix3d(cholesky.solve(Matrix3d::Identity()));
  return inertia;
}

Inertia infinite_inertia() {
  Inertia inertia;
  inertia.mass = std::numeric_limits<double>::infinity();
  inertia.inverse_mass = 0.0;
  inertia.inertia_body = Matrix3d::Zero();
  inertia.inverse_inertia_body = Matrix3d::Zero();
  return inertia;
}

}  // namespace tumble
