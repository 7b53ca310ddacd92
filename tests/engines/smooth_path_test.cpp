// Paths between the ends of a step.
#include <gtest/gtest.h>

#include "framework/engines/stepping/smooth_path.h"

namespace tumble::testing {
namespace {

using engines::SmoothPath;

Inertia inertia() { return finite_inertia(2.0, Vector3d(1, 2, 3).asDiagonal()); }

RigidBodyState state(const Vector3d& place, const Vector3d& velocity) {
  return {place, Quaterniond(Eigen::AngleAxisd(place.z(), Vector3d::UnitX())),
          inertia().mass * velocity, Vector3d(0.1, 0.2, 0.3) + velocity};
}

TEST(SmoothPath, AShiftInAShortStepIsNoVelocityOfAStateWithin) {
  // s, m: a thousand metres a second, were it a motion
  constexpr double kStep = 1e-6, kShift = 1e-3;
  const RigidBodyState start = state(Vector3d::Zero(), Vector3d(1, 0, 0)),
                       end = state(Vector3d(kStep, 0, kShift), Vector3d(1, 0, -1));
  const SmoothPath path(start, end, inertia(), 0.0, kStep, SmoothPath::Momenta::kEven);
  for (const double part : {0.0, 0.25, 0.5, 1.0}) {
    const RigidBodyState within = path.at(part * kStep);
    // a rounding of numbers of size 2
    EXPECT_LE(
        (within.momentum_world - ((1 - part) * start.momentum_world + part * end.momentum_world))
            .norm(),
        1e-15);
    EXPECT_LE((within.angular_momentum_world -
               ((1 - part) * start.angular_momentum_world + part * end.angular_momentum_world))
                  .norm(),
              1e-15);
  }
  // What finds impacts goes by the way that is gone.
  EXPECT_GT(path.motion_at(0.5 * kStep).velocity_world.z(), 1000.0);
}

TEST(SmoothPath, MomentaOfThePathAreThoseOfItsVelocities) {
  constexpr double kStep = 0.1;
  const RigidBodyState start = state(Vector3d::Zero(), Vector3d(1, 0, 0)),
                       end = state(Vector3d(0.1, 0, -0.05), Vector3d(1, 0, -1));
  const SmoothPath path(start, end, inertia(), 0.0, kStep);
  for (const double part : {0.2, 0.7})
    EXPECT_LE((path.at(part * kStep).momentum_world -
               inertia().mass * path.motion_at(part * kStep).velocity_world)
                  .norm(),
              1e-15);
}

}  // namespace
}  // namespace tumble::testing
