/// The few Eigen names that every folder and every student's file uses. Core and Geometry only:
/// they compile quickly.
#pragma once

#include <limits>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace tumble {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Quaterniond;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;

// an unset number is loud
inline constexpr double kUnset = std::numeric_limits<double>::quiet_NaN();

}  // namespace tumble
