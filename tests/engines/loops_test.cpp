// Mechanisms whose loops have rows that say what others say: rings of parallel hinges, spherical
// four-bars (a universal joint between two bearings is one), Bennett's linkage. Hinges do no work, and
// without gravity nothing turns a ring that is thrown: drawn by lot, in both coordinates.
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "framework/core/random.h"
#include "framework/effects/gravity/gravity.h"
#include "framework/effects/joint/joint.h"
#include "framework/effects/rod/rod.h"
#include "tests/engines/event_process_scenes.h"
#include "tests/engines/reference_runs.h"

namespace tumble::testing {
namespace loops_test {

using scene::Coordinates;

Vector3d drawn_direction(Random& random) {
  Vector3d direction;
  do {
    for (double& x : direction) x = random.between(-1, 1);
  } while (direction.norm() > 1 || direction.norm() < 0.3);
  return direction.normalized();
}

/// Bars between neighbouring hinges; the first and the last hinge hold the chain to the world, and
/// with them the loop is closed through it.
scene::Scene linkage(const std::vector<Vector3d>& points, const std::vector<Vector3d>& axes) {
  std::vector<scene::BodySpec> bodies;
  for (std::size_t k = 1; k < points.size(); ++k) {
    bodies.push_back(box(fmt::format("bar {}", k), {0.1, 0.15, 0.2}, 1.0,
                         0.5 * (points[k - 1] + points[k]), Vector3d::Zero()));
    bodies.back().collides = false;
  }
  scene::Scene scene = scene_of(std::move(bodies), 0.5, kEarth);
  scene.stabilisation = scene::StabilisationSpec{};
  const auto name = [&](std::size_t bar) {
    return bar == 0 || bar == points.size() ? std::string() : fmt::format("bar {}", bar);
  };
  for (std::size_t k = 0; k < points.size(); ++k) {
    const bool first = k == 0;
    scene.effects.of<effects::JointSpec>().push_back(
        {fmt::format("hinge {}", k), effects::JointKind::kHinge, first ? name(1) : name(k),
         first ? name(0) : name(k + 1), points[k], axes[k]});
  }
  return scene;
}

/// All axes meet in the origin.
scene::Scene spherical_four_bar(Random& random) {
  std::vector<Vector3d> points, axes;
  for (int k = 0; k < 4; ++k) {
    axes.push_back(drawn_direction(random));
    points.push_back(random.between(0.5, 1.0) * axes.back());
  }
  return linkage(points, axes);
}

/// A skew quadrilateral whose opposite sides are equal, each axis across the two sides that meet
/// there: mobile by its proportions alone (Bennett, "The skew isogram mechanism", 1914).
scene::Scene bennett(Random& random) {
  const auto half_turn = [](const Vector3d& x) { return Vector3d(-x.x(), -x.y(), x.z()); };
  const Vector3d p(random.between(0.3, 0.8), random.between(-0.2, 0.2), random.between(0.1, 0.4)),
      q(random.between(-0.2, 0.2), random.between(0.3, 0.8), random.between(-0.4, -0.1));
  const std::vector<Vector3d> points{p, q, half_turn(p), half_turn(q)};
  std::vector<Vector3d> axes;
  for (std::size_t k = 0; k < 4; ++k)
    axes.push_back(
        (points[(k + 1) % 4] - points[k]).cross(points[(k + 3) % 4] - points[k]).normalized());
  return linkage(points, axes);
}

/// A regular polygon of bars, thrown as one body that turns.
scene::Scene thrown_ring(Random& random) {
  const int n = 3 + static_cast<int>(random.between(0, 4));
  const Vector3d omega = random.between(1.0, 4.0) * drawn_direction(random);
  std::vector<scene::BodySpec> bodies;
  const auto corner = [&](int k) {
    const double angle = 2 * std::numbers::pi * k / n;
    return Vector3d(0.5 * std::cos(angle), 0.5 * std::sin(angle), 0);
  };
  for (int k = 0; k < n; ++k) {
    const Vector3d middle = 0.5 * (corner(k) + corner(k + 1));
    scene::BodySpec bar =
        box(fmt::format("bar {}", k), {0.05, 0.05, 0.1}, 1.0, middle, omega.cross(middle));
    bar.omega_world_rad_s = omega;
    bar.collides = false;
    bodies.push_back(bar);
  }
  scene::Scene scene = scene_of(std::move(bodies), 0.5);
  scene.stabilisation = scene::StabilisationSpec{};
  for (int k = 0; k < n; ++k)
    scene.effects.of<effects::JointSpec>().push_back(
        {fmt::format("hinge {}", k), effects::JointKind::kHinge, fmt::format("bar {}", k),
         fmt::format("bar {}", (k + 1) % n), corner(k + 1), Vector3d::UnitZ()});
  return scene;
}

/// The largest error of the energy, in parts of the largest kinetic energy.
double error_of_energy(scene::Scene scene, Coordinates coordinates, double step) {
  scene.coordinates = coordinates;
  scene.step_s = step;
  const Trajectory run = run_on("rd", scene);
  EXPECT_EQ(run.stopped_by, "");
  double worst = 0.0, moves = 0.0;
  const auto energy = [](const Frame& frame) {
    return frame.kinetic_energy + frame.potential_energy;
  };
  for (const Frame& frame : run.frames) {
    moves = std::max(moves, frame.kinetic_energy);
    worst = std::max(worst, std::abs(energy(frame) - energy(run.frames.front())));
  }
  return worst / moves;
}

/// RK4 leaves a sixteenth of an error when the step is halved, and a fourth power less in between;
/// a mechanism near a dead point turns too fast for that. Rows that all had to hold took 0.1 to 1.
void expect_energy_kept(const scene::Scene& scene, double step = 1.0 / 960) {
  for (const Coordinates coordinates : {Coordinates::kMaximal, Coordinates::kReduced}) {
    SCOPED_TRACE(coordinates == Coordinates::kMaximal ? "maximal" : "reduced");
    EXPECT_LT(error_of_energy(scene, coordinates, step), 1e-5);
  }
}

/// Most draws; a long run draws more.
constexpr std::uint64_t kDraws = 8;

TEST(Loops, SphericalFourBarsDrawnByLotKeepTheirEnergy) {
  for (std::uint64_t seed = 1; seed <= kDraws; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    expect_energy_kept(spherical_four_bar(random));
  }
}

TEST(Loops, BennettsLinkagesDrawnByLotKeepTheirEnergy) {
  for (std::uint64_t seed = 1; seed <= kDraws; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    expect_energy_kept(bennett(random), 1.0 / 120);
  }
}

TEST(Loops, RingsDrawnByLotThatAreThrownKeepTheirEnergy) {
  for (std::uint64_t seed = 1; seed <= kDraws; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    expect_energy_kept(thrown_ring(random), 1.0 / 120);
  }
}

// The order of the method, where nothing is near a dead point.
TEST(Loops, ABennettLinkageIsOfFourthOrderInTheStep) {
  Random random(1);
  const scene::Scene scene = bennett(random);
  for (const Coordinates coordinates : {Coordinates::kMaximal, Coordinates::kReduced}) {
    const double coarse = error_of_energy(scene, coordinates, 1.0 / 30),
                 fine = error_of_energy(scene, coordinates, 1.0 / 120);
    EXPECT_LT(coarse, 1e-3);
    EXPECT_LT(fine, coarse / 64);  // of fourth order 256: steps of 1/30 s are not short
  }
}

// ---- Any size

/// The same mechanism, 2^exponent times as large, under as much more gravity: it moves alike.
scene::Scene of_size(scene::Scene scene, int exponent) {
  const double length = std::ldexp(1.0, exponent);
  for (scene::BodySpec& body : scene.bodies) {
    body.position_m *= length;
    body.velocity_m_s *= length;
    std::get<scene::BoxSpec>(body.shape).half_extents_m *= length;
  }
  for (effects::JointSpec& joint : scene.effects.of<effects::JointSpec>()) joint.point_m *= length;
  for (effects::GravitySpec& gravity : scene.effects.of<effects::GravitySpec>())
    gravity.acceleration_m_s2 *= length;
  return scene;
}

// A joint's error of direction is in rad, and no part of a length: of bars of a micrometre,
// rounding (2e-16 rad) was told as an open joint.
TEST(Loops, MechanismsOfPicometresAndOfMegametresMoveAlike) {
  Random random(1);
  const scene::Scene bar =
      linkage({Vector3d(0, 0, 0), Vector3d(0.8, 0, 0)}, {Vector3d::UnitY(), Vector3d::UnitY()});
  scene::Scene pendulum = bar;
  pendulum.effects.of<effects::JointSpec>().pop_back();
  for (const scene::Scene& scene : {pendulum, bennett(random)}) {
    const Trajectory expected = run_well("rd", scene);
    for (const int exponent : {-40, -20, 20}) {
      SCOPED_TRACE(exponent);
      const Trajectory found = run_well("rd", of_size(scene, exponent));
      for (std::size_t i = 0; i < scene.bodies.size(); ++i)
        // powers of two scale without rounding: what is left is that lengths are squared and rooted
        EXPECT_LT((std::ldexp(1.0, -exponent) * found.frames.back().poses[i].com_world -
                   expected.frames.back().poses[i].com_world)
                      .norm(),
                  1e-12);
    }
  }
}

// ---- What statics do not tell

// A beam that hangs on rods of 1 m at these places along it.
scene::Scene hung_beam(const std::vector<Vector3d>& at) {
  scene::Scene scene = scene_of(
      {box("beam", {1.0, 0.5, 0.05}, 2.0, Vector3d::Zero(), Vector3d::Zero())}, 0.1, kEarth);
  for (std::size_t k = 0; k < at.size(); ++k) {
    effects::RodSpec rod;
    rod.name = fmt::format("rod {}", k);
    rod.a = {"beam", at[k]};
    rod.b = {"", at[k] + Vector3d::UnitZ()};
    rod.length_m = 1.0;
    scene.effects.of<effects::RodSpec>().push_back(rod);
  }
  scene.stabilisation = scene::StabilisationSpec{};
  return scene;
}

std::string said_of_shares(const scene::Scene& scene, const std::string& engine = "rd") {
  for (const std::string& notice : run_on(engine, scene).counters.notices)
    if (const auto end = notice.find(" are not unique"); end != std::string::npos)
      return notice.substr(0, end);
  return "";
}

// Three parallel rods in a row: two equations for three tensions. Four at the corners of a
// rectangle: three for four. Fewer are told by the levers; a rod beside the row, too, whose share
// the turning about the row tells.
TEST(Loops, WhatSharesALoadInManyWaysIsNamed) {
  const Vector3d left(-0.8, 0, 0), right(0.8, 0, 0), middle(0.1, 0, 0);
  for (const std::string engine : {"rd", "ordered"})
    EXPECT_EQ(said_of_shares(hung_beam({left, middle, right}), engine),
              "the forces of 'rod 0', 'rod 1', 'rod 2'");
  EXPECT_EQ(
      said_of_shares(hung_beam({{-0.8, -0.4, 0}, {0.8, -0.4, 0}, {0.8, 0.4, 0}, {-0.8, 0.4, 0}})),
      "the forces of 'rod 0', 'rod 1', 'rod 2', 'rod 3'");
  EXPECT_EQ(said_of_shares(hung_beam({left, right})), "");
  EXPECT_EQ(said_of_shares(hung_beam({left, right, {0.0, 0.4, 0}})), "");
  EXPECT_EQ(said_of_shares(hung_beam({left, middle, right, {0.0, 0.4, 0}})),
            "the forces of 'rod 0', 'rod 1', 'rod 2'");
}

// Its hinges could push along their parallel axes in many ways; under forces in the plane they do
// not, and statics tell what they carry.
TEST(Loops, APlaneLinkageSharesNothingInItsPlane) {
  const std::vector<Vector3d> points = {{0, 0, 0}, {0.1, 0, 0.5}, {0.9, 0, 0.7}, {1.1, 0, 0}},
                              axes(4, Vector3d::UnitY());
  EXPECT_EQ(said_of_shares(linkage(points, axes)), "");
}

// ---- What no force holds

/// Balls on a rope of rods between two walls, along these points; the walls hold its ends.
scene::Scene rope(const std::vector<Vector3d>& points) {
  std::vector<scene::BodySpec> bodies;
  for (std::size_t k = 1; k + 1 < points.size(); ++k) {
    bodies.push_back(ball(fmt::format("ball {}", k), 0.05, 1.0, points[k], Vector3d::Zero()));
    bodies.back().collides = false;
  }
  scene::Scene scene = scene_of(std::move(bodies), 0.1, kEarth);
  const auto anchor = [&](std::size_t k) {
    return k == 0 || k + 1 == points.size()
               ? scene::AnchorSpec{"", points[k]}
               : scene::AnchorSpec{fmt::format("ball {}", k), Vector3d::Zero()};
  };
  for (std::size_t k = 1; k < points.size(); ++k) {
    effects::RodSpec rod;
    rod.name = fmt::format("rod {}", k);
    rod.a = anchor(k - 1);
    rod.b = anchor(k);
    rod.length_m = (points[k] - points[k - 1]).norm();
    scene.effects.of<effects::RodSpec>().push_back(rod);
  }
  scene.stabilisation = scene::StabilisationSpec{};
  return scene;
}

std::string said_of_stretched(const scene::Scene& scene, const std::string& engine = "rd") {
  for (const std::string& notice : run_on(engine, scene).counters.notices)
    if (const auto end = notice.find(" hold their bodies as a rope"); end != std::string::npos)
      return notice.substr(0, end);
  return "";
}

// Stretched straight, two rods pull at a weight in the middle with F = m g / (2 sin 0).
TEST(Loops, ARopeThatIsStretchedStraightHoldsNothingAcross) {
  const Vector3d left(-1, 0, 0), right(1.2, 0, 0), middle(0.1, 0, 0), one(-0.3, 0, 0);
  for (const std::string engine : {"rd", "ordered"})
    EXPECT_EQ(said_of_stretched(rope({left, middle, right}), engine), "'rod 1', 'rod 2'");
  EXPECT_EQ(said_of_stretched(rope({left, one, middle, right})), "'rod 1', 'rod 2', 'rod 3'");
  // it hangs through, or its weight pulls along it, or nothing pulls at it, or it is let go
  EXPECT_EQ(said_of_stretched(rope({left, middle - 0.01 * Vector3d::UnitZ(), right})), "");
  EXPECT_EQ(said_of_stretched(rope({-Vector3d::UnitZ(), Vector3d::Zero(), Vector3d::UnitZ()})), "");
  scene::Scene still = rope({left, middle, right}), loose = rope({left, middle, right});
  effects::set_gravity(still, Vector3d::Zero());
  EXPECT_EQ(said_of_stretched(still), "");
  loose.effects.of<effects::RodSpec>().pop_back();
  EXPECT_EQ(said_of_stretched(loose), "");
  // and nothing pulls at a rope that moves evenly with its walls
  const Vector3d velocity(0, 1, 0);
  scene::Scene moving = still;
  moving.bodies[0].velocity_m_s = velocity;
  auto& rods = moving.effects.of<effects::RodSpec>();
  for (auto [name, anchor] : {std::pair{"left", &rods[0].a}, std::pair{"right", &rods[1].b}}) {
    scene::BodySpec wall = box(name, {0.1, 0.1, 0.1}, 1.0, anchor->point_m, Vector3d::Zero());
    wall.mass_kg.reset();
    wall.immovable = true;
    wall.collides = false;
    wall.motion.emplace().velocity_m_s = velocity;
    moving.bodies.push_back(wall);
    *anchor = {name, Vector3d::Zero()};
  }
  EXPECT_EQ(said_of_stretched(moving), "");
}

// A net of 10 by 10 knots has 180 rods. Stretched between two corners, its first row is such a
// rope, and so is one of 200 rods; a net whose first row hangs through by a tenth is held.
TEST(Loops, ANetThatIsStretchedStraightIsNamedWhateverItsSize) {
  constexpr int kSide = 10;
  constexpr double kMesh = 0.1;  // [m]
  const auto net = [](double sag) {
    std::vector<scene::BodySpec> bodies;
    const auto is_pinned = [](int i, int j) { return i == 0 && (j == 0 || j == kSide - 1); };
    const auto place = [&](int i, int j) {
      const double along = static_cast<double>(j) / (kSide - 1);
      return Vector3d(kMesh * j, kMesh * i, i == 0 ? -sag * 4 * along * (1 - along) : 0.0);
    };
    const auto name = [](int i, int j) { return fmt::format("{} {}", i, j); };
    scene::Scene scene = scene_of({}, 0.005, kEarth);
    const auto anchor = [&](int i, int j) {
      return is_pinned(i, j) ? scene::AnchorSpec{"", place(i, j)}
                             : scene::AnchorSpec{name(i, j), Vector3d::Zero()};
    };
    const auto tie = [&](const std::string& tied, int i, int j, int k, int l) {
      effects::RodSpec rod;
      rod.name = tied;
      rod.a = anchor(i, j);
      rod.b = anchor(k, l);
      rod.length_m = (place(i, j) - place(k, l)).norm();
      scene.effects.of<effects::RodSpec>().push_back(rod);
    };
    for (int i = 0; i < kSide; ++i)
      for (int j = 0; j < kSide; ++j) {
        if (!is_pinned(i, j)) {
          scene.bodies.push_back(ball(name(i, j), 0.01, 0.01, place(i, j), Vector3d::Zero()));
          scene.bodies.back().collides = false;
        }
        if (j + 1 < kSide) tie(fmt::format("row {} {}", i, j), i, j, i, j + 1);
        if (i + 1 < kSide) tie(fmt::format("column {} {}", i, j), i, j, i + 1, j);
      }
    scene.stabilisation = scene::StabilisationSpec{};
    return scene;
  };
  EXPECT_EQ(said_of_stretched(net(0.0)), "'row 0 0', 'row 0 1', 'row 0 2', 'row 0 3' and 5 more");
  EXPECT_EQ(said_of_stretched(net(kMesh * (kSide - 1) / 10)), "");
  std::vector<Vector3d> points;
  for (int k = 0; k <= 200; ++k) points.emplace_back(0.1 * k, 0.0, 0.0);
  EXPECT_EQ(said_of_stretched(rope(points)), "'rod 1', 'rod 2', 'rod 3', 'rod 4' and 196 more");
}

// Flat, a parallelogram of a bar on cranks goes on as long as all cranks turn alike. Where one turns
// and one stands the bar would stretch: by the square of the angle.
TEST(Loops, AFlatLinkageIsNamedWhereItCannotGoOn) {
  const auto flat = [](double rate_of_last) {
    std::vector<scene::BodySpec> bodies;
    const auto add = [&](const std::string& name, const Vector3d& at, double rate, double radius) {
      bodies.push_back(box(name, {0.2, 0.02, 0.02}, 1.0, at, {0, 0, rate * radius}));
      bodies.back().omega_world_rad_s = {0, -rate, 0};
      bodies.back().collides = false;
    };
    add("first", {0.2, 0, 0}, 5, 0.2);
    add("second", {0.7, 0, 0}, 5, 0.2);
    add("third", {1.2, 0, 0}, rate_of_last, 0.2);
    bodies.push_back(
        box("bar", {0.5, 0.02, 0.02}, 1.0, {0.9, 0, 0}, {0, 0, 0.4 * (5 + rate_of_last) / 2}));
    // its ends go up by 0.4 m times the rates of the first crank and the last
    bodies.back().omega_world_rad_s = {0, -0.4 * (rate_of_last - 5), 0};
    bodies.back().collides = false;
    scene::Scene scene = scene_of(std::move(bodies), 0.1, Vector3d::Zero());
    scene.stabilisation = scene::StabilisationSpec{};
    const auto hinge = [&](const std::string& a, const std::string& b, double x) {
      scene.effects.of<effects::JointSpec>().push_back({a + " at " + (b.empty() ? "base" : b),
                                                        effects::JointKind::kHinge,
                                                        a,
                                                        b,
                                                        {x, 0, 0},
                                                        Vector3d::UnitY()});
    };
    hinge("first", "", 0.0);
    hinge("third", "", 1.0);
    hinge("first", "bar", 0.4);
    hinge("third", "bar", 1.4);
    if (rate_of_last == 5) {
      hinge("second", "", 0.5);
      hinge("second", "bar", 0.9);
    } else {
      scene.bodies.erase(scene.bodies.begin() + 1);
    }
    return scene;
  };
  EXPECT_EQ(said_of_stretched(flat(5)), "");
  EXPECT_NE(said_of_stretched(flat(0)), "");
}

}  // namespace loops_test
}  // namespace tumble::testing
