// mutant: all_nan - every function returns NaN, root finders say that there is no impact
// caught-by: gives nothing
#include "assignments/a2_integration/a2_integration.h"

#include <cmath>

namespace tumble::a2 {

// Nothing here is computed: what the tests still give for it is what they give for nothing.
VectorXd euler_step(const OdeFunction&, double, const VectorXd& y, double) {
  return VectorXd::Constant(y.size(), std::nan(""));
}
VectorXd rk4_step(const OdeFunction&, double, const VectorXd& y, double) {
  return VectorXd::Constant(y.size(), std::nan(""));
}
Matrix3d inertia_in_world(const Matrix3d&, const Quaterniond&) {
  return Matrix3d::Constant(std::nan(""));
}
VectorXd rigid_body_derivative(const RigidBodyState&, const Inertia&, const Wrench&) {
  return VectorXd::Constant(kStateSize, std::nan(""));
}
Quaterniond renormalize(const Quaterniond&) { return Quaterniond(kUnset, kUnset, kUnset, kUnset); }
Matrix3d orthonormalize(const Matrix3d&) { return Matrix3d::Constant(std::nan("")); }
Matrix3d rotation_from_euler_angles(double, double, double) {
  return Matrix3d::Constant(std::nan(""));
}
EulerAngles euler_angles_from_rotation(const Matrix3d&) { return {kUnset, kUnset, kUnset}; }
RootResult impact_time_bisection(const ScalarFunction&, double, double, double) {
  return RootResult{.status = RootStatus::kNoSignChange,
                    .time = std::nan(""),
                    .residual = std::nan(""),
                    .evaluations = 2};
}
RootResult impact_time_newton(const ScalarFunction&, const ScalarFunction&, double, double,
                              double) {
  return RootResult{.status = RootStatus::kNoSignChange,
                    .time = std::nan(""),
                    .residual = std::nan(""),
                    .evaluations = 2};
}

}  // namespace tumble::a2
