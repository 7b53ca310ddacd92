#include "framework/engines/local_origin.h"

#include <cmath>

namespace tumble::engines {
namespace {

// Farther off than this many times its extent, a scene loses three digits and more: that is where local coordinates begin.
constexpr double kFar = 1000.0;

}  // namespace

Vector3d local_origin(const scene::Scene& scene) {
  if (!scene.springs.empty() || !scene.rods.empty() || !scene.joints.empty()) return Vector3d::Zero();
  if (scene.bodies.empty()) return Vector3d::Zero();
  Vector3d low = scene.bodies.front().position_m, high = low;
  for (const scene::BodySpec& body : scene.bodies) {
    low = low.cwiseMin(body.position_m);
    high = high.cwiseMax(body.position_m);
  }
  double extent = (high - low).maxCoeff();
  if (extent == 0.0) extent = scene.duration_s * scene.bodies.front().velocity_m_s.norm();   // one body: its way
  const Vector3d middle = low + 0.5 * (high - low);
  if (!(extent > 0.0) || !(middle.cwiseAbs().maxCoeff() > kFar * extent)) return Vector3d::Zero();
  // A whole multiple of a power of two not below the extent: places near it differ from it exactly, and those near 0 stay as they are.
  const double grid = std::exp2(std::ceil(std::log2(extent)));
  return (middle / grid).array().round() * grid;
}

scene::Scene seen_from(const Vector3d& origin_world, scene::Scene scene) {
  for (scene::BodySpec& body : scene.bodies) body.position_m -= origin_world;
  for (scene::PointForceSpec& force : scene.point_forces) force.point_m -= origin_world;
  return scene;
}

void WorldSink::frame(const Frame& frame) {
  Frame moved = frame;
  for (BodyPose& pose : moved.poses) pose.com_world += origin_world_;
  for (ContactPoint& contact : moved.contacts) contact.point_world += origin_world_;
  moved.potential_energy += potential_energy_;
  moved.angular_momentum_world += origin_world_.cross(frame.momentum_world);
  sink_.frame(moved);
}

void WorldSink::event(const Event& event) {
  Event moved = event;
  moved.point_world += origin_world_;
  sink_.event(moved);
}

}  // namespace tumble::engines
