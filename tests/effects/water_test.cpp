// Water: what floats, bobs, rolls, capsizes and is carried, against closed forms.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "tests/support/places.h"
#include "framework/core/error.h"
#include "framework/effects/build_world.h"
#include "framework/effects/invariants.h"
#include "framework/effects/registry.h"
#include "framework/effects/water/water.h"
#include "framework/cost/cost.h"
#include "framework/engines/stepping/stability.h"
#include "framework/engines/timewarp/fast_timewarp.h"
#include "framework/scene/load_scene.h"
#include "tests/engines/scenes.h"

namespace tumble::testing {
namespace {

constexpr double kG = 9.81, kWater = 1000.0;
const Vector3d kDown(0, 0, -kG);

/// Bodies in water whose level is z = 0.
scene::Scene in_water(std::vector<scene::BodySpec> bodies, double duration, double drag = 0.0,
                      const Vector3d& stream = Vector3d::Zero()) {
  scene::Scene scene = scene_of(std::move(bodies), duration, kDown);
  scene.step_s = 1.0 / 600.0;
  effects::WaterSpec water;
  water.drag_1_s = drag;
  water.stream_m_s = stream;
  scene.effects.of<effects::WaterSpec>() = {water};
  return scene;
}

scene::BodySpec floating_box(const Vector3d& size, double density, double z) {
  return box("box", 0.5 * size, density * size.prod(), {0, 0, z}, Vector3d::Zero());
}

Quaterniond tilted(double angle) {
  return Quaterniond(Eigen::AngleAxisd(angle, Vector3d::UnitY()));
}
double tilt_of(const BodyPose& pose) {
  return std::acos(std::clamp((pose.world_from_body * Vector3d::UnitZ()).z(), -1.0, 1.0));
}

Trajectory run_by(const std::string& engine, const scene::Scene& scene) {
  engines::RunOptions options;
  options.engine = engine;
  options.timewarp = engines::fast_timewarp();
  TrajectoryRecorder recorder;
  engines::run_scene(scene, test_laws(), options, recorder);
  return recorder.trajectory();
}

TEST(Water, ABoxLiesAsDeepAsItsDensitySays) {
  // Draught 0.6 * 0.3 m: there nothing moves it but roundings of its weight, eps g t^2 / 2.
  const Trajectory result =
      run(in_water({floating_box({1.0, 0.8, 0.3}, 600.0, 0.5 * 0.3 - 0.18)}, 2.0));
  for (const Frame& frame : result.frames) EXPECT_NEAR(frame.poses[0].com_world.z(), -0.03, 1e-13);
  EXPECT_GT(result.counters.counts.at("water_calls"), 0u);
}

TEST(Water, ABoxBobsWithThePeriodOfItsDraught) {
  // m z'' = -rho g A (z - z0) as long as a part of it is under water and not all: exactly harmonic,
  // w^2 = g / draught. RK4 lags by (w h)^4 / 120 of the phase: 1e-8 of it, 0.02 m * 2 pi * 1e-8 in
  // all. A draught that is off by a thousandth shifts the phase by 3e-3.
  const double draught = 0.18, amplitude = 0.02, omega = std::sqrt(kG / draught);
  const Trajectory result =
      run(in_water({floating_box({1.0, 0.8, 0.3}, 600.0, -0.03 + amplitude)}, 2.0));
  for (const Frame& frame : result.frames)
    EXPECT_NEAR(frame.poses[0].com_world.z(), -0.03 + amplitude * std::cos(omega * frame.time),
                1e-8)
        << frame.time;
}

TEST(Water, ABoxRollsWithThePeriodOfItsMetacentre) {
  // I phi'' = -m g GM phi,  GM = T/2 + b^2 / (12 T) - h/2. To amplitudes of 1e-3 rad: the next term
  // is of the order of its square.
  const double b = 1.0, h = 0.2, T = 0.1, metacentre = T / 2 + b * b / (12 * T) - h / 2,
               omega = std::sqrt(12 * kG * metacentre / (b * b + h * h)), amplitude = 1e-3;
  scene::BodySpec box = floating_box({b, 0.7, h}, 500.0, 0.5 * h - T);
  box.world_from_body = tilted(amplitude);
  const double period = 2 * std::numbers::pi / omega;
  scene::Scene scene = in_water({box}, period);
  const Trajectory result = run(scene, test_laws(), 4.0 / period);  // frames at quarters
  ASSERT_EQ(result.frames.size(), 5u);
  const double expected[] = {amplitude, 0.0, amplitude, 0.0, amplitude};
  for (int k = 0; k < 5; ++k)
    EXPECT_NEAR(tilt_of(result.frames[static_cast<std::size_t>(k)].poses[0]), expected[k],
                1e-5 * amplitude + 1e-8)
        << k;
}

TEST(Water, ATallBoxCapsizesAndAFlatOneComesBack) {
  // GM of the tall one: 0.5/2 + 0.2^2 / (12 * 0.5) - 0.5 = -0.24 m.
  scene::BodySpec tall = floating_box({0.2, 0.2, 1.0}, 500.0, 0.0);
  tall.world_from_body = tilted(0.01);
  EXPECT_GT(tilt_of(run(in_water({tall}, 15.0, 1.0)).frames.back().poses[0]), 1.4);
  scene::BodySpec flat = floating_box({1.0, 1.0, 0.2}, 500.0, 0.0);
  flat.world_from_body = tilted(0.5);
  EXPECT_LT(tilt_of(run(in_water({flat}, 15.0, 1.0)).frames.back().poses[0]), 1e-3);
}

TEST(Water, ABallOfHalfTheDensityBobsAboutItsMiddle) {
  // k = rho g pi R^2; the cap adds a third power: to an amplitude of 1e-3 R.
  const double R = 0.25, mass = 0.5 * kWater * 4 / 3 * std::numbers::pi * R * R * R,
               omega = std::sqrt(kWater * kG * std::numbers::pi * R * R / mass),
               amplitude = 1e-3 * R;
  const Trajectory result =
      run(in_water({ball("ball", R, mass, {0, 0, amplitude}, Vector3d::Zero())}, 2.0));
  for (const Frame& frame : result.frames)
    EXPECT_NEAR(frame.poses[0].com_world.z(), amplitude * std::cos(omega * frame.time),
                1e-5 * amplitude)
        << frame.time;
}

TEST(Water, AStreamCarriesWithItsOwnVelocityInTheEnd) {
  // A body as dense as water, all of it under the level: v = u (1 - exp(-k t)). RK4 is off by (k
  // h)^4 / 120 k t u = 1e-11 m/s at most.
  const double k = 2.0;
  const Vector3d u(0.5, 0.2, 0);
  const Trajectory deep = run(in_water({floating_box({0.6, 0.6, 0.2}, kWater, -3.0)}, 6.0, k, u));
  for (const Frame& frame : deep.frames)
    EXPECT_LE((frame.poses[0].velocity_world - u * (1 - std::exp(-k * frame.time))).norm(), 1e-10)
        << frame.time;
  // the stream brings energy in, and the run's watch knows it
  EXPECT_EQ(deep.counters.faults.size(), 0u);
  // One that floats is pulled below its centre of mass and rolls a little: that dies away as exp(-k
  // t), at 6 s to 6e-6.
  const Trajectory afloat =
      run(in_water({floating_box({0.6, 0.6, 0.2}, 700.0, 0.1 - 0.14)}, 6.0, k, u));
  EXPECT_LE((afloat.frames.back().poses[0].velocity_world - u).norm(), 1e-4);
  EXPECT_EQ(afloat.counters.faults.size(), 0u);
}

// The force is what the energy falls by, the torque likewise: of a model cut anywhere.
/// How deep the lowest point of a box or a ball lies after `time`, that began at the level with this
/// speed: m s'' = m g - rho (g + k s') V(s), by RK4 with a thousandth of the time that it needs for
/// its height.
template <class Volume>
double depth_after(double time, double speed, double mass, double height, double drag,
                   const Volume& under) {
  using State = std::array<double, 2>;
  const auto rate = [&](const State& y) -> State {
    return {y[1], kG - kWater * (kG + drag * y[1]) * under(std::clamp(y[0], 0.0, height)) / mass};
  };
  const auto ahead = [](const State& y, double h, const State& f) -> State {
    return {y[0] + h * f[0], y[1] + h * f[1]};
  };
  const long steps = std::lround(std::ceil(time * speed / height * 1000.0));
  const double h = time / static_cast<double>(steps);
  State y{0.0, speed};
  for (long i = 0; i < steps; ++i) {
    const State a = rate(y), b = rate(ahead(y, 0.5 * h, a)), c = rate(ahead(y, 0.5 * h, b)),
                d = rate(ahead(y, h, c));
    for (std::size_t k = 0; k < 2; ++k) y[k] += h / 6.0 * (a[k] + 2.0 * (b[k] + c[k]) + d[k]);
  }
  return y[0];
}

// A step of 1/60 s passes over the whole body at these speeds, some of them ten times: what drag
// and buoyancy take while the level cuts it must not depend on where the steps fall.
TEST(Water, WhatEntersItFastIsBrakedByWhatIsUnder) {
  std::mt19937_64 lot(7);
  const auto between = [&](double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(lot);
  };
  for (int i = 0; i < 40; ++i) {
    const bool is_ball = i % 2 == 0;
    const double height = std::pow(10.0, between(-2.0, -0.3)), drag = between(0.0, 30.0),
                 density = kWater * between(0.3, 3.0), speed = between(2.0, 40.0),
                 above = between(0.0, 1.5), radius = 0.5 * height;
    const auto under = [&](double s) {
      return is_ball ? std::numbers::pi * s * s * (radius - s / 3.0) : s;
    };
    const double mass = density * under(height);
    // it falls to the level first
    const double start_speed = std::sqrt(speed * speed + 2.0 * kG * above),
                 falls = (start_speed - speed) / kG, duration = falls + 0.25;
    const double z = above + radius;
    scene::Scene scene =
        in_water({is_ball ? ball("body", radius, mass, {0, 0, z}, {0, 0, -speed})
                          : box("body", {0.5, 0.5, radius}, mass, {0, 0, z}, {0, 0, -speed})},
                 duration, drag);
    scene.step_s = 1.0 / 60.0;
    const double depth = depth_after(0.25, start_speed, mass, height, drag, under);
    for (const char* engine : {"rd", "tw"}) {
      const Trajectory result = run_by(engine, scene);
      const double reached = radius - result.frames.back().poses[0].com_world.z();
      // where steps pass over the level, up to a quarter
      EXPECT_NEAR(reached, depth, 5e-4 * (std::abs(depth) + height))
          << engine << ", lot " << i << (is_ball ? ": ball" : ": box") << " of " << height
          << " m at " << start_speed << " m/s, drag " << drag << ", density " << density;
    }
  }
}

TEST(Water, ForceAndTorqueAreTheSlopeOfTheEnergy) {
  scene::BodySpec gear = floating_box({1, 1, 1}, 500.0, 0.0);
  gear.shape = scene::ModelSpec{"gear.3ds", "", 0.3};
  gear.world_from_body = Quaterniond(0.8, 0.3, -0.4, 0.33).normalized();
  scene::Scene scene = in_water({gear}, 1.0);
  scene.file = test::source_dir() + "/assignments/a1_impulse/scenes/none.json";
  const World world = build_world(scene);
  const auto energy = [&](const Vector3d& moved, const Vector3d& turned) {
    RigidBodyState state = world.bodies[0].state;
    state.com_world += moved;
    if (turned.norm() > 0)
      state.world_from_body = Quaterniond(Eigen::AngleAxisd(turned.norm(), turned.normalized())) *
                              state.world_from_body;
    effects::EnergySum sum;
    for (const effects::Effect* effect : effects::all())
      if (effect->name() == "water") effect->add_potential_energy(world, {state}, sum);
    return sum.whole();
  };
  const RigidBodyState& state = world.bodies[0].state;
  // m, rad: a difference quotient over it is off by its square over the size
  const double way = 1e-5;
  const effects::Floating& floating = world.effects.of<effects::Floating>()[0];
  const Matrix3d R = state.world_from_body.toRotationMatrix();
  const effects::Submerged under =
      floating.solid.under(R.transpose() * Vector3d::UnitZ(), -state.com_world.z());
  ASSERT_GT(under.volume, 0.1 * floating.solid.whole().volume);
  ASSERT_LT(under.volume, 0.9 * floating.solid.whole().volume);
  const Vector3d force = kWater * kG * under.volume * Vector3d::UnitZ(),
                 torque = kWater * kG * (R * under.first).cross(Vector3d::UnitZ());
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3d e = Vector3d::Unit(axis);
    EXPECT_NEAR(
        (energy(-way * e, Vector3d::Zero()) - energy(way * e, Vector3d::Zero())) / (2 * way),
        force[axis], 1e-5 * force.norm());
    EXPECT_NEAR(
        (energy(Vector3d::Zero(), -way * e) - energy(Vector3d::Zero(), way * e)) / (2 * way),
        torque[axis], 1e-5 * force.norm());
  }
}

TEST(Water, EnergyIsKeptWithoutDrag) {
  // A tall box falls over and pitches about: its corners cross the level, where the force has a
  // kink in its third derivative.
  scene::BodySpec tall = floating_box({0.2, 0.3, 1.0}, 500.0, 0.05);
  tall.world_from_body = tilted(0.2);
  const Trajectory result = run(in_water({tall}, 4.0));
  const auto total = [](const Frame& frame) {
    return frame.kinetic_energy + frame.potential_energy;
  };
  double fastest = 0.0;
  for (const Frame& frame : result.frames) fastest = std::max(fastest, frame.kinetic_energy);
  ASSERT_GT(fastest, 1.0);
  for (const Frame& frame : result.frames)
    EXPECT_NEAR(total(frame), total(result.frames.front()), 1e-6 * fastest) << frame.time;
}

TEST(Water, WhatRisesFromTheDeepIsNoRunaway) {
  const Trajectory result =
      run(in_water({ball("cork", 0.1, 0.4, {0, 0, -8}, Vector3d::Zero())}, 3.0));
  EXPECT_EQ(result.stopped_by, "");
  EXPECT_EQ(result.counters.faults.size(), 0u);
  EXPECT_GT(result.frames.back().poses[0].com_world.z(), 1.0);  // it leaps
}

TEST(Water, EventEnginesFollowItAlike) {
  scene::BodySpec tilted_box = floating_box({0.6, 0.5, 0.2}, 600.0, 0.1),
                  stone = ball("stone", 0.1, 8.0, {0.1, 0, 0.8}, Vector3d::Zero());
  tilted_box.world_from_body = tilted(0.3);
  tilted_box.restitution = stone.restitution = 0.5;
  scene::Scene scene = in_water({tilted_box, stone}, 1.0, 1.0, {0.3, 0, 0});
  const Trajectory ordered = run_by("ordered", scene), rd = run_by("rd", scene);
  ASSERT_FALSE(ordered.events.empty());  // the stone hits the box
  for (const char* engine : {"ca", "tw"}) {
    const Trajectory other = run_by(engine, scene);
    ASSERT_EQ(other.frames.size(), ordered.frames.size());
    for (std::size_t k = 0; k < other.frames.size(); ++k)
      for (std::size_t i = 0; i < 2; ++i)
        EXPECT_EQ(other.frames[k].poses[i].com_world, ordered.frames[k].poses[i].com_world)
            << engine << " " << other.frames[k].time;
  }
  for (std::size_t i = 0; i < 2; ++i)
    EXPECT_LE(
        (rd.frames.back().poses[i].com_world - ordered.frames.back().poses[i].com_world).norm(),
        1e-6);
}

// w^2 = rho g A / m, of what starts above the water, too; drag damps it by rho drag V / m.
TEST(Water, HowFastABodyBobsIsKnownWhereTheRunStarts) {
  constexpr double kDensity = 500.0, kThickness = 4e-4, kDrag = 1.5;
  const double frequency = std::sqrt(kWater * kG / (kDensity * kThickness));
  for (const double z : {0.0, 1.0}) {
    const World plate = build_world(in_water({floating_box({2, 2, kThickness}, kDensity, z)}, 1.0));
    const auto swing = engines::judge_springs(plate, test_laws(), 1.0 / 60);
    ASSERT_TRUE(swing) << z;
    // The thickness comes from the least of three eigenvalues, a 10^7th of the others, each right
    // to rounding of the largest's root.
    EXPECT_NEAR(swing->angular_frequency / frequency, 1.0, 1e-4) << z;
    EXPECT_EQ(swing->damping, 0.0) << z;
    EXPECT_GT(swing->amplification, 1.0) << "w h = 3.7 is beyond Runge-Kutta's 2.83";
  }
  const World damped =
      build_world(in_water({floating_box({1, 1, 0.2}, kDensity, 0.0)}, 1.0, kDrag));
  const auto swing = engines::judge_springs(damped, test_laws(), 1.0 / 60);
  ASSERT_TRUE(swing);
  EXPECT_NEAR(swing->damping, 0.5 * kWater / kDensity * kDrag, 1e-9);
  EXPECT_NE(swing->last_remedy.find("larger"), std::string::npos) << swing->last_remedy;
}

TEST(Water, ItsLevelMovesWithTheOriginOfTheRun) {
  scene::BodySpec box = floating_box({1.0, 0.8, 0.3}, 600.0, 0.0);
  // a body alone that does not move is not seen from an origin of its own
  box.velocity_m_s = {0.1, 0, 0};
  scene::Scene here = in_water({box}, 1.0), there = here;
  there.bodies[0].position_m.z() += 1e6;
  there.effects.of<effects::WaterSpec>()[0].surface_m.z() += 1e6;
  const Trajectory a = run(here), b = run(there);
  // Places are rounded to 1e-10 m where they are recorded.
  for (std::size_t k = 0; k < a.frames.size(); ++k)
    EXPECT_NEAR(b.frames[k].poses[0].com_world.z() - 1e6, a.frames[k].poses[0].com_world.z(),
                2e-10);
}

TEST(Water, GoesInNoClosedFormAndIsAbsentWhereNobodyAsks) {
  scene::Scene wet = in_water({ball("ball", 0.1, 1.0, Vector3d::Zero(), Vector3d::Zero())}, 0.1),
               dry = wet;
  dry.effects.of<effects::WaterSpec>().clear();
  EXPECT_FALSE(cost::goes_in_closed_form(wet));
  EXPECT_TRUE(cost::goes_in_closed_form(dry));
  EXPECT_TRUE(build_world(dry).effects.of<effects::Floating>().empty());
  EXPECT_EQ(run(dry).counters.counts.at("water_calls"), 0u);
}

scene::Scene said(const std::string& water, const std::string& gravity) {
  return scene::parse_scene(
      R"({ "title": "t", "duration_s": 1, "gravity_m_s2": )" + gravity + R"(, "water": )" + water +
          R"(, "bodies": [{ "name": "b", "shape": { "sphere": { "radius_m": 0.1 } },
            "mass_kg": 1 }] })",
      "s.json");
}

TEST(Water, IsReadAndRefusedByItsPlace) {
  const scene::Scene scene =
      said(R"({ "level_m": 2, "drag_1_s": 1, "stream_m_s": [1, 0, 0] })", "[0, 0, -9.81]");
  const effects::WaterSpec& water = scene.effects.of<effects::WaterSpec>().at(0);
  EXPECT_EQ(water.surface_m.z(), 2.0);
  EXPECT_EQ(water.density_kg_m3, 1000.0);
  const auto refused = [](const std::string& words, const std::string& gravity) -> std::string {
    try {
      build_world(said(words, gravity));
    } catch (const UserError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(refused(R"({ "stream_m_s": [1, 0, 0] })", "[0, 0, -9.81]").find("/water/stream_m_s"),
            std::string::npos);
  EXPECT_NE(refused(R"({ "drag_1_s": 1, "stream_m_s": [0, 0, 1] })", "[0, 0, -9.81]")
                .find("through its own level"),
            std::string::npos);
  EXPECT_NE(refused("{}", "[0, -9.81, 0]").find("/water"), std::string::npos);
  EXPECT_NE(refused(R"({ "levl_m": 1 })", "[0, 0, -9.81]").find("Did you mean 'level_m'"),
            std::string::npos);
}

}  // namespace
}  // namespace tumble::testing
