#pragma once

#include "framework/core/not_implemented.h"
#include "framework/dynamics/body.h"
#include "framework/dynamics/ode.h"
#include "framework/modules/module.h"

namespace tumble::a2 {

VectorXd euler_step(const OdeFunction& f, double t, const VectorXd& y, double h);
VectorXd rk4_step(const OdeFunction& f, double t, const VectorXd& y, double h);
Matrix3d inertia_in_world(const Matrix3d& inertia_body, const Quaterniond& world_from_body);
VectorXd rigid_body_derivative(const RigidBodyState& state, const Inertia& inertia, const Wrench& wrench);
Quaterniond renormalize(const Quaterniond& world_from_body);
Matrix3d orthonormalize(const Matrix3d& drifted_world_from_body);
Matrix3d rotation_from_euler_angles(double yaw, double pitch, double roll);
RootResult impact_time_bisection(const ScalarFunction& gap, double t_low, double t_high, double tolerance);
RootResult impact_time_newton(const ScalarFunction& gap, const ScalarFunction& gap_rate, double t_low, double t_high, double tolerance);

}  // namespace tumble::a2

TUMBLE_MODULE(a2, euler_step, rk4_step, inertia_in_world, rigid_body_derivative, renormalize, orthonormalize,
              rotation_from_euler_angles, impact_time_bisection, impact_time_newton);
