#include "assignments/a2_integration/a2_integration.h"

namespace tumble::a2 {

VectorXd euler_step(const OdeFunction&, double, const VectorXd&, double) { throw NotImplemented("euler_step", "handouts/a2_integration.md"); }
VectorXd rk4_step(const OdeFunction&, double, const VectorXd&, double) { throw NotImplemented("rk4_step", "handouts/a2_integration.md"); }
Matrix3d inertia_in_world(const Matrix3d&, const Quaterniond&) { throw NotImplemented("inertia_in_world", "handouts/a2_integration.md"); }
VectorXd rigid_body_derivative(const RigidBodyState&, const Inertia&, const Wrench&) { throw NotImplemented("rigid_body_derivative", "handouts/a2_integration.md"); }
Quaterniond renormalize(const Quaterniond&) { throw NotImplemented("renormalize", "handouts/a2_integration.md"); }
Matrix3d orthonormalize(const Matrix3d&) { throw NotImplemented("orthonormalize", "handouts/a2_integration.md"); }
Matrix3d rotation_from_euler_angles(double, double, double) { throw NotImplemented("rotation_from_euler_angles", "handouts/a2_integration.md"); }
RootResult impact_time_bisection(const ScalarFunction&, double, double, double) { throw NotImplemented("impact_time_bisection", "handouts/a2_integration.md"); }
RootResult impact_time_newton(const ScalarFunction&, const ScalarFunction&, double, double, double) { throw NotImplemented("impact_time_newton", "handouts/a2_integration.md"); }

}  // namespace tumble::a2
