// The reference solution of a2 on whole rigid bodies, against exact motion: orders of convergence,
// and what is conserved.
#include <cmath>

#include <gtest/gtest.h>

#include "assignments/a2_integration/a2_integration.h"
#include "framework/dynamics/free_rotation.h"
#include "framework/dynamics/world.h"

namespace tumble::a2 {
namespace {

using Step = std::function<VectorXd(const OdeFunction&, double t, const VectorXd& y, double h)>;

struct Flight {
  const char* name;
  Vector3d moments;     // [kg m^2]
  Vector3d omega_body;  // [rad/s]
  double duration;      // [s]
};

// A stone, a disc, a handle that turns over about its middle axis, and a needle.
const Flight kFlights[] = {{"generic", {1, 2, 3}, {0.3, -0.7, 0.5}, 4.0},
                           {"disc", {1, 1, 2}, {0.4, 0.3, 5}, 1.0},
                           {"turning over", {1, 2, 3}, {0.01, 1, 0.01}, 8.0},
                           {"needle", {1e-3, 1, 1}, {1.0, 0.5, 0.2}, 2.0}};

/// Thrown under gravity: the centre of mass on a parabola, the rotation free.
RigidBodyState start_of(const Flight& flight) {
  const Quaterniond q = Quaterniond(0.9, 0.1, -0.3, 0.3).normalized();
  return {{0, 0, 2}, q, {2, -1, 6}, q * flight.moments.cwiseProduct(flight.omega_body)};
}

RigidBodyState fly(const Step& step, const Flight& flight, int steps) {
  const Inertia inertia = finite_inertia(2.0, flight.moments.asDiagonal());
  const OdeFunction f = [&](double, const VectorXd& y) {
    return rigid_body_derivative(unpack(y), inertia, {Vector3d(0, 0, -2 * 9.81), Vector3d::Zero()});
  };
  RigidBodyState state = start_of(flight);
  const double h = flight.duration / steps;
  for (int i = 0; i < steps; ++i) {
    state = unpack(step(f, i * h, pack(state), h));
    state.world_from_body = renormalize(state.world_from_body);
  }
  return state;
}

/// Angle between the orientation found and the exact one. [rad]
double turn_error(const RigidBodyState& found, const Flight& flight) {
  const Spin exact =
      FreeRotation(flight.moments.asDiagonal())
          .after({start_of(flight).world_from_body, flight.omega_body}, flight.duration);
  return 2 * (found.world_from_body.conjugate() * exact.world_from_body).vec().norm();
}

Vector3d exact_centre(const Flight& flight) {
  const double t = flight.duration;
  return start_of(flight).com_world + Vector3d(1, -0.5, 3) * t +
         0.5 * Vector3d(0, 0, -9.81) * t * t;
}

void expect_order(const Step& step, double order, double tolerance, int first_steps) {
  for (const Flight& flight : kFlights) {
    double coarser = kUnset;
    for (int i = 0; i < 4; ++i) {
      const double error = turn_error(fly(step, flight, first_steps << i), flight);
      if (i > 0) {
        EXPECT_NEAR(std::log2(coarser / error), order, tolerance)
            << flight.name << ", " << (first_steps << i) << " steps, error " << error << " rad";
      }
      coarser = error;
    }
  }
}

// The order read from two steps is off by O(h): steps are as small as 0.05 and 0.1 ask for, and
// errors of 1e-8 rad or more stand well above the 1e-14 of rounding.
TEST(RigidMotion, EulerTurnsABodyWithOrderOne) { expect_order(euler_step, 1.0, 0.05, 4000); }
TEST(RigidMotion, RungeKuttaTurnsABodyWithOrderFour) { expect_order(rk4_step, 4.0, 0.1, 200); }

TEST(RigidMotion, CentreOfMassFollowsItsParabola) {
  for (const Flight& flight : kFlights) {
    // A parabola is within reach of RK4 exactly; Euler lags behind it by g h t / 2.
    EXPECT_LE((fly(rk4_step, flight, 100).com_world - exact_centre(flight)).norm(), 100 * 1e-14)
        << flight.name;
    const double lag = 9.81 * flight.duration / 100 * flight.duration / 2;
    EXPECT_NEAR(fly(euler_step, flight, 100).com_world.z() - exact_centre(flight).z(), lag, 1e-11)
        << flight.name;
  }
}

TEST(RigidMotion, AngularMomentumStaysBitForBitAndEnergyToOrderFour) {
  for (const Flight& flight : kFlights) {
    const Inertia inertia = finite_inertia(2.0, flight.moments.asDiagonal());
    const auto turning = [&](const RigidBodyState& s) {
      return 0.5 * s.angular_momentum_world.dot(omega_of(s, inertia));
    };
    double coarser = kUnset;
    for (const int steps : {200, 400, 800}) {
      const RigidBodyState later = fly(rk4_step, flight, steps);
      EXPECT_EQ(later.angular_momentum_world, start_of(flight).angular_momentum_world)
          << flight.name;
      EXPECT_NEAR(later.world_from_body.norm(), 1.0, 1e-15) << flight.name;
      const double lost = std::abs(turning(later) - turning(start_of(flight)));
      // Falls by 16 at each halving, or faster where the leading term cancels; 12 still tells order
      // 3 off. 1e-13: round-off.
      if (steps > 200) {
        EXPECT_LE(lost, coarser / 12 + 1e-13) << flight.name << ", " << steps << " steps";
      }
      coarser = lost;
    }
  }
}

}  // namespace
}  // namespace tumble::a2
