/// A ball over a floor, as a scene and as a hand-made run, for tests of pictures.
#pragma once

#include <string>

#include "framework/render/picture.h"

namespace tumble::render {

inline scene::Scene falling_ball() {
  scene::BodySpec ball, floor;
  ball.name = "ball";
  ball.shape = scene::SphereSpec{0.3};
  ball.mass_kg = 1.0;
  floor.name = "floor";
  floor.shape = scene::PlaneSpec{};
  floor.immovable = true;
  scene::Scene scene;
  scene.name = "test";
  scene.bodies = {ball, floor};
  scene.camera.eye_m = {0, -6, 2};
  scene.camera.target_m = {0, 0, 1};
  return scene;
}

inline Trajectory ball_at(double height) {
  const auto at = [](double z) {
    return BodyPose{{0, 0, z}, Quaterniond::Identity(), Vector3d::Zero(), Vector3d::Zero()};
  };
  Trajectory run;
  run.bodies = {{"ball", false}, {"floor", true}};
  for (const double t : {0.0, 0.5})
    run.frames.push_back(
        {t, {at(height - t), at(0)}, 0, 0, Vector3d::Zero(), Vector3d::Zero(), 1, {}, {}, {}, {}});
  return run;
}

inline PictureOptions small(const std::string& gl = "osmesa") {
  PictureOptions options;
  options.width = 160;
  options.height = 120;
  options.gl = gl;
  return options;
}

}  // namespace tumble::render
