#include "framework/engines/local_origin.h"

#include <cmath>

namespace tumble::engines {
namespace {

// Farther off than this many times its extent, a scene loses three digits and more: that is where local coordinates begin.
constexpr double kFar = 1000.0;

/// Calls visit(point) for every place that a scene names in the world's coordinates, bodies first; visit may change it.
template <class Scene, class Visit>
void for_each_place(Scene& scene, const Visit& visit) {
  for (auto& body : scene.bodies) visit(body.position_m);
  for (auto& spring : scene.springs)
    for (auto* anchor : {&spring.a, &spring.b})
      if (anchor->body.empty()) visit(anchor->point_m);
  for (auto& rod : scene.rods)
    for (auto* anchor : {&rod.a, &rod.b})
      if (anchor->body.empty()) visit(anchor->point_m);
  for (auto& joint : scene.joints) visit(joint.point_m);
}

}  // namespace

Vector3d local_origin(const scene::Scene& scene) {
  if (scene.bodies.empty()) return Vector3d::Zero();
  Vector3d low = scene.bodies.front().position_m, high = low;
  for_each_place(scene, [&](const Vector3d& place) {
    low = low.cwiseMin(place);
    high = high.cwiseMax(place);
  });
  double extent = (high - low).maxCoeff();
  if (extent == 0.0) extent = scene.duration_s * scene.bodies.front().velocity_m_s.norm();   // one body: its way
  const Vector3d middle = low + 0.5 * (high - low);
  if (!(extent > 0.0) || !(middle.cwiseAbs().maxCoeff() > kFar * extent)) return Vector3d::Zero();
  // A whole multiple of a power of two not below the extent: places near it differ from it exactly, and those near 0 stay as they are.
  const double grid = std::exp2(std::ceil(std::log2(extent)));
  return (middle / grid).array().round() * grid;
}

scene::Scene seen_from(const Vector3d& origin_world, scene::Scene scene) {
  for_each_place(scene, [&](Vector3d& place) { place -= origin_world; });
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
