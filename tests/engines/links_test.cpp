// Springs, rods and joints in runs of the engine: order of the method, tensions of chains and of
// light and heavy, energy of a spring.
#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>

#include "tests/support/places.h"
#include "assignments/a2_integration/a2_binding.h"
#include "assignments/a3_constraints/a3_binding.h"
#include "framework/effects/gravity/gravity.h"
#include "framework/effects/spring/spring.h"
#include "framework/engines/run.h"
#include "framework/truths/memory_scene.h"
#include "framework/modules/load.h"
#include "framework/modules/registry.h"

namespace tumble::testing {
namespace {

const Vector3d kGravity(0, 0, -9.81);

struct Modules {
  a2::Module a2;
  a3::Module a3;
  Modules() {
    modules::Registry registry;
    register_assignments(registry);
    const std::filesystem::path built = std::filesystem::path(test::binary_dir()) / "modules";
    a2 = *std::static_pointer_cast<const a2::Module>(
        modules::load_module(registry.find("a2"), built / "a2_reference.so"));
    a3 = *std::static_pointer_cast<const a3::Module>(
        modules::load_module(registry.find("a3"), built / "a3_reference.so"));
  }
  Laws laws() const {
    Laws laws = library_laws();
    a2::bind(a2, laws);
    a3::bind(a3, laws);
    return laws;
  }
};

Laws rk4() { return Modules().laws(); }
Laws euler() {
  const Modules modules;
  Laws laws = modules.laws();
  laws.integrate_step = modules.a2.euler_step;
  return laws;
}

/// Hung up at the origin.
scene::Scene chain(const std::vector<double>& masses, double length, const Vector3d& direction) {
  return truths::straight_chain(masses, length, direction, kGravity);
}

scene::Scene spring(double k) {
  scene::Scene scene = truths::empty_scene("spring", 1.0, 1e-9);
  effects::set_gravity(scene, kGravity);
  scene.bodies = {truths::point_mass("bob", 1.0, Vector3d(1.1, 0, -0.2), Vector3d(0, 0.5, 0))};
  scene.effects.of<effects::SpringSpec>() = {
      {"spring", {"", Vector3d::Zero()}, {"bob", Vector3d::Zero()}, k, 0.4, 1.0}};
  return scene;
}

VectorXd places(const Frame& frame) {
  VectorXd all(3 * static_cast<Eigen::Index>(frame.poses.size()));
  for (std::size_t i = 0; i < frame.poses.size(); ++i)
    all.segment<3>(3 * static_cast<Eigen::Index>(i)) = frame.poses[i].com_world;
  return all;
}

/// log2 of how much the last halving changed less than the one before: steps n, 2 n, 4 n.
double order(const scene::Scene& scene, const Laws& laws, double t, long n) {
  const auto end = [&](long steps) {
    return places(truths::run_in_steps(scene, laws, t, steps, 1).frames.back());
  };
  const VectorXd coarse = end(n), middle = end(2 * n), fine = end(4 * n);
  return std::log2((coarse - middle).norm() / (middle - fine).norm());
}

TEST(Links, Rk4IsOfOrderFourAndEulerOfOrderOne) {
  const scene::Scene on_spring = spring(40.0);
  scene::Scene on_rods = chain({1.0, 0.5, 2.0, 1.0}, 0.5, Vector3d(0.8, 0, -0.6));
  EXPECT_NEAR(order(on_spring, rk4(), 1.0, 200), 4.0, 0.1);
  EXPECT_NEAR(order(on_spring, euler(), 0.5, 8000), 1.0, 0.05);
  for (const auto kind :
       {scene::StabilisationKind::kProjection, scene::StabilisationKind::kBaumgarte}) {
    on_rods.stabilisation->kind = kind;
    EXPECT_NEAR(order(on_rods, rk4(), 0.5, 100), 4.0, 0.1);
    EXPECT_NEAR(order(on_rods, euler(), 0.25, 2000), 1.0, 0.05);
  }
}

// A light bob between the ceiling and a heavy one, and the other way round: both rods carry what
// hangs on them, to 1e-8.
TEST(Links, TensionsOfMassesAMillionTimesApart) {
  const double g = -kGravity.z();
  for (const auto& masses : {std::vector<double>{1.0, 1e6}, std::vector<double>{1e6, 1.0},
                             std::vector<double>{1e-6, 1.0, 1e-6, 1.0}}) {
    const Trajectory run =
        truths::run_in_steps(chain(masses, 0.7, -Vector3d::UnitZ()), rk4(), 0.5, 50, 5);
    for (const Frame& frame : run.frames) {
      double hanging = 0.0;
      for (std::size_t i = masses.size(); i-- > 0;) {
        hanging += masses[i] * g;
        EXPECT_NEAR(frame.rod_tensions[i], hanging, 1e-8 * hanging)
            << masses.front() << ' ' << i << " t = " << frame.time;
      }
    }
  }
}

// The top rod of a hundred carries n m g, to 1e-10; nothing moves.
TEST(Links, ChainOfAHundredHangs) {
  const int n = 100;
  const Trajectory run = truths::run_in_steps(
      chain(std::vector<double>(n, 0.5), 0.1, -Vector3d::UnitZ()), rk4(), 1.0, 60, 6);
  const double whole = n * 0.5 * -kGravity.z();
  for (const Frame& frame : run.frames) {
    EXPECT_NEAR(frame.rod_tensions[0], whole, 1e-10 * whole);
    EXPECT_NEAR(frame.poses[n - 1].com_world.z(), -0.1 * n, 1e-12);
  }
}

// RK4 turns y' = i w y by a number of square 1 - (w h)^6 / 72 + (w h)^8 / 576: so much energy goes
// in every step.
TEST(Links, EnergyOfAnUndampedSpringFallsByTheErrorOfRk4) {
  const double k = 100.0, w = 10.0;
  for (const long steps : {200L, 400L, 800L}) {
    scene::Scene scene = truths::empty_scene("spring", 1.0, 1e-9);
    scene.bodies = {truths::point_mass("bob", 1.0, Vector3d(0.3, 0, 0), Vector3d::Zero())};
    scene.effects.of<effects::SpringSpec>() = {
        {"spring", {"", Vector3d::Zero()}, {"bob", Vector3d::Zero()}, k, 0.0, 0.0}};
    const double t = 2.0, z = w * t / static_cast<double>(steps),
                 factor = -std::pow(z, 6) / 72 + std::pow(z, 8) / 576;
    const Frame end = truths::run_in_steps(scene, rk4(), t, steps, 1).frames.back();
    const double energy = 0.5 * k * 0.09,
                 expected = energy * std::expm1(static_cast<double>(steps) * std::log1p(factor));
    // A rounding a step: 1e-12 of the energy at most. Half of the loss being something else would
    // be seen at every step size.
    EXPECT_NEAR(end.kinetic_energy + end.potential_energy - energy, expected,
                1e-12 * energy + 1e-6 * std::abs(expected))
        << steps;
  }
}

}  // namespace
}  // namespace tumble::testing
