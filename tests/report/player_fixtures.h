/// A ball thrown over a floor and a rotating box, as a scene and as a run by closed forms, for
/// tests of the player's page.
#pragma once

#include <cmath>

#include "framework/report/player.h"

namespace tumble::testing {

constexpr double kGravity = 9.81, kRate = 60.0, kThrow = 4.0;  // m/s^2, frames a second, m/s

inline scene::Scene thrown_ball() {
  scene::BodySpec ball, box, floor;
  ball.name = "ball <1>";
  ball.shape = scene::SphereSpec{0.25};
  ball.mass_kg = 1.0;
  ball.color = Vector3d(0.8, 0.0, 0.0);
  box.name = "box";
  box.shape = scene::BoxSpec{{0.2, 0.3, 0.1}};
  box.mass_kg = 1.0;
  box.color = Vector3d(0.0, 0.0, 0.6);
  floor.name = "floor";
  floor.shape = scene::PlaneSpec{};
  floor.immovable = true;
  scene::Scene scene;
  scene.name = "thrown_ball";
  scene.title = "A thrown ball & a turning box";
  scene.bodies = {ball, box, floor};
  scene.camera.eye_m = {0, -8, 2};
  scene.camera.target_m = {0, 0, 1};
  return scene;
}

inline Vector3d ball_place(double t) {
  return {-1.5 + 2.0 * t, 0.0, 0.5 + kThrow * t - 0.5 * kGravity * t * t};
}

inline BodyPose ball_pose(double t) {
  return {
      ball_place(t), Quaterniond::Identity(), {2.0, 0.0, kThrow - kGravity * t}, Vector3d::Zero()};
}

inline BodyPose box_pose(double t) {
  // rad, about z: beyond pi, so that the sign of the quaternion matters
  const double turn = 3.0 * t;
  return {{1.0, 0.5, 0.8},
          Quaterniond(Eigen::AngleAxisd(turn, Vector3d::UnitZ())),
          Vector3d::Zero(),
          {0, 0, 3.0}};
}

inline Trajectory thrown_run(double seconds = 0.8) {
  Trajectory run;
  run.info.scene_name = "thrown_ball";
  run.info.engine = "rd";
  run.info.step_s = 1.0 / kRate;
  run.bodies = {{"ball <1>", false}, {"box", false}, {"floor", true}};
  const BodyPose floor{Vector3d::Zero(), Quaterniond::Identity(), Vector3d::Zero(),
                       Vector3d::Zero()};
  for (int k = 0; k <= static_cast<int>(std::lround(seconds * kRate)); ++k) {
    const double t = k / kRate;
    const BodyPose ball = ball_pose(t);
    run.frames.push_back({t,
                          {ball, box_pose(t), floor},
                          0.5 * ball.velocity_world.squaredNorm(),
                          kGravity * ball.com_world.z(),
                          ball.velocity_world,
                          Vector3d::Zero(),
                          0.25,
                          {},
                          {},
                          {},
                          {{1, 2, {1.0, 0.5, 0.7}, {0, 0, 1}, {0, 0, kGravity}}}});
  }
  run.events.push_back(
      {0.4, EventKind::kCollision, 0, 1, ball_place(0.4), {1, 0, 0}, 6.0, -3.0, 1.5});
  run.events.push_back(
      {0.6, EventKind::kRest, 1, 2, {1, 0.5, 0.7}, {0, 0, 1}, 0.0, kUnset, kUnset});
  return run;
}

}  // namespace tumble::testing
