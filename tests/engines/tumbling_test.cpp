// Whatever bodies do, none enters another: random solids in a closed room, at rest, in corners and
// between walls.
#include <cmath>
#include <random>

#include "tests/support/places.h"
#include "tests/engines/scenes.h"
#include "tests/support/story.h"

namespace tumble::testing {
namespace {

class RandomNumbers {
 public:
  explicit RandomNumbers(unsigned seed) : random_(seed) {}
  double in(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  Vector3d vector(double size) { return {in(-size, size), in(-size, size), in(-size, size)}; }

 private:
  std::mt19937_64 random_;
};

scene::BodySpec model(const std::string& name, const std::string& file, double extent_m,
                      const Vector3d& position) {
  scene::BodySpec body = ball(name, 1.0, 1.0, position, Vector3d::Zero());
  body.shape = scene::ModelSpec{test::source_dir() + "/models/" + file, "", extent_m};
  return body;
}

/// Six walls around the cube of side 2 * half about the origin.
void add_room(double half, double restitution, std::vector<scene::BodySpec>& bodies) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const int side : {-1, 1}) {
      bodies.push_back(
          plane("wall", side * half * Vector3d::Unit(axis), -side * Vector3d::Unit(axis)));
      bodies.back().restitution = restitution;
    }
  }
}

/// Eight bodies, one an octant, turning and flying every way.
scene::Scene tumbling_room(unsigned seed, double restitution, bool concave,
                           std::optional<Vector3d> gravity, double duration) {
  RandomNumbers random(seed);
  const char* const concave_files[] = {"torus.3ds", "l_shape.3ds", "t_handle.3ds", "dumbbell.3ds"};
  std::vector<scene::BodySpec> bodies;
  for (int k = 0; k < 8; ++k) {
    const Vector3d middle((k & 1) ? 0.5 : -0.5, (k & 2) ? 0.5 : -0.5, (k & 4) ? 0.5 : -0.5);
    const std::string name = "body " + std::to_string(k);
    if (concave && k % 2 == 0)
      bodies.push_back(model(name, concave_files[k / 2], 0.35, middle));
    else if (k % 3 == 0)
      bodies.push_back(ball(name, 0.2, 1.0, middle, Vector3d::Zero()));
    else
      bodies.push_back(box(name, {0.2, 0.15, 0.1}, 1.0, middle, Vector3d::Zero()));
    bodies.back().mass_kg = random.in(0.5, 2.0);
    bodies.back().velocity_m_s = random.vector(2.0);
    bodies.back().omega_world_rad_s = random.vector(5.0);
    bodies.back().world_from_body =
        Quaterniond(random.in(-1, 1), random.in(-1, 1), random.in(-1, 1), random.in(-1, 1))
            .normalized();
    bodies.back().restitution = restitution;
  }
  add_room(1.2, restitution, bodies);
  return scene_of(std::move(bodies), duration, gravity);
}

void expect_no_overlap(const Trajectory& result, const std::string& what) {
  EXPECT_EQ(result.stopped_by, "") << what;
  for (const Frame& frame : result.frames)
    ASSERT_GE(frame.smallest_gap, 0.0) << what << " at t = " << frame.time << " s";
}

double energy(const Frame& frame) { return frame.kinetic_energy + frame.potential_energy; }

// What a hop of a body that lies on something may add, see push_apart: below m v_rest^2 an event;
// far less is expected.
void expect_energy_never_grows(const Trajectory& result, double allowance,
                               const std::string& what) {
  for (std::size_t k = 1; k < result.frames.size(); ++k)
    ASSERT_LE(energy(result.frames[k]), energy(result.frames[k - 1]) + allowance)
        << what << " at t = " << result.frames[k].time << " s";
}

TEST(TumblingRoom, ElasticBodiesKeepTheirEnergyAndNeverOverlap) {
  for (const bool concave : {false, true}) {
    for (const unsigned seed : {1u, 2u}) {
      const std::string what =
          (concave ? "concave, seed " : "convex, seed ") + std::to_string(seed);
      const Trajectory result =
          run(tumbling_room(seed, 1.0, concave, std::nullopt, concave ? 3.0 : 6.0));
      expect_no_overlap(result, what);
      EXPECT_GT(collision_times(result).size(), 50u) << what;
      // Classical Runge-Kutta at 1/60 s loses (w h)^5 of a turning body's energy a step; impulses
      // lose nothing. A sign or an arm that is wrong in one collision of these changes the energy
      // by per cents.
      const double start = energy(result.frames.front());
      for (const Frame& frame : result.frames)
        ASSERT_NEAR(energy(frame), start, 1e-3 * start) << what << " at " << frame.time;
    }
  }
}

TEST(TumblingRoom, UnderGravityNothingOverlapsAndEnergyOnlyFalls) {
  int seed = 10;
  for (const double restitution : {0.8, 0.5}) {
    for (const bool concave : {false, true}) {
      const std::string what =
          std::string(concave ? "concave" : "convex") + ", e = " + std::to_string(restitution);
      const Trajectory result =
          run(tumbling_room(seed++, restitution, concave, Vector3d(0, 0, -9.81), 1.0));
      expect_no_overlap(result, what);
      EXPECT_GT(collision_times(result).size(), 20u) << what;
      expect_energy_never_grows(result, 1e-3 * energy(result.frames.front()), what);
    }
  }
}

// A body of weight g that hops at the restitution threshold v is in the air for 2 v / g: with 1e-2
// m/s some 500 hops a second.
scene::Scene resting(std::vector<scene::BodySpec> bodies, double duration) {
  for (scene::BodySpec& body : bodies) body.restitution = 0.0;
  auto scene = scene_of(std::move(bodies), duration, Vector3d(0, 0, -9.81));
  scene.rest_speed_m_s = 1e-2;
  return scene;
}

TEST(Resting, ABoxThatDoesNotBounceStaysOnTheFloor) {
  const Trajectory result =
      run(resting({box("box", {0.2, 0.2, 0.1}, 1.0, {0, 0, 0.3}, Vector3d::Zero()),
                   plane("floor", Vector3d::Zero(), Vector3d::UnitZ())},
                  1.0));
  expect_no_overlap(result, "box");
  // Hops of the restitution threshold reach v^2 / 2g = 5e-6 m.
  EXPECT_NEAR(result.frames.back().poses[0].com_world.z(), 0.1, 1e-4);
}

TEST(Resting, ABallInACornerOfTwoWallsAndTheFloorStaysThere) {
  const Trajectory result = run(resting({ball("ball", 0.1, 1.0, {0.3, 0.3, 0.5}, {-1, -1, 0}),
                                         plane("floor", Vector3d::Zero(), Vector3d::UnitZ()),
                                         plane("wall x", Vector3d::Zero(), Vector3d::UnitX()),
                                         plane("wall y", Vector3d::Zero(), Vector3d::UnitY())},
                                        1.5));
  expect_no_overlap(result, "corner");
  // Without friction it drifts from each wall at the restitution threshold, 1e-2 m/s, at most.
  const Vector3d drift = result.frames.back().poses[0].com_world - Vector3d(0.1, 0.1, 0.1);
  EXPECT_LT(drift.maxCoeff(), 1.5 * 1e-2);
  EXPECT_NEAR(drift.z(), 0.0, 1e-4);
}

TEST(Resting, ABallInAWedgeStaysThere) {
  const Trajectory result =
      run(resting({ball("ball", 0.1, 1.0, {0.05, 0, 0.6}, Vector3d::Zero()),
                   plane("left", Vector3d::Zero(), Vector3d(1, 0, 1).normalized()),
                   plane("right", Vector3d::Zero(), Vector3d(-1, 0, 1).normalized())},
                  1.0));
  expect_no_overlap(result, "wedge");
}

// A frictionless slope holds nothing: a ball that met it slides down as x = g sin(a) t^2 / 2 along
// it.
TEST(Resting, ABallOnASlopeSlidesDown) {
  const double slope = 0.5;  // rad
  scene::BodySpec floor =
      plane("slope", Vector3d::Zero(), Vector3d(std::sin(slope), 0, std::cos(slope)));
  const Vector3d start = 0.1 * Vector3d(std::sin(slope), 0, std::cos(slope));
  auto scene = resting({ball("ball", 0.1, 1.0, start, Vector3d::Zero()), floor}, 1.0);
  const Trajectory result = run(scene);
  expect_no_overlap(result, "slope");
  const Vector3d way = result.frames.back().poses[0].com_world - start;
  const Vector3d down(std::cos(slope), 0, -std::sin(slope));
  // Hops of the restitution threshold, 1e-2 m/s, lengthen no way along the slope: their time is the
  // same. 1e-3 is a hop's height with room.
  EXPECT_NEAR(way.dot(down), 0.5 * 9.81 * std::sin(slope), 1e-3);
}

TEST(Resting, ABallThatSpinsWhereItLiesSpinsOn) {
  auto spinning = ball("ball", 0.1, 1.0, {0, 0, 0.2}, Vector3d::Zero());
  spinning.omega_world_rad_s = {0, 0, 100};
  const Trajectory result =
      run(resting({spinning, plane("floor", Vector3d::Zero(), Vector3d::UnitZ())}, 1.0));
  expect_no_overlap(result, "spin");
  // No friction, no torque: the same bits would be right; 1e-12 are 1e4 roundings of 100 rad/s.
  EXPECT_NEAR(result.frames.back().poses[0].omega_world.z(), 100.0, 1e-10);
}

// A ball in flight hits two that rest: both take their share, none of the momentum goes into the
// floor.
TEST(Resting, ABreakShotKeepsTheMomentumAlongTheFloor) {
  const Trajectory result = run(resting({ball("cue", 0.1, 1.0, {-1, 0, 0.1}, {2, 0, 0}),
                                         ball("one", 0.1, 1.0, {0, 0.11, 0.1}, Vector3d::Zero()),
                                         ball("two", 0.1, 1.0, {0, -0.11, 0.1}, Vector3d::Zero()),
                                         plane("floor", Vector3d::Zero(), Vector3d::UnitZ())},
                                        1.5));
  expect_no_overlap(result, "break");
  EXPECT_NEAR(result.frames.back().momentum_world.x(), 2.0, 1e-12);
  EXPECT_GT(result.frames.back().poses[1].velocity_world.x(), 0.1);
  // the sequential law goes through pairs in order: no mirror symmetry
  EXPECT_NEAR(result.frames.back().momentum_world.y(), 0.0, 0.05);
}

// Persistent contact of two bodies that both move is not this engine's yet: what it must not do is
// overlap them or go on silently.
TEST(Resting, TwoBoxesInAStackNeverOverlapAndAStallIsNamed) {
  const Trajectory result =
      run(resting({box("lower", {0.2, 0.2, 0.1}, 1.0, {0, 0, 0.1}, Vector3d::Zero()),
                   box("upper", {0.15, 0.15, 0.1}, 1.0, {0, 0, 0.35}, Vector3d::Zero()),
                   plane("floor", Vector3d::Zero(), Vector3d::UnitZ())},
                  0.5));
  for (const Frame& frame : result.frames) EXPECT_GE(frame.smallest_gap, 0.0) << frame.time;
  if (!result.stopped_by.empty()) {
    EXPECT_NE(result.stopped_by.find("'lower'"), std::string::npos) << result.stopped_by;
    EXPECT_NE(result.stopped_by.find("'upper'"), std::string::npos) << result.stopped_by;
  }
}

TEST(Resting, ABallBetweenTwoWallsThatLeaveARoundingOfRoomIsNotPushedIntoEither) {
  auto scene = scene_of({ball("ball", 0.1, 1.0, {0, 0, 0}, {1, 0, 0.5}),
                         plane("left", {-0.1 - 1e-9, 0, 0}, Vector3d::UnitX()),
                         plane("right", {0.1 + 1e-9, 0, 0}, -Vector3d::UnitX())},
                        2e-6);
  const Trajectory result = run(scene, test_laws(), 1e7);
  expect_no_overlap(result, "between walls");
  EXPECT_GT(collision_times(result).size(), 500u);
}

}  // namespace
}  // namespace tumble::testing
