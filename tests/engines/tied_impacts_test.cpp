// Two impacts of one body at one instant: the sequential law takes them in the order of bodies, and
// says so where that decides what comes of them.
#include <algorithm>
#include <array>
#include <cstdint>
#include <tuple>

#include <gtest/gtest.h>

#include "framework/core/random.h"
#include "framework/core/shortest_turn.h"
#include "tests/engines/reference_runs.h"

namespace tumble::testing::tied_impacts_test {
namespace {

// A ball of mass 1 rests at the origin; two of mass m, at the same distance and speed, hit it at
// one instant, from directions that make the angle `between`.
scene::Scene hit_by_two(double mass, double restitution, double between,
                        std::optional<scene::ImpactLaw> law) {
  std::vector<scene::BodySpec> bodies{
      ball("rests", 0.125, 1.0, Vector3d::Zero(), Vector3d::Zero())};
  for (const double side : {-0.5, 0.5}) {
    const Vector3d from(std::cos(side * between), std::sin(side * between), 0.0);
    bodies.push_back(ball(side < 0 ? "one" : "two", 0.125, mass, 0.75 * from, -from));
  }
  for (scene::BodySpec& body : bodies) body.restitution = restitution;
  scene::Scene scene = scene_of(std::move(bodies), 1.0);
  if (law) {
    scene.contact = scene::ContactSpec{};
    scene.contact->impact_law = *law;
  }
  return scene;
}

bool says_order(const Trajectory& run) {
  for (const std::string& notice : run.counters.notices)
    if (notice.find("'rests' meets 'one' and 'two' at one instant") != std::string::npos)
      return notice.find("impact_law\": \"simultaneous\"") != std::string::npos;
  return false;
}

// Across the line of symmetry, which is x, the ball at rest must not move.
double asymmetry(const Trajectory& run) {
  return std::abs(run.frames.back().poses[0].velocity_world.y());
}

constexpr double kThird = M_PI / 3;  // of the balls of a rack

TEST(ImpactsAtOneInstant, WhoseOrderDecidesAreReportedWithTheLawThatIsSymmetric) {
  const Trajectory run = run_on("rd", hit_by_two(1.0, 0.9, kThird, scene::ImpactLaw::kSequential));
  EXPECT_GT(asymmetry(run), 0.1);
  EXPECT_TRUE(says_order(run));
  const scene::Scene simultaneous = hit_by_two(1.0, 0.9, kThird, scene::ImpactLaw::kSimultaneous);
  const Trajectory together = run_on("rd", simultaneous);
  EXPECT_LT(asymmetry(together), 1e-12) << "rounding of speeds of 1 m/s";
  EXPECT_FALSE(says_order(together));
  EXPECT_TRUE(together.counters.notices.empty());
  // events have an order, and so have impacts of bodies that fly freely
  ASSERT_FALSE(run_on("ordered", simultaneous).counters.notices.empty());
  EXPECT_NE(run_on("ordered", simultaneous).counters.notices[0].find("--engine rd takes all"),
            std::string::npos);
  EXPECT_TRUE(says_order(run_on("rd", hit_by_two(1.0, 0.9, kThird, std::nullopt))));
  EXPECT_TRUE(says_order(run_on("rd", hit_by_two(0.5, 0.9, M_PI, std::nullopt))));
}

// Equal elastic balls in a line hand their speeds on, at right angles neither impact feels the
// other, and a ball that hits a row meets one that meets the next: one result in either order.
TEST(ImpactsAtOneInstant, WhoseOrderDecidesNothingAreNotReported) {
  EXPECT_FALSE(says_order(run_on("rd", hit_by_two(1.0, 1.0, M_PI, std::nullopt))));
  EXPECT_FALSE(says_order(run_on("rd", hit_by_two(2.0, 0.5, M_PI / 2, std::nullopt))));
  std::vector<scene::BodySpec> row{ball("hits", 0.125, 1.0, {-0.75, 0, 0}, {1, 0, 0})};
  for (int k = 0; k < 3; ++k)
    row.push_back(ball("row" + std::to_string(k), 0.125, 1.0, {0.25 * k, 0, 0}, Vector3d::Zero()));
  for (scene::BodySpec& body : row) body.restitution = 0.9;
  for (const std::string& notice : run_on("rd", scene_of(std::move(row), 1.0)).counters.notices)
    EXPECT_EQ(notice.find("at one instant"), std::string::npos) << notice;
}

// A ball comes to a row of three, (1 | 0.3 0.3 1): at first each impact causes the next, but at the
// third the light ones part, and the first light one meets the one behind it and the one before it.
// Which comes first decides between (-0.226, 0.646, 0.696, 0.824) and (-0.092, 0, 0.406, 0.971) of
// the speed: two sequences of laws of conservation, of which engines take one each.
TEST(ImpactsAtOneInstant, ThatEarlierOnesCauseAreReportedWhereTheirOrderDecides) {
  const auto row_of = [](const std::array<double, 4>& masses) {
    std::vector<scene::BodySpec> row;
    for (int k = 0; k < 4; ++k)
      row.push_back(ball("b" + std::to_string(k), 0.125, masses[static_cast<std::size_t>(k)],
                         {k == 0 ? -0.5 : 0.25 * k, 0, 0}, {k == 0 ? 1.0 : 0.0, 0, 0}));
    return scene_of(std::move(row), 1.0);
  };
  const auto says = [](const Trajectory& run) {
    for (const std::string& notice : run.counters.notices)
      if (notice.find("at one instant") != std::string::npos) return true;
    return false;
  };
  for (const char* engine : {"rd", "ordered", "ca", "tw"})
    for (const bool contact : {false, true}) {
      SCOPED_TRACE(engine);
      scene::Scene unequal = row_of({1.0, 0.3, 0.3, 1.0}), equal = row_of({1.0, 1.0, 1.0, 1.0}),
                   falling = row_of({1.0, 0.9, 0.7, 0.5});
      for (scene::Scene* scene : {&unequal, &equal, &falling})
        if (contact) scene->contact.emplace();
      EXPECT_TRUE(says(run_on(engine, unequal)));
      EXPECT_FALSE(says(run_on(engine, equal))) << "Newton's cradle";
      EXPECT_FALSE(says(run_on(engine, falling))) << "each leaves the one before it";
    }
}

constexpr const char* kEventEngines[] = {"ordered", "ca", "tw"};

// Bodies that fly freely meet pair by pair. A light ball leaves the first of two heavy ones at 1.9
// times their speed: at 45 degrees to the second one's way that is faster than the second follows,
// and no second impact is left to see.
TEST(ImpactsAtOneInstant, OfBodiesThatFlyFreelyAreReportedByEventEngines) {
  const scene::Scene escapes = hit_by_two(1e3, 0.9, M_PI / 4, std::nullopt);
  for (const char* engine : kEventEngines) {
    SCOPED_TRACE(engine);
    const Trajectory run = run_on(engine, hit_by_two(1.0, 0.9, kThird, std::nullopt));
    EXPECT_GT(asymmetry(run), 0.1);
    EXPECT_TRUE(says_order(run));
    EXPECT_TRUE(
        says_order(run_on(engine, hit_by_two(1.0, 0.9, kThird, scene::ImpactLaw::kSequential))));
    EXPECT_TRUE(says_order(run_on(engine, hit_by_two(0.5, 0.9, M_PI, std::nullopt))));
    const std::vector<Event> events = run_on(engine, escapes).events;
    EXPECT_GT(events.at(1).time, events.at(0).time);
    EXPECT_TRUE(says_order(run_on(engine, escapes)));
  }
}

TEST(ImpactsAtOneInstant, WhoseOrderDecidesNothingAreNotReportedByEventEngines) {
  for (const char* engine : kEventEngines) {
    SCOPED_TRACE(engine);
    EXPECT_FALSE(says_order(run_on(engine, hit_by_two(1.0, 1.0, M_PI, std::nullopt))));
    EXPECT_FALSE(says_order(run_on(engine, hit_by_two(2.0, 0.5, M_PI / 2, std::nullopt))));
  }
}

// A light ball that touches two heavy ones goes to and fro between them some hundred times at the
// instant at which the first is hit, as fast as ever, until the two part faster: all of it elastic,
// in contact as without.
TEST(ImpactsAtOneInstant, OfALightBallBetweenHeavyOnesKeepTheirRestitution) {
  for (const double light : {1e-3, 1e-4})
    for (const char* engine : {"rd", "tw"}) {
      SCOPED_TRACE(light);
      scene::Scene scene = scene_of({ball("first", 0.5, 1.0, {-1.5, 0, 0}, Vector3d::UnitX()),
                                     ball("light", 0.5, light, {0, 0, 0}, Vector3d::Zero()),
                                     ball("last", 0.5, 1.0, {1, 0, 0}, Vector3d::Zero())},
                                    1.0);
      scene.contact.emplace();
      const Trajectory run = run_on(engine, scene);
      EXPECT_EQ(run.stopped_by, "");
      EXPECT_NEAR(run.frames.back().kinetic_energy, 0.5, 1e-12) << "rounding of some 200 impulses";
      double momentum = 0.0, before = -1e300;
      for (int body = 0; body < 3; ++body) {
        const double v = run.frames.back().poses[static_cast<std::size_t>(body)].velocity_world.x();
        momentum += v * *scene.bodies[static_cast<std::size_t>(body)].mass_kg;
        EXPECT_GE(v, before) << "none goes into the next one";
        before = v;
      }
      EXPECT_NEAR(momentum, 1.0, 1e-12);
    }
}

// Where surfaces rebound by less, rounds end while the light ball is as fast as ever. What is left is
// resolved without rebound, and the run says so.
TEST(ImpactsAtOneInstant, ThatLeaveOutReboundsSaySo) {
  for (const double restitution : {0.0, 0.3, 1.0})
    for (const char* engine : {"rd", "tw"}) {
      SCOPED_TRACE(restitution);
      scene::Scene scene = scene_of({ball("first", 0.5, 1.0, {-1.5, 0, 0}, Vector3d::UnitX()),
                                     ball("light", 0.5, 1e-4, {0, 0, 0}, Vector3d::Zero()),
                                     ball("last", 0.5, 1.0, {1, 0, 0}, Vector3d::Zero())},
                                    1.0);
      for (scene::BodySpec& body : scene.bodies) body.restitution = restitution;
      scene.contact.emplace();
      const std::vector<std::string> notices = run_on(engine, scene).counters.notices;
      const bool is_said = std::any_of(notices.begin(), notices.end(), [](const std::string& said) {
        return said.find("was resolved without rebound") != std::string::npos;
      });
      EXPECT_EQ(is_said, restitution == 0.3) << engine;
    }
}

// Two cubes that fly at each other, turned so that edge meets parallel edge (about z by 45 degrees),
// or corner meets corner (diagonals along x). `aside` is how far the second passes beside the first.
scene::Scene head_on(const Quaterniond& turn, double aside) {
  std::vector<scene::BodySpec> bodies{
      box("left", {0.5, 0.5, 0.5}, 1.0, {-2, 0, 0}, {1, 0, 0}),
      box("right", {0.5, 0.5, 0.5}, 2.0, {2, aside, 0}, {-1, 0, 0})};
  for (scene::BodySpec& body : bodies) {
    body.world_from_body = turn;
    body.restitution = 0.5;
  }
  return scene_of(std::move(bodies), 4.0);
}
Quaterniond edges_first() { return Quaterniond(Eigen::AngleAxisd(M_PI / 4, Vector3d::UnitZ())); }
Quaterniond corners_first() { return shortest_turn(Vector3d(1, 1, 1), Vector3d::UnitX()); }

bool says_normal(const Trajectory& run) {
  return std::any_of(
      run.counters.notices.begin(), run.counters.notices.end(), [](const std::string& notice) {
        return notice.find("'left' meets 'right' corner on corner") != std::string::npos;
      });
}

// By symmetry nothing moves but along x, and restitution tells how fast. A normal of faces, along
// which two cubes are apart as well, would send them aside, and a rounding of places to which side.
TEST(ImpactsWithSeveralNormals, KeepTheSymmetryOfWhatMeets) {
  for (const char* engine : {"rd", "ordered", "ca", "tw"})
    for (const Quaterniond& turn : {edges_first(), corners_first()})
      for (const double aside : {0.0, 1e-13}) {
        const Trajectory run = run_on(engine, head_on(turn, aside));
        ASSERT_FALSE(run.events.empty());
        // (m1 u1 + m2 u2 +- m e (u2 - u1)) / (m1 + m2) of 1 and 2 kg at 1 and -1 m/s
        const double expected[] = {(1 - 2 - 2 * 0.5 * 2) / 3.0, (1 - 2 + 1 * 0.5 * 2) / 3.0};
        for (std::size_t k = 0; k < 2; ++k)
          // 1e-9: the arms of the impulse, of some 1e-13 m, and 2 s of turning
          EXPECT_LT(
              (run.frames.back().poses[k].velocity_world - expected[k] * Vector3d::UnitX()).norm(),
              1e-9)
              << engine << ' ' << aside;
        EXPECT_TRUE(says_normal(run)) << engine;
      }
}

/// A box and its mirror image, drawn by lot, that fly at each other: corners or edges meet.
scene::Scene box_and_image(Random& random) {
  const auto drawn = [&](double size) {
    return Vector3d(random.between(-size, size), random.between(-size, size),
                    random.between(-size, size));
  };
  const auto image = [](const Vector3d& x) { return Vector3d(-x.x(), x.y(), x.z()); };
  const Vector3d half(random.between(0.1, 0.5), random.between(0.1, 0.5), random.between(0.1, 0.5)),
      place(random.between(-2.5, -1.5), random.between(-1, 1), random.between(-1, 1)),
      velocity(random.between(1.5, 3.0), random.between(-1, 1), random.between(-1, 1)),
      axis = drawn(1.0).normalized(), spin = drawn(3.0);
  const double angle = random.between(0, 3), restitution = random.between(0.3, 1.0);
  std::vector<scene::BodySpec> bodies{box("left", half, 1.0, place, velocity),
                                      box("right", half, 1.0, image(place), image(velocity))};
  // what turns about an axis has an image that turns about minus the axis' image
  bodies[0].world_from_body = Eigen::AngleAxisd(angle, axis);
  bodies[1].world_from_body = Eigen::AngleAxisd(angle, -image(axis));
  bodies[0].omega_world_rad_s = spin;
  bodies[1].omega_world_rad_s = -image(spin);
  for (scene::BodySpec& body : bodies) body.restitution = restitution;
  return scene_of(std::move(bodies), 2.0);
}

TEST(ImpactsWithSeveralNormals, ABoxAndItsImageDrawnByLotStayImages) {
  int met = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    Random random(seed);
    const scene::Scene scene = box_and_image(random);
    for (const char* engine : {"rd", "ordered", "ca", "tw"}) {
      const Trajectory run = run_on(engine, scene);
      met += run.events.empty() ? 0 : 1;
      const auto& [one, two] = std::tie(run.frames.back().poses[0], run.frames.back().poses[1]);
      const Vector3d sum(one.com_world.x() + two.com_world.x(),
                         one.com_world.y() - two.com_world.y(),
                         one.com_world.z() - two.com_world.z());
      // m: roundings of 1e-15 at an impact, grown by a second of turning and a few further impacts
      EXPECT_LT(sum.norm(), 1e-9) << engine << ", seed " << seed;
    }
  }
  EXPECT_GT(met, 40);  // of 48 runs
}

// With a tenth of the edge beside each other, an edge meets a face.
TEST(ImpactsWithSeveralNormals, AreNotThoseOfEdgesOnFaces) {
  for (const char* engine : {"rd", "ordered", "ca", "tw"})
    EXPECT_FALSE(says_normal(run_on(engine, head_on(edges_first(), 0.1)))) << engine;
}

// Side flush with side, but for a rounding: along the normal of the sides the cubes do not approach,
// and where faces that meet by 1e-13 m stop them, their own normal does.
TEST(ImpactsWithSeveralNormals, ActAlongOneWhereBodiesPassAlongAnother) {
  for (const char* engine : {"rd", "ordered", "ca", "tw"}) {
    const Trajectory run = run_on(
        engine, scene_of({box("left", {0.5, 0.5, 0.5}, 1.0, {0, 0, 0}, {0, 0, -1}),
                          box("right", {0.5, 0.5, 0.5}, 2.0, {1.0 - 1e-13, 0, -2}, {0, 0, 1})},
                         1.0));
    ASSERT_FALSE(run.events.empty()) << engine;
    EXPECT_EQ(run.events[0].normal_b_to_a_world, Vector3d::UnitZ()) << engine;
    EXPECT_FALSE(says_normal(run)) << engine;
  }
}

// A cube that lands flat on another, side above side, has one normal.
TEST(ImpactsWithSeveralNormals, AreNotThoseOfFacesThatFitEachOther) {
  std::vector<scene::BodySpec> bodies{box("left", {0.5, 0.5, 0.5}, 1.0, {0, 0, 3}, {0, 0, -1}),
                                      box("right", {0.5, 0.5, 0.5}, 2.0, {0, 0, 0}, {0, 0, 1})};
  for (const char* engine : {"rd", "ordered"})
    EXPECT_TRUE(run_on(engine, scene_of(bodies, 3.0)).counters.notices.empty()) << engine;
}

}  // namespace
}  // namespace tumble::testing::tied_impacts_test
