// Cases other than those of the files, against closed forms: the families are the contract, not the
// files.
#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>

#include "framework/effects/gravity/gravity.h"
#include "framework/truths/memory_scene.h"
#include "tests/truths/made_case.h"
#include "tests/truths/truths.h"

namespace tumble::testing {
namespace {

Laws reference_laws() { return Reference().laws(); }

// t_1 = sqrt(2 h / g), then 2 e^k t_1 between impacts. 1e-12: a thousand roundings of seconds; a
// missing e is wrong by tenths.
TEST(TruthVariations, BouncingBallOfOtherHeightsAndRestitutions) {
  const Laws laws = reference_laws();
  for (const double e : {0.3, 0.65, 0.95}) {
    for (const double h : {0.02, 3.0, 50.0}) {
      const double g = 1.62, first = std::sqrt(2.0 * h / g);
      scene::Scene scene = truths::empty_scene("drop", 4.0 * first, 1e-4);
      effects::set_gravity(scene, Vector3d(0, 0, -g));
      scene.bodies = {truths::ball("ball", 2.5, 0.0, {0, 0, h}, Vector3d::Zero(), e),
                      truths::wall("floor", Vector3d::Zero(), Vector3d::UnitZ(), e)};
      const auto impacts = truths::impacts_of(truths::run_in_memory(scene, laws, 1e-3));
      ASSERT_GE(impacts.size(), 2u);
      EXPECT_NEAR(impacts[0].time, first, 1e-12 * first) << e << ' ' << h;
      EXPECT_NEAR(impacts[1].time, first * (1.0 + 2.0 * e), 1e-12 * first) << e << ' ' << h;
    }
  }
}

// Equal balls pass their velocities on: with e = 1 the last k leave, for any n.
TEST(TruthVariations, CradlesOfOtherNumbers) {
  const Laws laws = reference_laws();
  for (const int n : {2, 3, 7}) {
    for (int moving = 1; moving < n; ++moving) {
      scene::Scene scene = truths::empty_scene("cradle", 0.1, 1e-9);
      for (int i = 0; i < n; ++i)
        scene.bodies.push_back(truths::ball("b" + std::to_string(i), 0.7, 0.5, Vector3d(i, 0, 0),
                                            Vector3d(i < moving ? 2.0 : 0.0, 0, 0), 1.0));
      const Frame end = truths::frame_at(scene, laws, 0.1);
      for (int i = 0; i < n; ++i)
        EXPECT_NEAR(end.poses[static_cast<std::size_t>(i)].velocity_world.x(),
                    i >= n - moving ? 2.0 : 0.0, 1e-13)
            << n << ' ' << moving;
    }
  }
}

// Two balls, any e: v_1 = (1 - e) v / 2, v_2 = (1 + e) v / 2.
TEST(TruthVariations, CradleOfTwoAtOtherRestitutions) {
  const Laws laws = reference_laws();
  for (const double e : {0.0, 0.25, 0.6}) {
    scene::Scene scene = truths::empty_scene("two", 0.1, 1e-9);
    for (int i = 0; i < 2; ++i)
      scene.bodies.push_back(truths::ball("b" + std::to_string(i), 1.0, 0.5, Vector3d(i, 0, 0),
                                          Vector3d(i == 0 ? 3.0 : 0.0, 0, 0), e));
    const Frame end = truths::frame_at(scene, laws, 0.1);
    EXPECT_NEAR(end.poses[0].velocity_world.x(), 1.5 * (1.0 - e), 1e-13) << e;
    EXPECT_NEAR(end.poses[1].velocity_world.x(), 1.5 * (1.0 + e), 1e-13) << e;
  }
}

// h = v t + g t^2 / 2 for a ball thrown down: t = 2 h / (v + sqrt(v^2 + 2 g h)), without
// cancellation.
TEST(TruthVariations, SphereOntoAPlaneFromOtherHeights) {
  const Reference reference;
  for (const double height : {1e-3, 0.4, 30.0, 2000.0}) {
    for (const double v : {0.0, 0.7, 250.0}) {
      const double g = 3.7, R = 0.125, speed = std::sqrt(v * v + 2.0 * g * height),
                   toi = 2.0 * height / (v + speed);
      // Heights are rounded at their own size; the time changes by that over the speed, and the
      // rest with it.
      const double length_floor = 0x1p-53 * (height + 1.0),
                   time_floor = 0x1p-53 * toi + length_floor / speed;
      const Vector3d x0(1, -2, R + height), sideways(0.5, 0, 0), at(1 + 0.5 * toi, -2, R);
      truths::Case truth{"variation", "toi_sphere_plane", "", {}, {}};
      truth.inputs = {
          "inputs",
          truths::Value::Members{{"x0", entry("x0", vector_of(x0))},
                                 {"v0", entry("v0", vector_of(sideways - v * Vector3d::UnitZ()))},
                                 {"R", entry("R", exact_text(R))},
                                 {"g", entry("g", exact_text(g))},
                                 {"n", entry("n", vector_of(Vector3d::UnitZ()))},
                                 {"d", entry("d", "0")}}};
      const std::string velocity = exact_text(0x1p-53 * speed + g * time_floor);
      truth.outputs = {
          "outputs",
          truths::Value::Members{
              {"toi", entry("toi", exact_text(toi), exact_text(time_floor))},
              {"centre_at_toi",
               entry("centre", vector_of(at), exact_text(length_floor + (speed + 1) * time_floor))},
              {"velocity_at_toi",
               entry("velocity", vector_of(sideways - speed * Vector3d::UnitZ()), velocity)},
              {"contact_point", entry("contact", vector_of(at - R * Vector3d::UnitZ()),
                                      exact_text(length_floor + (speed + 1) * time_floor))},
              {"normal_velocity_at_toi", entry("rate", exact_text(-speed), velocity)}}};
      const auto lines = reference.compare(truth);
      EXPECT_EQ(truths::verdict_of(lines), truths::Verdict::kRight)
          << height << ' ' << v << failures(lines);
    }
  }
}

// Errors on halving the step: exact solution y = K / (1 + (K / y0 - 1) exp(-a t)).
TEST(TruthVariations, OrdersOnTheLogisticEquation) {
  const Reference reference;
  const double a = 2.0, b = 0.5, y0 = 0.1, T = 1.5, K = a / b,
               exact = K / (1.0 + (K / y0 - 1.0) * std::exp(-a * T));
  const OdeFunction f = [=](double, const VectorXd& y) {
    return VectorXd(a * y - b * y.cwiseProduct(y));
  };
  const auto order = [&](const auto& step, int steps) {
    double error[2];
    for (int k = 0; k < 2; ++k) {
      VectorXd y = VectorXd::Constant(1, y0);
      const int n = steps << k;
      for (int i = 0; i < n; ++i) y = step(f, i * T / n, y, T / n);
      error[k] = std::abs(y[0] - exact);
    }
    return std::log2(error[0] / error[1]);
  };
  EXPECT_NEAR(order(reference.a2.euler_step, 2000), 1.0, 0.05);
  EXPECT_NEAR(order(reference.a2.rk4_step, 100), 4.0, 0.1);
}

// The same on a free asymmetric top, against RK4 with 16 times smaller steps (their own error is
// 1e-5 of the coarse one's).
TEST(TruthVariations, OrdersOnAFreeTop) {
  const Reference reference;
  const Inertia inertia = finite_inertia(1.0, Vector3d(1, 2, 3).asDiagonal());
  const OdeFunction f = [&](double, const VectorXd& y) {
    return reference.a2.rigid_body_derivative(unpack(y), inertia,
                                              {Vector3d::Zero(), Vector3d::Zero()});
  };
  const RigidBodyState start{Vector3d::Zero(), Quaterniond::Identity(), Vector3d::Zero(),
                             Vector3d(0.3, -1.4, 1.5)};
  const auto march = [&](const auto& step, int n) {
    VectorXd y = pack(start);
    for (int i = 0; i < n; ++i) y = step(f, 2.0 * i / n, y, 2.0 / n);
    return y;
  };
  const auto order = [&](const auto& step, int n, const VectorXd& exact) {
    return std::log2((march(step, n) - exact).norm() / (march(step, 2 * n) - exact).norm());
  };
  const VectorXd exact = march(reference.a2.rk4_step, 3200);
  const double euler = order(reference.a2.euler_step, 4000, exact),
               rk4 = order(reference.a2.rk4_step, 100, exact);
  std::printf("free top: Euler of order %.3f, RK4 of order %.3f\n", euler, rk4);
  EXPECT_NEAR(euler, 1.0, 0.05);
  EXPECT_NEAR(rk4, 4.0, 0.1);
}

}  // namespace
}  // namespace tumble::testing
