// Impacts on bodies that rods and joints hold: the reactions of all constraints act within the
// impact. Closed forms, in all engines and under all impact laws.
#include <cmath>
#include <numbers>
#include <string>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "framework/core/decompositions.h"
#include "framework/dynamics/solve_contacts.h"
#include "framework/effects/joint/joint.h"
#include "framework/effects/rod/rod.h"
#include "framework/engines/judging/judge.h"
#include "tests/engines/linked_impacts.h"

namespace tumble::testing::linked_impacts {
namespace {

// Closed forms of numbers of the size of 1: some hundred roundings, of the impact and of the ten
// steps about it.
constexpr double kRounding = 1e-12;

/// Runs it by every engine under every law. @param needs_contact  whether what does not bounce goes
/// on pressing: without contact it would meet again and again
template <class Look>
void in_all_engines(const scene::Scene& scene, const Look& look, bool needs_contact = false) {
  for (const auto& [law, asked] : under_all_laws(scene))
    for (const std::string& engine : kEngines) {
      if (needs_contact && !asked.contact) continue;
      SCOPED_TRACE(std::string(engine) + ", " + law);
      const Trajectory run = run_by(engine, asked, {}, 1000.0, laws());
      EXPECT_EQ(run.stopped_by, "");
      ASSERT_FALSE(run.events.empty());
      for (const engines::CheckResult& check : engines::judge_run(asked, run))
        EXPECT_TRUE(check.passed) << check.kind << ": " << check.detail;
      look(run);
    }
}

const Event& first_collision(const Trajectory& run) {
  for (const Event& event : run.events)
    if (event.kind == EventKind::kCollision) return event;
  throw std::runtime_error("no collision");
}

constexpr double kSoon = 0.005;  // s to the impact

// A bob on a rod from the origin, struck at an angle from the rod: across it the bob is free, along
// it the rod holds it. K = 1/m + sin^2 / M.
TEST(ImpactsOnLinks, ABobOnARodYieldsAcrossItOnly) {
  const double m = 1.0, M = 1.0, v = 2.0, r = 0.1;
  for (const double degrees : {5.0, 45.0, 70.0, 90.0, 180.0})
    for (const double e : {1.0, 0.5, 0.0}) {
      const double angle = degrees * std::numbers::pi / 180;
      const Vector3d way(std::sin(angle), 0, std::cos(angle));  // of the ball, to the bob
      scene::Scene scene = linked_scene(
          {ball("bob", r, M, {0, 0, -1}, Vector3d::Zero()),
           ball("ball", r, m, Vector3d(0, 0, -1) - (2 * r + kSoon * v) * way, v * way)},
          e);
      scene.effects.of<effects::RodSpec>().push_back(
          {"rod", {"bob", Vector3d::Zero()}, {"", Vector3d::Zero()}, 1.0});
      const double K = 1 / m + way.x() * way.x() / M, j = (1 + e) * v / K;
      in_all_engines(scene, [&](const Trajectory& run) {
        const Event& event = first_collision(run);
        EXPECT_NEAR(event.impulse, j, kRounding) << degrees << ' ' << e;
        EXPECT_NEAR(event.normal_velocity_after, -e * event.normal_velocity_before, kRounding)
            << degrees << ' ' << e;
        if (e == 0.0) return;  // they stay together, and go on together
        const Frame& end = run.frames.back();
        EXPECT_NEAR(way.dot(end.poses[1].velocity_world), v - j / m, kRounding)
            << degrees << ' ' << e;
        EXPECT_NEAR(end.poses[0].velocity_world.norm(), j / M * way.x(), kRounding)
            << degrees << ' ' << e;
        EXPECT_NEAR(end.kinetic_energy, 0.5 * m * v * v - 0.5 * (1 - e * e) * v * v / K, kRounding)
            << degrees << ' ' << e;
      });
    }
}

// A bar hinged at the origin, struck at a distance d by a ball: j = (1 + e) v / (1/m + d^2 / I).
TEST(ImpactsOnLinks, AHingedBarRotatesByItsMomentAboutTheHinge) {
  const double m = 1.0, M = 3.0, v = 2.0, I = M * (1 + 0.01) / 12 + M * 0.25;
  for (const double d : {0.05, 0.3, 2.0 / 3, 0.9})
    for (const double e : {1.0, 0.5, 0.0}) {
      scene::Scene scene =
          linked_scene({box("bar", {0.5, 0.05, 0.05}, M, {0.5, 0, 0}, Vector3d::Zero()),
                        ball("ball", 0.1, m, {d, 0.15 + kSoon * v, 0}, {0, -v, 0})},
                       e);
      scene.effects.of<effects::JointSpec>().push_back(
          {"hinge", effects::JointKind::kHinge, "bar", "", Vector3d::Zero(), Vector3d::UnitZ()});
      const double j = (1 + e) * v / (1 / m + d * d / I);
      in_all_engines(
          scene,
          [&](const Trajectory& run) {
            EXPECT_NEAR(first_collision(run).impulse, j, kRounding) << d << ' ' << e;
            EXPECT_NEAR(first_collision(run).normal_velocity_after, e * v, kRounding)
                << d << ' ' << e;
            if (e == 0.0) return;  // they stay together, and go on together
            const Frame& end = run.frames.back();
            EXPECT_NEAR(end.poses[1].velocity_world.y(), -v + j / m, kRounding) << d << ' ' << e;
            EXPECT_NEAR(end.poses[0].omega_world.z(), -j * d / I, kRounding) << d << ' ' << e;
          },
          e == 0.0);
    }
}

// A door slams against a stop: omega' = -e omega, the energy e^2 of what it was. Also with
// friction, which a hinge leaves nothing to do.
TEST(ImpactsOnLinks, ADoorReboundsFromItsStopWithTheRestitution) {
  const double omega = 3.0;
  for (const double friction : {0.0, 0.4})
    for (const double e : {1.0, 0.5, 0.0}) {
      scene::BodySpec door = box("door", {0.5, 0.02, 1.0}, 20.0, {0.5, 0, 0}, {0, 0.5 * omega, 0});
      door.omega_world_rad_s = {0, 0, omega};
      scene::BodySpec stop = box("stop", {0.05, 0.05, 1.0}, 1.0,
                                 {0.8, 0.02 + 0.05 + kSoon * omega * 0.8, 0}, Vector3d::Zero());
      stop.immovable = true;
      stop.mass_kg.reset();
      scene::Scene scene = linked_scene({door, stop}, e, friction);
      scene.effects.of<effects::JointSpec>().push_back(
          {"hinge", effects::JointKind::kHinge, "door", "", Vector3d::Zero(), Vector3d::UnitZ()});
      in_all_engines(scene, [&](const Trajectory& run) {
        const Frame& end = run.frames.back();
        // what does not bounce may be sent off at the restitution threshold
        const double hop = e == 0.0 ? 1e-9 + scene.rest_speed_m_s : 0.0;
        EXPECT_NEAR(end.poses[0].omega_world.z(), -e * omega, 2 * kRounding * omega + 2 * hop) << e;
        EXPECT_NEAR(first_collision(run).normal_velocity_after,
                    -e * first_collision(run).normal_velocity_before, kRounding * omega)
            << e;
      });
    }
}

// K of bodies with rows, the plain way: the response of the free bodies, less what the rows take by
// a pseudo-inverse.
double held_inverse_mass(const engines::MovingWorld& moving, const std::vector<Constraint>& rows,
                         const std::vector<int>& bodies, int struck, const Vector3d& point,
                         const Vector3d& n) {
  const Eigen::Index size = 6 * static_cast<Eigen::Index>(bodies.size() + 1);  // and the fixed end
  MatrixXd inverse_mass = MatrixXd::Zero(size, size),
           J = MatrixXd::Zero(static_cast<Eigen::Index>(rows.size()), size);
  VectorXd D = VectorXd::Zero(size);
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    const auto at = 6 * static_cast<Eigen::Index>(k);
    const Body body = moving.body_at_impact(bodies[k]);
    const Matrix3d R = body.world_from_body.toRotationMatrix();
    inverse_mass.block<3, 3>(at, at) = body.inertia.inverse_mass * Matrix3d::Identity();
    inverse_mass.block<3, 3>(at + 3, at + 3) =
        R * body.inertia.inverse_inertia_body * R.transpose();
    if (bodies[k] != struck) continue;
    D.segment<3>(at) = n;
    D.segment<3>(at + 3) = (point - body.com_world).cross(n);
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    J.row(static_cast<Eigen::Index>(i)).segment<6>(6 * rows[i].body_a) +=
        rows[i].row.jacobian_a.transpose();
    J.row(static_cast<Eigen::Index>(i)).segment<6>(6 * rows[i].body_b) +=
        rows[i].row.jacobian_b.transpose();
  }
  const MatrixXd S = J * inverse_mass * J.transpose();
  const VectorXd response = inverse_mass * D;
  const VectorXd taken_up = least_squares(S, J * response, 1e-11);
  return D.dot(response - inverse_mass * J.transpose() * taken_up);
}

// The middle of three bobs that hang on three rods from the origin, not in a row.
TEST(ImpactsOnLinks, AChainAnswersWithAllItsBobs) {
  const std::vector<Vector3d> places{{0.6, 0, -0.8}, {0.8, 0.3, -1.7}, {0.3, 0.9, -2.2}};
  for (const Vector3d& way : {Vector3d(1, 0, 0), Vector3d(0.48, -0.6, 0.64), Vector3d(0, 0, 1)})
    for (const double e : {1.0, 0.5}) {
      const double v = 2.0;
      scene::Scene scene =
          linked_scene({ball("bob0", 0.1, 1.0, places[0], Vector3d::Zero()),
                        ball("bob1", 0.1, 2.0, places[1], Vector3d::Zero()),
                        ball("bob2", 0.1, 0.5, places[2], Vector3d::Zero()),
                        ball("ball", 0.1, 1.5, places[1] - (0.2 + kSoon * v) * way, v * way)},
                       e);
      scene.effects.of<effects::RodSpec>() = {
          {"a", {"", Vector3d::Zero()}, {"bob0", Vector3d::Zero()}, places[0].norm()},
          {"b",
           {"bob0", Vector3d::Zero()},
           {"bob1", Vector3d::Zero()},
           (places[1] - places[0]).norm()},
          {"c",
           {"bob1", Vector3d::Zero()},
           {"bob2", Vector3d::Zero()},
           (places[2] - places[1]).norm()}};
      OneImpact still(scene);
      engines::LinkedBodies& chain = still.moving.linked_groups().front();
      const double K =
          1 / 1.5 + held_inverse_mass(still.moving,
                                      chain.constraint_rows(still.moving.states(), 0.0),
                                      chain.bodies(), 1, places[1], way);
      in_all_engines(scene, [&](const Trajectory& run) {
        EXPECT_NEAR(first_collision(run).impulse, (1 + e) * v / K, 10 * kRounding);
        EXPECT_NEAR(first_collision(run).normal_velocity_after, e * v, 10 * kRounding);
        EXPECT_NEAR(run.frames.back().kinetic_energy, 0.75 * v * v - 0.5 * (1 - e * e) * v * v / K,
                    10 * kRounding);
      });
    }
}

// Two dumb-bells: of two equal balls on a rod along r the one that is struck has K = (1 - (n . r)^2
// / 2) / m.
TEST(ImpactsOnLinks, TwoLinkedPairsThatMeetYieldAsBothRodsLetThem) {
  const double m = 1.0, M = 2.0, v = 3.0;
  const Vector3d n(1, 0, 0), r1(0.6, 0.8, 0), r2(0.28, 0, 0.96);
  for (const double e : {1.0, 0.3}) {
    const Vector3d at = Vector3d::Zero(), there(0.2 + kSoon * v, 0, 0);
    scene::Scene scene =
        linked_scene({ball("a1", 0.1, m, at, v * n), ball("a2", 0.1, m, at - r1, v * n),
                      ball("b1", 0.1, M, there, Vector3d::Zero()),
                      ball("b2", 0.1, M, there + r2, Vector3d::Zero())},
                     e);
    scene.effects.of<effects::RodSpec>() = {
        {"a", {"a1", Vector3d::Zero()}, {"a2", Vector3d::Zero()}, 1.0},
        {"b", {"b1", Vector3d::Zero()}, {"b2", Vector3d::Zero()}, 1.0}};
    const double K = (1 - 0.5 * 0.36) / m + (1 - 0.5 * 0.28 * 0.28) / M;
    in_all_engines(scene, [&](const Trajectory& run) {
      EXPECT_NEAR(first_collision(run).impulse, (1 + e) * v / K, kRounding * 10);
      EXPECT_LT((run.frames.back().momentum_world - run.frames.front().momentum_world).norm(),
                kRounding * 10);
      EXPECT_LT(
          (run.frames.back().angular_momentum_world - run.frames.front().angular_momentum_world)
              .norm(),
          kRounding * 10);
      EXPECT_NEAR(run.frames.back().kinetic_energy, m * v * v - 0.5 * (1 - e * e) * v * v / K,
                  kRounding * 10);
    });
  }
}

// A ball without spin strikes a bob on a rod in the plane of both, with friction. K_nn, K_nt, K_tt
// in closed form; it slides to the end, or sticks.
TEST(ImpactsOnLinks, FrictionOnABobSlidesOrSticksWithItsRod) {
  const double v = 2.0, slip = 6.0, r = 0.1, e = 0.5, angle = 0.7;
  const Vector3d n_to_bob(std::sin(angle), 0, std::cos(angle)),
      t(std::cos(angle), 0, -std::sin(angle));
  const Vector3d velocity = v * n_to_bob + slip * t;
  for (const double mu : {0.05, 2.0}) {
    const Vector3d bob(0, 0, -1);
    scene::Scene scene =
        linked_scene({ball("bob", r, 1.0, bob, Vector3d::Zero()),
                      ball("ball", r, 1.0, bob - 2 * r * n_to_bob - kSoon * velocity, velocity)},
                     e, mu);
    scene.effects.of<effects::RodSpec>().push_back(
        {"rod", {"bob", Vector3d::Zero()}, {"", Vector3d::Zero()}, 1.0});
    // Of the bob against the ball: both turn (5/2 each), the ball yields in both directions, the
    // bob along x only.
    const double Knn = 1 + n_to_bob.x() * n_to_bob.x(), Knt = n_to_bob.x() * t.x(),
                 Ktt = 1 + 5 + t.x() * t.x(), rise = (1 + e) * v;
    double normal, tangential;
    if (mu < 1) {  // against the slip of the bob, which goes along -t
      normal = rise / (Knn + mu * Knt);
      tangential = mu * normal;
    } else {
      Eigen::Matrix2d K;
      K << Knn, Knt, Knt, Ktt;
      const Eigen::Vector2d p = K.inverse() * Eigen::Vector2d(rise, slip);
      normal = p[0];
      tangential = p[1];
      ASSERT_LT(std::abs(tangential), mu * normal);
    }
    scene.contact = scene::ContactSpec{};
    for (const auto law : {scene::ImpactLaw::kSequential, scene::ImpactLaw::kSimultaneous})
      for (const std::string& engine : kEngines) {
        scene.contact->impact_law = law;
        const Trajectory run = run_by(engine, scene, {}, 1000.0, laws());
        const Event& event = first_collision(run);
        EXPECT_NEAR(event.impulse, normal, 10 * kRounding) << engine << ' ' << mu;
        EXPECT_NEAR(event.normal_velocity_after, e * v, 10 * kRounding) << engine << ' ' << mu;
        const Vector3d expected = velocity - normal * n_to_bob - tangential * t;
        EXPECT_LT((run.frames.back().poses[1].velocity_world - expected).norm(), 10 * kRounding)
            << engine << ' ' << mu;
        for (const engines::CheckResult& check : engines::judge_run(scene, run))
          EXPECT_TRUE(check.passed) << check.kind << ": " << check.detail;
      }
  }
}

// ---- What links leave no impulse to do, and what the judge sees --------------------------------

// A rod from a driven body drives a bob straight into a wall: nothing can give.
TEST(ImpactsOnLinks, WhereRodsHoldBothBodiesNoImpulseSeparatesThemAndTheRunReportsIt) {
  scene::BodySpec driver = ball("driver", 0.05, 1.0, {0, 0, 0}, Vector3d::Zero()),
                  wall = plane("wall", {1.2, 0, 0}, {-1, 0, 0});
  driver.immovable = true;
  driver.mass_kg.reset();
  driver.motion = scene::PrescribedMotion{{1, 0, 0}, Vector3d::Zero(), 0.0};
  scene::Scene scene =
      linked_scene({driver, ball("bob", 0.1, 1.0, {1.0, 0, 0}, {1, 0, 0}), wall}, 0.5);
  scene.duration_s = 0.3;
  scene.effects.of<effects::RodSpec>().push_back(
      {"rod", {"driver", Vector3d::Zero()}, {"bob", Vector3d::Zero()}, 1.0});
  for (const auto& [law, asked] : under_all_laws(scene)) {
    if (law == "simultaneous") continue;
    for (const std::string& engine : kEngines) {
      const Trajectory run = run_by(engine, asked, {}, 60.0, laws());
      EXPECT_NE(run.stopped_by.find("hold both completely"), std::string::npos)
          << engine << ", " << law << ": " << run.stopped_by;
    }
  }
}

// Two points on a rod that drifts apart at 0.3 m/s, of which one comes down on a slope: what
// contact and rod do is all the change of energy there is, and the rod's part is its impulse times
// its drift. Without drift it would be none.
TEST(ImpactEnergy, OfALinkThatDriftsIsToldFromThatOfTheContact) {
  for (const double drift : {0.3, 0.0}) {
    ContactProblem problem;
    const double masses[] = {1.0, 2.0};
    for (int k = 0; k < 2; ++k)
      problem.bodies.push_back({1.0 / masses[k], Matrix3d::Identity(), Vector3d(k, 0, 0),
                                Vector3d(k == 0 ? drift : 0.0, 0, -1), Vector3d::Zero()});
    problem.bodies.push_back(
        {0.0, Matrix3d::Zero(), Vector3d(0, 0, -1), Vector3d::Zero(), Vector3d::Zero()});
    PushingContact contact;
    contact.body_a = 0;
    contact.body_b = 2;
    contact.point_world = Vector3d::Zero();
    contact.normal_b_to_a_world = Vector3d(1, 0, 1).normalized();
    problem.contacts.push_back(contact);
    ConstraintRow row;
    row.jacobian_a << 1, 0, 0, 0, 0, 0;
    row.jacobian_b << -1, 0, 0, 0, 0, 0;
    problem.rows.push_back({0, 1, row});
    problem.row_targets = VectorXd::Constant(1, drift);
    const std::vector<Velocity> before = engines::velocities_of(problem);
    const ContactSolution solution = solve_contacts(problem);
    ASSERT_TRUE(solution.converged);
    double change = 0.0;
    for (std::size_t k = 0; k < 2; ++k)
      change += 0.5 * masses[k] *
                (solution.velocities[k].linear_world.squaredNorm() -
                 before[k].linear_world.squaredNorm());
    const double by_contact = engines::work_of(problem, solution.impulses_world, before,
                                               solution.velocities),
                 by_rod = engines::work_of_rows(problem, solution.row_impulses, before,
                                                solution.velocities, Vector3d::Zero());
    EXPECT_NEAR(change, by_contact + by_rod, 1e-11) << drift;  // J, of about one
    EXPECT_NEAR(by_rod, solution.row_impulses[0] * drift, 1e-11) << drift;
    if (drift > 0) {
      EXPECT_GT(std::abs(by_rod), 1e-3) << "a rod that pushes does work with its drift";
    }
  }
}

// A cradle whose other balls touch from the start, in persistent contact, with e = 1. The last of
// them leaves, and within the same step what rounding leaves of the impact strikes the row again:
// by then its contact has opened, and when it comes back it rebounds. Energy stays, and one ball
// has all of it.
TEST(ImpactsOnLinks, ACradleOfTouchingBallsKeepsItsEnergy) {
  constexpr int kBalls = 5;
  constexpr double kG = 9.81;
  std::vector<scene::BodySpec> bodies{
      ball("b0", 0.1, 1.0, {-0.5, 0, -std::sqrt(0.75)}, Vector3d::Zero())};
  for (int i = 1; i < kBalls; ++i)
    bodies.push_back(ball("b" + std::to_string(i), 0.1, 1.0, {0.2 * i, 0, -1}, Vector3d::Zero()));
  scene::Scene scene = linked_scene(bodies, 1.0);
  effects::set_gravity(scene, {0, 0, -kG});
  scene.contact = scene::ContactSpec{};
  scene.duration_s = 2.4;  // two impacts
  for (int i = 0; i < kBalls; ++i)
    scene.effects.of<effects::RodSpec>().push_back({"r" + std::to_string(i),
                                                    {"", {0.2 * i, 0, 0}},
                                                    {"b" + std::to_string(i), Vector3d::Zero()},
                                                    1.0});
  const double fallen = kG * (1 - std::sqrt(0.75));
  for (const int steps_a_second : {30, 60, 240}) {
    scene.step_s = 1.0 / steps_a_second;
    // J: above what RK4 leaves at the longest step; a contact instead of a rebound takes 1.05 J
    const double tolerance = 1e-3 * fallen;
    for (const std::string& engine : kEngines) {
      SCOPED_TRACE(std::string(engine) + ", " + std::to_string(steps_a_second));
      const Trajectory run = run_by(engine, scene, {}, 60.0, laws());
      EXPECT_EQ(run.stopped_by, "");
      const auto energy = [](const Frame& frame) {
        return frame.kinetic_energy + frame.potential_energy;
      };
      const Frame& end = run.frames.back();
      EXPECT_NEAR(energy(end), energy(run.frames.front()), tolerance);
      EXPECT_NEAR(0.5 * end.poses[0].velocity_world.squaredNorm(), end.kinetic_energy, tolerance);
    }
  }
}

// A law that gives linked bodies half of the impulse takes the wrong energy: the judge says so
// whatever the scene asks, with time and bodies.
TEST(ImpactEnergy, IsJudgedAtEveryImpact) {
  scene::Scene scene = linked_scene({ball("a", 0.1, 1.0, {0, 0, 0}, {1, 0, 0}),
                                     ball("b", 0.1, 1.0, {0.205, 0, 0}, Vector3d::Zero())},
                                    1.0);
  scene.stabilisation.reset();
  Laws wrong = laws();
  wrong.apply_impulse = [](const Body& body, const Vector3d& impulse, const Vector3d& point) {
    Velocity after = laws().apply_impulse(body, impulse, point);
    after.linear_world = body.velocity_world + 1.01 * (after.linear_world - body.velocity_world);
    return after;
  };
  for (const auto& [law, asked] : under_all_laws(scene)) {
    if (law == "simultaneous") continue;  // does not ask the law
    for (const std::string& engine : kEngines) {
      EXPECT_TRUE(engines::judge_run(asked, run_by(engine, asked, {}, 60.0, laws())).empty())
          << engine;
      const auto results = engines::judge_run(asked, run_by(engine, asked, {}, 60.0, wrong));
      // the watch on energy may say it too
      ASSERT_FALSE(results.empty()) << engine << ", " << law;
      EXPECT_EQ(results.front().kind, "impact_energy");
      EXPECT_EQ(results.front().subject, "a, b");
      EXPECT_FALSE(results.front().passed);
      EXPECT_NE(results.front().detail.find("at t = 0.005 s"), std::string::npos)
          << results.front().detail;
    }
  }
}

// A lever lies on the floor, and a block falls on it: block and floor hand the lever to and fro in
// one instant, and of its speed roundings of the first blow's are left. They are no wrong energy.
TEST(ImpactEnergy, IsNotThatOfRoundingsWhereBodiesComeToRest) {
  for (const double block_kg : {1.0, 5.0})
    for (const double speed_m_s : {1.0, 20.0}) {
      constexpr double kLength = 0.8, kHalfWidth = 0.03, kTilt = 0.3;
      const double height = kLength * std::sin(kTilt) + kHalfWidth * std::cos(kTilt);
      scene::BodySpec lever =
          box("lever", {0.5 * kLength, kHalfWidth, kHalfWidth}, 1.0,
              {0.5 * kLength * std::cos(kTilt), 0, height - 0.5 * kLength * std::sin(kTilt)},
              Vector3d::Zero());
      lever.world_from_body = Quaterniond(Eigen::AngleAxisd(kTilt, Vector3d::UnitY()));
      scene::Scene scene = scene_of(
          {plane("floor", Vector3d::Zero(), Vector3d::UnitZ()), lever,
           box("block", {0.05, 0.05, 0.05}, block_kg, {0.5, 0, height + 0.3}, {0, 0, -speed_m_s})},
          0.4, Vector3d(0, 0, -9.81));
      for (scene::BodySpec& body : scene.bodies) body.restitution = body.friction = 0.0;
      scene.effects.of<effects::JointSpec>().push_back(
          {"hinge", effects::JointKind::kHinge, "lever", "", {0, 0, height}, Vector3d::UnitY()});
      scene.contact.emplace();
      scene.step_s = 1.0 / 240;
      for (const std::string& engine : kEngines) {
        const Trajectory run = run_by(engine, scene, {}, 60.0, laws());
        EXPECT_GT(run.events.size(), 5u);
        for (const auto& result : engines::judge_run(scene, run))
          EXPECT_TRUE(result.passed) << engine << ", " << block_kg << " kg: " << result.kind << ' '
                                     << result.value << ' ' << result.detail;
      }
    }
}

}  // namespace
}  // namespace tumble::testing::linked_impacts
