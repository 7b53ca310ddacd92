// Impacts on trees and loops of linked bodies that are drawn at random: what must hold whatever is
// struck where.
#include <cmath>
#include <numbers>
#include <string>

#include <gtest/gtest.h>

#include "framework/core/random.h"
#include "framework/effects/joint/joint.h"
#include "framework/effects/rod/rod.h"
#include "tests/engines/linked_impacts.h"

namespace tumble::testing::linked_impacts {
namespace {

Vector3d direction(Random& random) {
  const double z = random.between(-1, 1), angle = random.between(0, 2 * std::numbers::pi),
               r = std::sqrt(1 - z * z);
  return {r * std::cos(angle), r * std::sin(angle), z};
}

/// A tree of balls and boxes linked by rods and joints of all kinds, hung from the world or free;
/// the last body is a ball that touches one of them. With `loop` some links are there twice, and
/// one more closes a ring.
scene::Scene random_tree(Random& random, bool is_free, bool loop, double e, double friction) {
  const int n = 2 + static_cast<int>(random.below(6));
  std::vector<scene::BodySpec> bodies;
  std::vector<Vector3d> places;
  for (int i = 0; i < n; ++i) {
    places.push_back(i == 0 ? Vector3d(0, 0, -1)
                            : Vector3d(places[random.below(static_cast<std::uint64_t>(i))] +
                                       1.5 * direction(random)));
    const double mass = std::exp(random.between(-2, 2));
    const std::string name = "b" + std::to_string(i);
    if (random.unit() < 0.5)
      bodies.push_back(ball(name, 0.2, mass, places.back(), Vector3d::Zero()));
    else
      bodies.push_back(box(name, {0.1, 0.2, 0.3}, mass, places.back(), Vector3d::Zero()));
    bodies.back().world_from_body =
        Quaterniond(Eigen::AngleAxisd(random.between(0, 3), direction(random)));
  }
  const int struck = static_cast<int>(random.below(static_cast<std::uint64_t>(n)));
  // Where the ball touches: the end of the body in some direction.
  const Vector3d way = direction(random);
  const scene::BodySpec& body = bodies[static_cast<std::size_t>(struck)];
  Vector3d surface = 0.2 * way;
  if (std::holds_alternative<scene::BoxSpec>(body.shape))
    surface = body.world_from_body *
              Vector3d(0.1, random.between(-0.19, 0.19), random.between(-0.29, 0.29));
  const Vector3d out = std::holds_alternative<scene::BoxSpec>(body.shape)
                           ? Vector3d(body.world_from_body * Vector3d::UnitX())
                           : way;
  bodies.push_back(ball("ball", 0.15, std::exp(random.between(-2, 2)),
                        body.position_m + surface + 0.15 * out, Vector3d::Zero()));
  scene::Scene scene = linked_scene(bodies, e, friction);
  const auto link = [&](const std::string& a, const std::string& b, const Vector3d& at,
                        const Vector3d& from) {
    const std::string name = "l" + std::to_string(scene.effects.of<effects::RodSpec>().size() +
                                                  scene.effects.of<effects::JointSpec>().size());
    const double kind = random.unit();
    if (kind < 0.3)
      scene.effects.of<effects::RodSpec>().push_back(
          {name,
           {a, Vector3d::Zero()},
           {b, b.empty() ? from : Vector3d(Vector3d::Zero())},
           (at - from).norm()});
    else
      scene.effects.of<effects::JointSpec>().push_back({name,
                                                        kind < 0.55   ? effects::JointKind::kHinge
                                                        : kind < 0.85 ? effects::JointKind::kBall
                                                                      : effects::JointKind::kWeld,
                                                        a, b, 0.5 * (at + from),
                                                        direction(random)});
  };
  for (int i = 1; i < n; ++i) {
    int nearest = 0;  // the one it was set beside
    for (int k = 0; k < i; ++k)
      if (std::abs(
              (places[static_cast<std::size_t>(i)] - places[static_cast<std::size_t>(k)]).norm() -
              1.5) < 1e-9)
        nearest = k;
    link("b" + std::to_string(i), "b" + std::to_string(nearest),
         places[static_cast<std::size_t>(i)], places[static_cast<std::size_t>(nearest)]);
  }
  if (!is_free) link("b0", "", places[0], Vector3d(0.1, 0, 0));
  if (loop && n > 2) {
    link("b" + std::to_string(n - 1), "b0", places.back(), places[0]);
    if (!scene.effects.of<effects::JointSpec>().empty()) {
      // the same twice: its rows are redundant
      scene.effects.of<effects::JointSpec>().push_back(
          scene.effects.of<effects::JointSpec>().front());
      scene.effects.of<effects::JointSpec>().back().name = "again";
    }
  }
  return scene;
}

// Momentum along what is free, energy at e = 1 without friction and never more, u_n' = -e u_n, and
// rods and joints that hold: whatever is struck where. Also of loops, whose rows are redundant.
TEST(ImpactsOnLinks, KeepTheirLawsInTreesAndLoopsDrawnAtRandom) {
  Random random(11);
  int struck = 0;
  for (int trial = 0; trial < 600; ++trial) {
    const bool is_free = trial % 2 == 0, loop = trial % 3 == 0;
    const double e = trial % 4 == 0 ? 1.0 : random.unit(),
                 friction = trial % 5 < 2 ? 0.0 : random.between(0, 1.5);
    scene::Scene scene = random_tree(random, is_free, loop, e, friction);
    scene.contact = scene::ContactSpec{};
    if (trial % 7 == 0) scene.contact->impact_law = scene::ImpactLaw::kSimultaneous;
    OneImpact impact(scene);
    const int last = impact.moving.size() - 1;
    int touched = -1;
    for (int i = 0; i < last; ++i)
      if (std::abs(impact.meetings.gap({i, last}).distance) < 1e-12) touched = i;
    if (touched < 0) continue;
    // Random velocities that the links allow.
    for (int i = 0; i <= last; ++i)
      impact.set_velocity(i, direction(random),
                          i == last ? direction(random) : random.between(0, 1) * direction(random));
    std::vector<RigidBodyState> states = impact.moving.states();
    for (engines::LinkedBodies& group : impact.moving.linked_groups())
      group.project_velocities(states, 0.0);
    impact.moving.stand_at(0.0, states);
    const Vector3d n = impact.meetings.gap({touched, last}).normal_b_to_a_world;
    impact.set_velocity(last, 3.0 * n + 0.5 * direction(random), direction(random));

    const double before = impact.kinetic_energy();
    const auto [P, L] = impact.momenta();
    const double open = impact.largest_rate();
    const engines::Resolution result = impact.strike(touched, last);
    ASSERT_TRUE(result.settled) << trial;
    if (result.events.empty()) continue;
    ++struck;
    const Event& event = result.events.front();
    // masses 1 : 55 and rings of seven bodies take some digits
    const double size = std::sqrt(2 * before) + 3.0, tolerance = 1e-10 * size;
    EXPECT_EQ(result.events.size(), 1u) << trial;
    EXPECT_NEAR(event.normal_velocity_after, -e * event.normal_velocity_before, tolerance)
        << trial << " law " << (trial % 7 == 0);
    EXPECT_LT(impact.largest_rate(), open + tolerance) << trial;
    EXPECT_LE(impact.kinetic_energy(), before * (1 + 1e-10)) << trial;
    if (e == 1.0 && friction == 0.0) {
      EXPECT_NEAR(impact.kinetic_energy(), before, 1e-10 * before) << trial;
    }
    EXPECT_LE(event.energy_excess, 1e-10) << trial;
    EXPECT_NEAR(event.energy_change, impact.kinetic_energy() - before, 1e-10 * before) << trial;
    if (!is_free) continue;
    const auto [P_after, L_after] = impact.momenta();
    EXPECT_LT((P_after - P).norm(), 1e-10 * (P.norm() + size)) << trial;
    EXPECT_LT((L_after - L).norm(), 1e-10 * (L.norm() + 10 * size)) << trial;
  }
  EXPECT_GT(struck, 400);
}

}  // namespace
}  // namespace tumble::testing::linked_impacts
