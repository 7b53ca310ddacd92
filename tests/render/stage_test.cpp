// Marks of a drawing: the scale bar where it is visible, paths with their corners.
#include <algorithm>
#include <map>
#include <numbers>

#include <gtest/gtest.h>

#include "framework/render/camera.h"
#include "framework/render/stage.h"
#include "framework/render/stage_geometries.h"
#include "framework/render/surfaces.h"
#include "tests/render/render_fixtures.h"

namespace tumble::render {
namespace {

const BodyPose kAtOrigin{Vector3d::Zero(), Quaterniond::Identity(), Vector3d::Zero(),
                         Vector3d::Zero()};

PictureOptions as_shown() {
  PictureOptions options;
  options.width = 640;
  options.height = 480;
  return options;
}

/// The falling ball with an impulse, and its camera, moved by `shift`.
struct ShiftedBall {
  scene::Scene scene = falling_ball();
  Trajectory run = ball_at(2.0);
};

ShiftedBall shifted(const Vector3d& shift) {
  ShiftedBall moved;
  moved.scene.camera.eye_m += shift;
  moved.scene.camera.target_m += shift;
  moved.run.events.push_back(
      {0.5, EventKind::kCollision, 0, 1, {0, 0, 1.2}, {0, 0, 1}, 1.0, -1.0, 1.0});
  for (Event& event : moved.run.events) event.point_world += shift;
  for (Frame& frame : moved.run.frames)
    for (BodyPose& pose : frame.poses) pose.com_world += shift;
  return moved;
}

std::vector<Instance> instances_of(const ShiftedBall& ball) {
  std::vector<Instance> all;
  for (const Batch& batch : Stage(ball.scene, ball.run, as_shown()).moment(1).drawing.batches)
    all.insert(all.end(), batch.instances.begin(), batch.instances.end());
  return all;
}

// A low wall across the lower part of the picture, in front of the place where the bar would be
// without it.
TEST(Stage, ScaleBarIsWhereNoWallHidesIt) {
  scene::Scene scene = falling_ball();
  scene.grid_spacing_m = 0.5;
  const auto middle_of_bar = [](const Stage& stage) {
    return stage.moment(0).labels.back().point_world;
  };
  const Trajectory alone = ball_at(2.0);
  const Vector3d wanted = middle_of_bar(Stage(scene, alone, as_shown()));

  const View view = view_of(scene.camera);
  scene::BodySpec wall;
  wall.name = "wall";
  wall.shape = scene::BoxSpec{{4.0, 0.02, 0.15}};
  wall.immovable = true;
  wall.position_m = wanted + 0.1 * (view.eye_world - wanted).normalized();
  scene.bodies.push_back(wall);
  Trajectory run = alone;
  run.bodies.push_back({"wall", true});
  BodyPose pose = kAtOrigin;
  pose.com_world = wall.position_m;
  for (Frame& frame : run.frames) frame.poses.push_back(pose);

  const TriangleMesh surface = surface_of(Box{{4.0, 0.02, 0.15}});
  ASSERT_TRUE(hides(surface, pose, view.eye_world, wanted));
  const Stage stage(scene, run, as_shown());
  ASSERT_TRUE(stage.has_scale_bar());
  EXPECT_FALSE(hides(surface, pose, view.eye_world, middle_of_bar(stage)));
}

// The body's +z has six pips and the opposite side one, wherever the body has turned to.
TEST(Stage, ADieShowsItsPipsOnTheFacesTheyBelongTo) {
  constexpr double kHalf = 0.1, kRoundOff = 1e-6;  // m; pictures are of single precision
  scene::Scene scene = falling_ball();
  scene.bodies[0].shape = scene::BoxSpec{Vector3d::Constant(kHalf)};
  scene.bodies[0].drawn_as_die = true;
  Trajectory run = ball_at(1.0);
  BodyPose& pose = run.frames[0].poses[0];
  pose.world_from_body = Quaterniond(Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized()));
  std::map<std::pair<int, bool>, int> pips;  // by axis and side
  for (const Batch& batch : Stage(scene, run, as_shown()).moment(0).drawing.batches)
    for (const Instance& instance : batch.instances) {
      if (batch.geometry != kBall + 1) continue;
      const float* m = instance.world_from_local;
      const Vector3d place =
          pose.world_from_body.conjugate() * (Vector3d(m[3], m[7], m[11]) - pose.com_world);
      for (int axis = 0; axis < 3; ++axis)
        if (std::abs(std::abs(place[axis]) - kHalf) < kRoundOff) ++pips[{axis, place[axis] > 0}];
    }
  ASSERT_EQ(pips.size(), 6u);
  EXPECT_EQ((pips[{2, true}]), 6);
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_EQ((pips[{axis, true}] + pips[{axis, false}]), 7) << "axis " << axis;
}

// A body that flies off takes the far plane along, but not the near one past what is looked at.
TEST(Stage, WhatIsLookedAtIsSeenHoweverFarABodyGoes) {
  const scene::Scene scene = falling_ball();
  const double sight = (scene.camera.target_m - scene.camera.eye_m).norm();
  for (const double distance : {0.0, 1e2, 1e4, 1e8, 1e200}) {
    Trajectory run = ball_at(2.0);
    run.frames.back().poses[0].com_world.x() = distance;
    const Drawing drawing = Stage(scene, run, as_shown()).moment(0).drawing;
    EXPECT_GT(drawing.near_m, 0.0) << distance;
    EXPECT_LE(drawing.near_m, 0.01 * sight) << distance;
    EXPECT_GT(drawing.far_m, std::min(distance, 1e3 * sight)) << distance;
    EXPECT_LE(drawing.far_m, 1e4 * sight) << distance;
  }
}

// The same motion 5000 km away: its instances are placed as well as at the world's origin.
TEST(Stage, FarFromTheOriginBodiesAreDrawnAsNearIt) {
  const Vector3d away(5e6, -5e6, 1e6);  // on a crossing of the grid's lines, which are 1 m apart
  const auto near = instances_of(shifted(Vector3d::Zero())), far = instances_of(shifted(away));
  ASSERT_EQ(near.size(), far.size());
  ASSERT_GT(near.size(), 5u);  // the ball, its path, the bar, the impulse
  // Doubles at 5e6 m have a spacing of 1e-9 m, floats at 6 m one of 5e-7 m, but 0.5 m at 5e6 m.
  constexpr float kRoundOff = 2e-6f;
  for (std::size_t i = 0; i < near.size(); ++i)
    for (int k = 0; k < 12; ++k)
      EXPECT_NEAR(near[i].world_from_local[k], far[i].world_from_local[k], kRoundOff);
}

// A tilt of 0.1 degrees is 9 mm over 5 m: bodies on a floor that is drawn level would penetrate it.
TEST(Stage, OnlyALevelFloorIsDrawnAsTheGround) {
  scene::Scene scene = falling_ball();
  const auto has_ground = [&](double tilt_deg) {
    const Quaterniond turn(
        Eigen::AngleAxisd(tilt_deg * std::numbers::pi / 180.0, Vector3d::UnitX()));
    scene.bodies[1].world_from_body = turn;
    Trajectory run = ball_at(2.0);
    for (Frame& frame : run.frames) frame.poses[1].world_from_body = turn;
    return Stage(scene, run, as_shown()).moment(0).drawing.ground.shown;
  };
  EXPECT_TRUE(has_ground(0.0));
  EXPECT_FALSE(has_ground(0.1));
  EXPECT_FALSE(has_ground(2.0));
}

Trajectory with_impulse(Trajectory run, double impulse) {
  run.events.push_back(
      {0.5, EventKind::kCollision, 0, 1, {0, 0, 1.2}, {0, 0, 1}, impulse, -1.0, 1.0});
  return run;
}

// The length of an arrow goes with the square root of its impulse.
TEST(Stage, ArrowsOfRunsSideBySideCanBeCompared) {
  const scene::Scene scene = falling_ball();
  const Trajectory weak = with_impulse(ball_at(2.0), 1.0), strong = with_impulse(ball_at(2.0), 4.0);
  Stage of_weak(scene, weak, as_shown()), of_strong(scene, strong, as_shown());
  const auto length = [](const Stage& stage) {
    for (const Batch& batch : stage.moment(1).drawing.batches)
      if (batch.geometry == kArrow) {
        const float* m = batch.instances.at(0).world_from_local;
        return Vector3d(m[2], m[6], m[10]).norm();
      }
    return 0.0;
  };
  constexpr double kRoundOff = 1e-6;  // of single precision, below 1 m
  ASSERT_GT(length(of_weak), 0.1);
  EXPECT_NEAR(length(of_weak), length(of_strong), kRoundOff) << "each alone: the longest arrow";
  CommonScale common = of_weak.scale();
  common.include(of_strong.scale());
  of_weak.set_scale(common);
  of_strong.set_scale(common);
  EXPECT_NEAR(2 * length(of_weak), length(of_strong), kRoundOff);
}

// A grid without a floor lies below everything that any of the runs shows.
TEST(Stage, GridsOfRunsSideBySideLieAtOneHeight) {
  scene::Scene scene = falling_ball();
  scene.bodies.pop_back();
  scene.grid_spacing_m = 0.5;
  const auto without_floor = [](double height) {
    Trajectory run = ball_at(height);
    run.bodies.pop_back();
    for (Frame& frame : run.frames) frame.poses.pop_back();
    return run;
  };
  const Trajectory high = without_floor(2.0), low = without_floor(-1.0);
  Stage of_high(scene, high, as_shown()), of_low(scene, low, as_shown());
  const auto height = [](const Stage& stage) { return stage.moment(0).drawing.ground.height_m; };
  CommonScale common = of_high.scale();
  common.include(of_low.scale());
  of_high.set_scale(common);
  of_low.set_scale(common);
  // falls from -1 m to -1.5 m, with a radius of 0.3 m; a few roundings
  EXPECT_NEAR(height(of_low), -1.8, 1e-12);
  EXPECT_EQ(height(of_high), height(of_low));
}

// A ball swings for longer than a path can show: the end of its motion is drawn, where it was.
TEST(Stage, PathOfALongRunStaysWhereTheBodyWas) {
  constexpr double kRadius = 0.5, kTurnPerFrame = 0.0613;  // m, rad: a turn has 102.5 frames
  const scene::Scene scene = falling_ball();
  Trajectory run = ball_at(1.0);
  const Frame first = run.frames.front();
  run.frames.assign(20000, first);
  for (std::size_t i = 0; i < run.frames.size(); ++i) {
    const double angle = kTurnPerFrame * static_cast<double>(i);
    run.frames[i].time = static_cast<double>(i);
    run.frames[i].poses[0].com_world = {kRadius * std::cos(angle), 0,
                                        1 + kRadius * std::sin(angle)};
  }
  const double pixel =
      metres_per_pixel(view_of(scene.camera), as_shown().height, scene.camera.target_m);
  PictureOptions options = as_shown();
  options.captions = false;  // without the scale bar, which has tubes too
  std::size_t pieces = 0;
  for (const Batch& batch :
       Stage(scene, run, options).moment(run.frames.size() - 1).drawing.batches)
    for (const Instance& piece : batch.instances) {
      if (batch.geometry != kTube) continue;
      const float* m = piece.world_from_local;
      const Vector3d middle(m[3] + 0.5 * m[2], m[7] + 0.5 * m[6], m[11] + 0.5 * m[10]);
      EXPECT_NEAR((middle - Vector3d(0, 0, 1)).norm(), kRadius, 0.5 * pixel);
      ++pieces;
    }
  EXPECT_GE(pieces, 500u);
  EXPECT_LE(pieces, 1000u);
}

// A ball moves along x and reverses after 1003 steps; the path has the corner.
TEST(Stage, PathHasTheCornersOfTheMotion) {
  constexpr int kCorner = 1003;
  // m: more than the third of a pixel by which a path may deviate
  constexpr double kStride = 1e-2;
  const scene::Scene scene = falling_ball();
  Trajectory run = ball_at(1.0);
  const Frame first = run.frames.front();
  run.frames.clear();
  for (int i = 0; i <= 2 * kCorner; ++i) {
    Frame frame = first;
    frame.time = i;
    frame.poses[0].com_world = {kStride * (kCorner - std::abs(i - kCorner)), 0, 1};
    run.frames.push_back(frame);
  }
  run.events.push_back(
      {kCorner, EventKind::kCollision, 0, 1, {10.3, 0, 1}, {-1, 0, 0}, 1.0, -1.0, 1.0});
  double farthest = 0.0;
  for (const Batch& batch :
       Stage(scene, run, as_shown()).moment(run.frames.size() - 1).drawing.batches)
    if (batch.geometry == kTube && batch.pass == Pass::kLine)
      for (const Instance& piece : batch.instances)
        if (piece.world_from_local[11] > 0.5f)  // at the ball's height, so not the scale bar
          farthest =
              std::max({farthest, double(piece.world_from_local[3]),
                        double(piece.world_from_local[3]) + double(piece.world_from_local[2])});
  // Single precision at 10 m; without the frame at the corner the result would be 1e-2 m less.
  EXPECT_NEAR(farthest, kStride * kCorner, 1e-5);
}

}  // namespace
}  // namespace tumble::render
