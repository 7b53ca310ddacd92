// mutant: first_argument - every function returns what it was given
// caught-by: gives nothing
#include "assignments/a2_integration/a2_integration.h"

#include <cmath>

namespace tumble::a2 {

// Nothing here is computed: what the tests still give for it is what they give for nothing.
VectorXd euler_step(const OdeFunction&, double, const VectorXd& y, double) { return y; }
VectorXd rk4_step(const OdeFunction&, double, const VectorXd& y, double) { return y; }
Matrix3d inertia_in_world(const Matrix3d& given, const Quaterniond&) { return given; }
VectorXd rigid_body_derivative(const RigidBodyState& state, const Inertia&, const Wrench&) {
  return pack(state);
}
Quaterniond renormalize(const Quaterniond& given) { return given; }
Matrix3d orthonormalize(const Matrix3d& given) { return given; }
Matrix3d rotation_from_euler_angles(double, double, double) { return Matrix3d::Identity(); }
EulerAngles euler_angles_from_rotation(const Matrix3d&) { return {0.0, 0.0, 0.0}; }
RootResult impact_time_bisection(const ScalarFunction&, double t_low, double, double) {
  return RootResult{
      .status = RootStatus::kConverged, .time = t_low, .residual = 0.0, .evaluations = 2};
}
RootResult impact_time_newton(const ScalarFunction&, const ScalarFunction&, double t_low, double,
                              double) {
  return RootResult{
      .status = RootStatus::kConverged, .time = t_low, .residual = 0.0, .evaluations = 2};
}

}  // namespace tumble::a2
