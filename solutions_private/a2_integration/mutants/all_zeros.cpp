// mutant: all_zeros - every function returns 0
// caught-by: gives nothing
#include "assignments/a2_integration/a2_integration.h"

#include <cmath>

namespace tumble::a2 {

// Nothing here is computed: what the tests still give for it is what they give for nothing.
VectorXd euler_step(const OdeFunction&, double, const VectorXd& y, double) {
  return VectorXd::Zero(y.size());
}
VectorXd rk4_step(const OdeFunction&, double, const VectorXd& y, double) {
  return VectorXd::Zero(y.size());
}
Matrix3d inertia_in_world(const Matrix3d&, const Quaterniond&) { return Matrix3d::Zero(); }
VectorXd rigid_body_derivative(const RigidBodyState&, const Inertia&, const Wrench&) {
  return VectorXd::Zero(kStateSize);
}
Quaterniond renormalize(const Quaterniond&) { return Quaterniond(0, 0, 0, 0); }
Matrix3d orthonormalize(const Matrix3d&) { return Matrix3d::Zero(); }
Matrix3d rotation_from_euler_angles(double, double, double) { return Matrix3d::Zero(); }
EulerAngles euler_angles_from_rotation(const Matrix3d&) { return {0.0, 0.0, 0.0}; }
RootResult impact_time_bisection(const ScalarFunction&, double, double, double) {
  return RootResult{.status = RootStatus{}, .time = 0.0, .residual = 0.0, .evaluations = 0};
}
RootResult impact_time_newton(const ScalarFunction&, const ScalarFunction&, double, double,
                              double) {
  return RootResult{.status = RootStatus{}, .time = 0.0, .residual = 0.0, .evaluations = 0};
}

}  // namespace tumble::a2
