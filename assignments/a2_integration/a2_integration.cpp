// Your work for assignment 2. Replace each body; the comment above its declaration in
// a2_integration.h says what it must do.
#include "assignments/a2_integration/a2_integration.h"

namespace tumble::a2 {

VectorXd euler_step(const OdeFunction&, double, const VectorXd&, double) {
  throw NotImplemented("euler_step", "handouts/a2_integration.md#hint-euler");
}

VectorXd rk4_step(const OdeFunction&, double, const VectorXd&, double) {
  throw NotImplemented("rk4_step", "handouts/a2_integration.md#hint-rk4");
}

Matrix3d inertia_in_world(const Matrix3d&, const Quaterniond&) {
  throw NotImplemented("inertia_in_world", "handouts/a2_integration.md#hint-inertia");
}

VectorXd rigid_body_derivative(const RigidBodyState&, const Inertia&, const Wrench&) {
  throw NotImplemented("rigid_body_derivative", "handouts/a2_integration.md#hint-derivative");
}

Quaterniond renormalize(const Quaterniond&) {
  throw NotImplemented("renormalize", "handouts/a2_integration.md#hint-renormalize");
}

Matrix3d orthonormalize(const Matrix3d&) {
  throw NotImplemented("orthonormalize", "handouts/a2_integration.md#hint-gram-schmidt");
}

Matrix3d rotation_from_euler_angles(double, double, double) {
  throw NotImplemented("rotation_from_euler_angles",
                       "handouts/a2_integration.md#hint-euler-angles");
}

EulerAngles euler_angles_from_rotation(const Matrix3d&) {
  throw NotImplemented("euler_angles_from_rotation", "handouts/a2_integration.md#hint-gimbal-lock");
}

RootResult impact_time_bisection(const ScalarFunction&, double, double, double) {
  throw NotImplemented("impact_time_bisection", "handouts/a2_integration.md#hint-bisection");
}

RootResult impact_time_newton(const ScalarFunction&, const ScalarFunction&, double, double,
                              double) {
  throw NotImplemented("impact_time_newton", "handouts/a2_integration.md#hint-newton");
}

}  // namespace tumble::a2
