// A run is the same again, whatever the order of the bodies, the place, the speed of the frame, the
// scale.
#include <algorithm>
#include <cmath>

#include "framework/dynamics/methods.h"
#include "framework/effects/drag/drag.h"
#include "framework/effects/gravity/gravity.h"
#include "framework/effects/point_force/point_force.h"
#include "framework/effects/spring/spring.h"
#include "tests/engines/scenes.h"
#include "tests/support/story.h"

namespace tumble::testing {
namespace {

/// Two boxes and a ball that meet one after the other, off centre; nothing chaotic.
scene::Scene meeting(double length = 1.0, const Vector3d& shift = Vector3d::Zero(),
                     const Vector3d& drift = Vector3d::Zero()) {
  std::vector<scene::BodySpec> bodies{
      box("long", {0.5, 0.1, 0.1}, 2.0, {0, 0, 0}, {0, 0, 0}),
      box("cube", {0.2, 0.2, 0.2}, 1.0, {0.3, 0.9, 0.05}, {0, -1.5, 0}),
      ball("ball", 0.15, 0.5, {-1.2, 0.1, 0.02}, {1.0, 0, 0})};
  bodies[1].omega_world_rad_s = {0.3, 0.2, 1.0};
  for (scene::BodySpec& body : bodies) {
    body.restitution = 0.7;
    body.position_m = length * body.position_m + shift;
    body.velocity_m_s = length * body.velocity_m_s + drift;
    if (auto* sphere = std::get_if<scene::SphereSpec>(&body.shape)) sphere->radius_m *= length;
    if (auto* solid = std::get_if<scene::BoxSpec>(&body.shape)) solid->half_extents_m *= length;
  }
  auto scene = scene_of(std::move(bodies), 2.0);
  scene.rest_speed_m_s = 1e-3 * length;
  return scene;
}

/// Largest difference of places at the end, after undoing shift, drift and scale. [m at scale 1]
double farthest(const Trajectory& found, const Trajectory& expected, double length = 1.0,
                const Vector3d& shift = Vector3d::Zero(),
                const Vector3d& drift = Vector3d::Zero()) {
  double worst = 0.0;
  for (std::size_t i = 0; i < expected.bodies.size(); ++i) {
    const Vector3d there = (found.frames.back().poses[i].com_world - shift - 2.0 * drift) / length;
    worst = std::max(worst, (there - expected.frames.back().poses[i].com_world).norm());
  }
  return worst;
}

std::string bytes(const Trajectory& run) {
  std::string all;
  const auto add = [&](const auto& value) {
    all.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  for (const Frame& frame : run.frames) {
    add(frame.time);
    for (const BodyPose& pose : frame.poses)
      for (const double x :
           {pose.com_world.x(), pose.com_world.y(), pose.com_world.z(), pose.world_from_body.w(),
            pose.world_from_body.x(), pose.omega_world.z()})
        add(x);
    add(frame.kinetic_energy);
    add(frame.smallest_gap);
  }
  for (const Event& event : run.events) {
    add(event.time);
    add(event.impulse);
  }
  for (const auto& [name, count] : run.counters.counts) add(count);
  return all;
}

TEST(Invariance, TheSameSceneGivesTheSameBytes) {
  EXPECT_EQ(bytes(run(meeting())), bytes(run(meeting())));
}

TEST(Invariance, TheOrderOfBodiesIsOfNoConsequence) {
  const Trajectory expected = run(meeting());
  ASSERT_GE(collision_times(expected).size(), 2u);
  auto turned = meeting();
  std::reverse(turned.bodies.begin(), turned.bodies.end());
  const Trajectory found = run(turned);
  ASSERT_EQ(collision_times(found).size(), collision_times(expected).size());
  // 1e-10 m: roundings of impact points, 1e-13, grown by some collisions' arms and 2 s of turning
  for (int i = 0; i < 3; ++i)
    EXPECT_LT(
        (found.frames.back().poses[2 - i].com_world - expected.frames.back().poses[i].com_world)
            .norm(),
        1e-10);
}

TEST(Invariance, ASteadilyMovingFrameSeesTheSame) {
  const Vector3d drift(3, -2, 1);
  EXPECT_LT(farthest(run(meeting(1.0, Vector3d::Zero(), drift)), run(meeting()), 1.0,
                     Vector3d::Zero(), drift),
            1e-10);
}

TEST(Invariance, LengthsOfMicrometresAndMegametresMoveAlike) {
  const Trajectory expected = run(meeting());
  for (const double length : {1e-6, 1e6})
    EXPECT_LT(farthest(run(meeting(length)), expected, length), 1e-10) << "scale " << length;
}

/// A box that tumbles and falls in a medium, and one that a force pushes beside its centre: the
/// first is integrated with its island, the second alone. Lengths in 2^exponent m, masses in kg
/// times the cube of that.
scene::Scene slowed_and_pushed(int exponent) {
  const double length = std::ldexp(1.0, exponent), mass = std::ldexp(1.0, 3 * exponent);
  std::vector<scene::BodySpec> bodies;
  for (const char* name : {"slowed", "pushed"}) {
    bodies.push_back(box(name, length * Vector3d(0.5, 0.3, 0.2), mass,
                         length * Vector3d(5.0 * static_cast<double>(bodies.size()), 0, 2),
                         length * Vector3d(3, 0, 1)));
    bodies.back().omega_world_rad_s = {3, 2, 5};
    bodies.back().collides = false;
  }
  scene::Scene scene = scene_of(std::move(bodies), 2.0, length * Vector3d(0, 0, -9.81));
  scene.step_s = 0.25;
  scene.rest_speed_m_s = 1e-3 * length;
  scene.effects.of<effects::DragSpec>().push_back(
      {"slowed", 0.5 * mass, 0.1 * mass * length * length});
  scene.effects.of<effects::PointForceSpec>().push_back(
      {"pushed", mass * length * Vector3d(2, 1, 0), length * Vector3d(5.4, 0.2, 2), 0.0, 2.0});
  return scene;
}

// A method that compares numbers with a tolerance, or with 1, is given them in units of the bodies.
// In SI units momenta of 1e-12 kg m/s would be below any tolerance, and the count of evaluations
// would be another.
TEST(Invariance, AToleranceAsksForAsManyStepsInUnitsOfAnySize) {
  for (const char* word : {"dopri5", "fehlberg78", "gauss6"}) {
    Laws laws = test_laws();
    laws.integrate_step = step_of(method_named(word), 1e-7);
    laws.steps_in_units = needs_units(method_named(word));
    const Trajectory expected = run(slowed_and_pushed(0), laws);
    ASSERT_EQ(expected.stopped_by, "") << word;
    const auto evaluations = [](const Trajectory& run) {
      return static_cast<double>(run.counters.counts.at("derivative_evaluations"));
    };
    for (const int exponent : {-10, 10}) {
      const Trajectory found = run(slowed_and_pushed(exponent), laws);
      ASSERT_EQ(found.stopped_by, "") << word << ", 2^" << exponent << " m";
      EXPECT_NEAR(evaluations(found) / evaluations(expected), 1.0, 0.02)
          << word << ", 2^" << exponent << " m";
      // units are powers of two: but for roundings of what is around the steps, the same numbers
      EXPECT_LT(farthest(found, expected, std::ldexp(1.0, exponent)), 1e-9)
          << word << ", 2^" << exponent << " m";
    }
  }
}

/// Two point masses on a spring that fall and turn about each other: all that has a length is the
/// spring. In units as above. @param is_long_at_rest  else it has no length at rest
scene::Scene points_on_a_spring(int exponent, bool is_long_at_rest) {
  const double length = std::ldexp(1.0, exponent), mass = std::ldexp(1.0, 3 * exponent);
  scene::Scene scene = scene_of(
      {ball("a", 0.0, mass, Vector3d::Zero(), length * Vector3d(0, 1, 0)),
       ball("b", 0.0, 2 * mass, length * Vector3d(1, 0, 0.25), length * Vector3d(0, -1, 2))},
      2.0, length * Vector3d(0, 0, -9.81));
  for (scene::BodySpec& body : scene.bodies) body.collides = false;
  scene.step_s = 0.25;
  scene.rest_speed_m_s = 1e-3 * length;
  effects::SpringSpec spring;
  spring.name = "spring";
  spring.a.body = "a";
  spring.b.body = "b";
  spring.stiffness_n_m = 40.0 * mass;
  spring.rest_length_m = is_long_at_rest ? 0.75 * length : 0.0;
  scene.effects.of<effects::SpringSpec>().push_back(spring);
  return scene;
}

// A point mass has no size of its own: with its tolerance in metres, springs of a millimetre would
// be followed by nothing, and those of a kilometre at a thousand times the cost.
TEST(Invariance, AToleranceOfPointMassesIsAPartOfTheirSpring) {
  Laws laws = test_laws();
  laws.integrate_step = step_of(method_named("dopri5"), 1e-7);
  laws.steps_in_units = true;
  laws.spring_force = [](const Spring& spring, const AnchorState& a,
                         const AnchorState& b) -> Vector3d {
    const Vector3d way = b.point_world - a.point_world;
    return spring.stiffness * (1.0 - spring.rest_length / way.norm()) * way;
  };
  const auto run_of = [&](int exponent, bool is_long_at_rest, const char* engine) {
    scene::Scene scene = points_on_a_spring(exponent, is_long_at_rest);
    scene.engine = engine;
    return run(scene, laws);
  };
  const auto evaluations = [](const Trajectory& run) {
    return static_cast<double>(run.counters.counts.at("spring_calls"));
  };
  for (const char* engine : {"rd", "ordered"})
    for (const bool is_long_at_rest : {true, false}) {
      const Trajectory expected = run_of(0, is_long_at_rest, engine);
      ASSERT_EQ(expected.stopped_by, "") << engine;
      for (const int exponent : {-10, 10}) {
        const Trajectory found = run_of(exponent, is_long_at_rest, engine);
        SCOPED_TRACE(std::string(engine) + ", 2^" + std::to_string(exponent) + " m" +
                     (is_long_at_rest ? "" : ", no length at rest"));
        ASSERT_EQ(found.stopped_by, "");
        EXPECT_NEAR(evaluations(found) / evaluations(expected), 1.0, 0.02);
        // but for roundings of what is around the steps, the same numbers
        EXPECT_LT(farthest(found, expected, std::ldexp(1.0, exponent)), 1e-9);
      }
    }
}

// Places that both scenes can hold, or they would differ from the start: a rounding of one
// coordinate of 1e6 m, 6e-11 m, makes 5e-8 m in these 10 s, since each collision that turns an edge
// against an edge makes a difference some thirty times larger.
scene::Scene far_meeting(const Vector3d& shift) {
  auto scene = meeting();
  scene.duration_s = 10.0;
  effects::set_gravity(scene, Vector3d(0, 0.01, -0.02));
  for (scene::BodySpec& body : scene.bodies) {
    for (double& x : body.position_m) x = std::round(std::ldexp(x, 30)) / std::ldexp(1.0, 30);
    body.position_m += shift;
  }
  scene.effects.of<effects::PointForceSpec>() = {
      {"ball", {0.1, 0, 0.05}, scene.bodies[2].position_m, 0.25, 0.5}};
  return scene;
}

TEST(Invariance, AThousandKilometresAwayTheSameHappensToTheRoundingOfThePlace) {
  // m: a rounding of each coordinate of 1e6 m, when it is recorded
  constexpr double kPlace = 3e-10;
  for (const Vector3d& shift :
       {Vector3d(1048576, -1048576, 524288), Vector3d(0, 1e6, 0), Vector3d(1e6 + 0.25, 0, 7)}) {
    const Trajectory far = run(far_meeting(shift)), near = run(far_meeting(Vector3d::Zero()));
    ASSERT_GE(collision_times(near).size(), 4u);
    ASSERT_EQ(far.events.size(), near.events.size());
    for (std::size_t k = 0; k < near.events.size(); ++k) {
      EXPECT_NEAR(far.events[k].time, near.events[k].time, 1e-12);
      EXPECT_LT((far.events[k].point_world - shift - near.events[k].point_world).norm(), kPlace);
      EXPECT_NEAR(far.events[k].impulse, near.events[k].impulse, 1e-11);
    }
    ASSERT_EQ(far.frames.size(), near.frames.size());
    for (std::size_t k = 0; k < near.frames.size(); ++k) {
      for (std::size_t i = 0; i < near.bodies.size(); ++i)
        ASSERT_LT(
            (far.frames[k].poses[i].com_world - shift - near.frames[k].poses[i].com_world).norm(),
            kPlace)
            << near.frames[k].time << " s, body " << i;
      EXPECT_GE(far.frames[k].smallest_gap, 0.0);
    }
    // What is counted from the world's origin is so far off too: 3.5 kg.
    const Frame &f = far.frames.back(), &n = near.frames.back();
    EXPECT_NEAR(f.potential_energy, n.potential_energy - 3.5 * Vector3d(0, 0.01, -0.02).dot(shift),
                1e-8);
    EXPECT_LT((f.angular_momentum_world - n.angular_momentum_world - shift.cross(n.momentum_world))
                  .norm(),
              1e-5);
  }
}

TEST(Counters, SayThatNothingWasPaidForCollisionsWhereNoneCanHappen) {
  auto scene = scene_of(
      {ball("a", 0.1, 1.0, {0, 0, 0}, {1, 0, 0}), ball("b", 0.1, 1.0, {0, 50, 0}, {1, 0, 0})}, 1.0);
  scene.step_s = 1.0 / 64;  // frames at the same instants, to the bit
  const auto counts = run(scene, test_laws(), 64.0).counters.counts;
  for (const char* name : {"candidate_pairs", "root_findings", "gap_evaluations", "rollbacks",
                           "impulses", "undone_integrations", "gravity_calls", "point_force_calls"})
    EXPECT_EQ(counts.at(name), 0u) << name;
  EXPECT_EQ(counts.at("steps"), 64u);
  EXPECT_EQ(counts.at("integrations"), 128u) << "two bodies, 64 steps, one integration each";
}

TEST(Counters, CountWhatACollisionCosts) {
  auto scene = scene_of(
      {ball("a", 0.1, 1.0, {0, 0, 0}, {1, 0, 0}), ball("b", 0.1, 1.0, {1, 0, 0}, {-1, 0, 0})}, 1.0);
  const auto counts = run(scene).counters.counts;
  EXPECT_EQ(counts.at("impulses"), 1u);
  EXPECT_EQ(counts.at("rollbacks"), 1u);
  EXPECT_GE(counts.at("undone_integrations"), 2u)
      << "one step of two bodies, and what finding the time of impact asked for";
  EXPECT_GT(counts.at("gap_evaluations"), 0u);
}

}  // namespace
}  // namespace tumble::testing
