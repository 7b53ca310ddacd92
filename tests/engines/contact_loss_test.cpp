// What steps in contact lose beside what friction and landing take is told of, with a step that
// mends it; and what slides, lands and rolls rightly is left in peace.
#include <cmath>
#include <optional>

#include <gtest/gtest.h>

#include "tests/engines/watched_runs.h"

namespace tumble::testing::contact_loss_test {
namespace {

/// The first that is told of lost energy.
std::optional<RunFault> lost_in(const Trajectory& run) {
  for (const RunFault& fault : run.counters.faults)
    if (fault.kind == "energy_lost") return fault;
  return std::nullopt;
}

scene::Scene on_floor(scene::BodySpec body, double step) {
  body.friction = 1.0;
  scene::Scene scene = scene_of(
      {plane("floor", Vector3d::Zero(), Vector3d::UnitZ()), std::move(body)}, 1.0, kEarthGravity);
  scene.bodies[0].friction = 1.0;
  scene.contact.emplace();
  scene.step_s = step;
  return scene;
}

/// A thin ellipsoid of revolution, tilted by 0.6 rad, whose point of contact stands still while it
/// turns about the vertical. Friction is enough for it to roll.
scene::Scene rolling_disk(double step) {
  constexpr double kRadius = 0.1, kThickness = 0.01, kTilt = 0.6, kMass = 1.0;
  scene::BodySpec disk = ball("disk", kRadius, kMass, Vector3d::Zero(), Vector3d::Zero());
  const Vector3d semi_axes(kRadius, kRadius, kThickness);
  disk.shape = scene::EllipsoidSpec{semi_axes};
  disk.inertia_body_kg_m2 = Vector3d(0.25, 0.25, 0.5).asDiagonal();
  *disk.inertia_body_kg_m2 *= kMass * kRadius * kRadius;
  disk.world_from_body = Quaterniond(Eigen::AngleAxisd(kTilt, Vector3d::UnitX()));
  // its lowest point, x = -A n / sqrt(n A n) with A = diag(semi_axes^2) and n the vertical
  const Vector3d up_body = disk.world_from_body.conjugate() * Vector3d::UnitZ(),
                 A_up = semi_axes.cwiseAbs2().cwiseProduct(up_body),
                 lowest_world =
                     disk.world_from_body * Vector3d(-A_up / std::sqrt(up_body.dot(A_up)));
  disk.position_m = {0, 0, -lowest_world.z()};
  disk.omega_world_rad_s = {0, 0, 3};
  disk.velocity_m_s = -disk.omega_world_rad_s.cross(lowest_world);
  disk.restitution = 0.0;
  scene::Scene scene = on_floor(std::move(disk), step);
  for (scene::BodySpec& body : scene.bodies) body.friction = 5.0;
  return scene;
}

double energy(const Frame& frame) { return frame.kinetic_energy + frame.potential_energy; }

// Rolling does no work. Steps of 1/30 s lose a third of what comes down; those that the run names
// lose less than the hundredth that is allowed, of at most 0.51 J (m g times the way from the
// tilted disk's height to that of a flat one).
TEST(ContactLoss, OfADiskThatRollsInLongStepsIsTold) {
  const Trajectory coarse = run_by("rd", rolling_disk(1.0 / 30));
  EXPECT_LT(energy(coarse.frames.back()), energy(coarse.frames.front()) - 0.1);
  const auto fault = lost_in(coarse);
  ASSERT_TRUE(fault) << said(coarse);
  EXPECT_EQ(fault->subject, "'disk'");
  EXPECT_NE(fault->meaning.find("rolls or rests"), std::string::npos) << fault->meaning;

  const std::string words = "a step of at most ";
  const auto at = fault->remedy.find(words);
  ASSERT_NE(at, std::string::npos) << fault->remedy;
  const Trajectory fine =
      run_by("rd", rolling_disk(std::stod(fault->remedy.substr(at + words.size()))));
  EXPECT_FALSE(lost_in(fine)) << said(fine);
  EXPECT_NEAR(energy(fine.frames.back()), energy(fine.frames.front()), 0.01 * 0.51);
}

// A ball that slides and then rolls loses 2/7 of its energy, a box that slides all of it, and a box
// that falls on its edge and rocks to rest all that it fell: none of it by the step.
TEST(ContactLoss, IsNotWhatSlidingAndLandingTake) {
  scene::BodySpec tilted = box("box", {0.15, 0.1, 0.05}, 1.0, {0, 0, 0.3}, {0.5, 0, 0});
  tilted.world_from_body = Quaterniond(Eigen::AngleAxisd(0.6, Vector3d(1, 3, 0).normalized()));
  for (const double step : {1.0 / 60, 1.0 / 240}) {
    for (scene::BodySpec body :
         {ball("ball", 0.1, 1.0, {0, 0, 0.1}, {3, 0, 0}),
          box("box", {0.2, 0.1, 0.05}, 1.0, {0, 0, 0.05}, {2, 0.5, 0}), tilted}) {
      body.restitution = 0.0;
      const Trajectory run = run_by("rd", on_floor(body, step));
      EXPECT_LT(energy(run.frames.back()), 0.9 * energy(run.frames.front()));
      EXPECT_FALSE(lost_in(run)) << body.name << ' ' << step << said(run);
    }
  }
}

// Cards that stand against each other settle by some 1e-8 J, as places are corrected: all that
// moves there, and nothing that is seen of m g times their size.
TEST(ContactLoss, IsNotToldOfWhatStands) {
  scene::Scene scene = scene::load_scene(std::filesystem::path(test::source_dir()) /
                                         "assignments/a3_constraints/scenes/card_tent.json");
  scene.duration_s = 1.0;
  const Trajectory run = run_by("rd", scene);
  EXPECT_FALSE(lost_in(run)) << said(run);
}

// Boxes slide off a ball of 9 mm in a step of 1/30 s, which an impact with the floor ends: the path
// that leads there goes through the ball. A frame is drawn on it, and said to be wrong with the
// bodies; in a tenth of the step all frames are right, and nothing is said.
/// A ball within a part of a polygon that stands for a cylinder: facets that lean by `angle`
/// against their neighbours. It goes along the first at 3 m/s, and nothing pulls it.
scene::Scene along_facets(int facets, double angle, double friction, double step) {
  constexpr double kApothem = 1.0, kRadius = 0.1, kThick = 0.05, kSpeed = 3.0;
  const double half = (kApothem + kThick) * std::tan(0.5 * angle);
  scene::Scene scene =
      scene_of({ball("ball", kRadius, 1.0, {0, 0, -(kApothem - kRadius)}, {kSpeed, 0, 0})}, 0.3);
  if (friction > 0.0) scene.bodies[0].omega_world_rad_s = {0, kSpeed / kRadius, 0};
  for (int k = 0; k < facets; ++k) {
    const Quaterniond turn(Eigen::AngleAxisd(-angle * k, Vector3d::UnitY()));
    scene::BodySpec facet = box("facet " + std::to_string(k), {half, 0.5, 0.5 * kThick}, 1.0,
                                turn * Vector3d(0, 0, -kApothem - 0.5 * kThick), Vector3d::Zero());
    facet.immovable = true;
    facet.world_from_body = turn;
    scene.bodies.push_back(facet);
  }
  for (scene::BodySpec& body : scene.bodies) {
    body.restitution = 0.0;
    body.friction = friction;
  }
  scene.contact.emplace();
  scene.step_s = step;
  return scene;
}

// What faceted solids take, and smooth ones would not: where facets meet at an angle d the normal
// part of a velocity, sin d, is lost. A smooth ball keeps cos^2 d of its energy at each. One that
// rolls is left with (5 cos d + 2) / 7 of its speed: friction turns it as the new facet asks.
// Landing is what contacts take, so no watch tells it, however many facets there are: a cylinder of
// N of them keeps cos^2N d, about exp(-4 pi^2 / N), in a turn.
TEST(ContactLoss, AtTheEdgesOfFacetsIsThatOfInelasticImpactsInEveryEngine) {
  constexpr double kTurn = 3.0 * 3.14159265358979 / 180;
  constexpr int kFacets = 12;
  for (const double friction : {0.0, 0.5})
    for (const double step : {1.0 / 60, 1.0 / 500, 1.0 / 4000})
      for (const std::string engine : {"rd", "ordered", "tw"}) {
        const Trajectory run = run_by(engine, along_facets(kFacets, kTurn, friction, step));
        EXPECT_FALSE(lost_in(run)) << engine << said(run);
        const Vector3d end = run.frames.back().poses[0].com_world;
        const int passed = static_cast<int>(std::atan2(end.x(), -end.z()) / kTurn + 0.5);
        EXPECT_GT(passed, 10) << engine;  // 0.9 m in 47 mm each, and beyond the last
        const double kept_speed = friction > 0.0 ? (5 * std::cos(kTurn) + 2) / 7 : std::cos(kTurn);
        // The instants are located and the facets flat: rounding, and margins of 1e-10 of the ball.
        EXPECT_NEAR(run.frames.back().kinetic_energy / run.frames.front().kinetic_energy,
                    std::pow(kept_speed, 2 * std::min(passed, kFacets - 1)), 1e-8)
            << engine << ' ' << friction << ' ' << step;
      }
}

scene::BodySpec turned_model(const std::string& name, const std::string& file,
                             const Vector3d& position, const Vector3d& rotation_vector) {
  scene::BodySpec body = ball(name, 1.0, 1.0, position, Vector3d::Zero());
  body.shape = scene::ModelSpec{test::source_dir() + "/models/" + file, "", 1.0};
  body.world_from_body =
      Quaterniond(Eigen::AngleAxisd(rotation_vector.norm(), rotation_vector.normalized()));
  return body;
}

/// Smooth, and without rebound.
scene::Scene one_falls_on_other(scene::BodySpec below, const scene::BodySpec& above, double step) {
  below.immovable = true;
  scene::Scene scene = scene_of({below, above}, 1.5, kEarthGravity);
  for (scene::BodySpec& body : scene.bodies) body.friction = body.restitution = 0.0;
  scene.contact.emplace();
  scene.step_s = step;
  return scene;
}

/// A wedge lands on a beam's edge, turns about it and glides off over the beam's end.
scene::Scene wedge_off_a_beam(double step) {
  return one_falls_on_other(
      turned_model("beam", "l_shape.3ds", Vector3d::Zero(), {3.7645325, 1.3703514, 1.7589594}),
      turned_model("wedge", "wedge.3ds", {0.00360613, -0.19713895, 2.2},
                   {-3.6205155, -2.4918955, -0.2536641}),
      step);
}

/// A ring of facets falls over a post and slides along its edges.
scene::Scene ring_on_a_post(double step) {
  scene::BodySpec post = box("post", {0.05, 0.2, 0.4}, 1.0, Vector3d::Zero(), Vector3d::Zero());
  const Vector3d lean(0.05215910, 0.12471990, 0.03279097);
  post.world_from_body = Quaterniond(Eigen::AngleAxisd(lean.norm(), lean.normalized()));
  return one_falls_on_other(post,
                            turned_model("ring", "torus.3ds", {0.02858532, 0.05899431, 2.2},
                                         {-1.3302017, -0.4780977, 1.0218441}),
                            step);
}

// Where an edge goes over to the next face within a step, that face's point lies as near as its own
// would. It is no part of the contact that ends: taken for it, it asked for a velocity along the
// new normal that was right along the old one. The wedge lost 0.45 J of 2.1 J, the ring gained
// 0.037 J, and "ordered" said nothing.
TEST(ContactLoss, IsNoneWhereAnEdgeGoesOverToTheNextFace) {
  for (const std::string engine : {"rd", "ordered"}) {
    const Trajectory wedge = run_by(engine, wedge_off_a_beam(1.0 / 240)),
                     fine = run_by(engine, wedge_off_a_beam(1.0 / 3840));
    EXPECT_TRUE(wedge.counters.faults.empty()) << engine << said(wedge);
    // the step's error where a contact ends is of first order: 7e-4 J
    EXPECT_NEAR(energy(wedge.frames.back()), energy(fine.frames.back()), 3e-3) << engine;

    const Trajectory ring = run_by(engine, ring_on_a_post(1.0 / 240));
    EXPECT_TRUE(ring.counters.faults.empty()) << engine << said(ring);
    double lowest = kInfinity, rise = 0.0;  // [J]
    for (const Frame& frame : ring.frames) {
      lowest = std::min(lowest, energy(frame));
      rise = std::max(rise, energy(frame) - lowest);
    }
    EXPECT_LT(rise, 1e-4) << engine;  // of 19 J that it falls: what steps leave is 1e-5 J
  }
}

// The thin arch opens at edges that lie on each other, which hardly move on either stone: such a
// point is the same whatever its normal. Where it counted as another one, steps of 1/60 s lost 26 J
// of the 610 J that came down.
TEST(ContactLoss, IsNoneWhereAnEdgeTurnsAboutAnother) {
  const auto end_energy = [](double step) {
    scene::Scene scene = scene::load_scene(std::filesystem::path(test::source_dir()) /
                                           "assignments/a3_constraints/scenes/thin_arch.json");
    scene.step_s = step;
    const Trajectory run = run_by("rd", scene);
    EXPECT_TRUE(run.counters.faults.empty()) << said(run);
    return energy(run.frames.back());
  };
  // first order in the step where contacts end: 1.8 J at 1/60 s
  EXPECT_NEAR(end_energy(1.0 / 60), end_energy(1.0 / 960), 4.0);
}

// What presses goes over a corner of the bowl again and again: for the whole of a step or not at
// all. In uncut steps the box gained 0.28 of the energy that there is.
TEST(ContactLoss, IsNoneWhereABoxGoesOverTheCornersOfABowl) {
  for (const std::string engine : {"rd", "ordered"}) {
    const Trajectory run = run_by(engine, broken_scene("box_in_a_bowl"));
    EXPECT_TRUE(run.counters.faults.empty()) << engine << said(run);
  }
}

TEST(OverlapLeft, InAFrameBetweenTheEndsOfStepsIsTold) {
  for (const std::string engine : {"ordered", "tw"})
    for (const bool is_coarse : {true, false}) {
      scene::Scene scene = broken_scene("boxes_off_a_ball");
      if (!is_coarse) scene.step_s /= 10;
      const Trajectory run = run_by(engine, scene);
      double smallest = kInfinity;
      for (const Frame& frame : run.frames) smallest = std::min(smallest, frame.smallest_gap);
      EXPECT_EQ(has_fault(run, "overlap_left"), is_coarse) << engine << said(run);
      EXPECT_EQ(smallest < -1e-3 * 0.00927, is_coarse) << smallest;
      if (!is_coarse || run.counters.faults.empty()) continue;
      const RunFault& fault = run.counters.faults.front();
      EXPECT_EQ(fault.subject, "'b0' and 'b1'");
      EXPECT_NEAR(fault.worst, -smallest / 0.00927, 1e-9) << "of the ball's radius";
      EXPECT_NE(fault.remedy.find("a step of at most"), std::string::npos) << fault.remedy;
    }
}

}  // namespace
}  // namespace tumble::testing::contact_loss_test
