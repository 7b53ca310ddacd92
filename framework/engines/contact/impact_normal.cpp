#include "framework/engines/contact/impact_normal.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace tumble::engines {

Vector3d normal_of_impact(const MeetingBodies& bodies, const collision::Gap& gap,
                          double threshold) {
  const auto velocity = [](const collision::MotionState& body, const Vector3d& point) {
    return Vector3d(body.velocity_world + body.omega_world.cross(point - body.pose.com_world));
  };
  const Vector3d rate =
      velocity(bodies.motion_a, gap.point_a_world) - velocity(bodies.motion_b, gap.point_b_world);
  if (!(rate.dot(gap.normal_b_to_a_world) < -threshold)) return gap.normal_b_to_a_world;
  const std::vector<Vector3d> normals = collision::normals_apart(
      bodies.shape_a, bodies.motion_a.pose, bodies.shape_b, bodies.motion_b.pose, gap);
  // along a normal along which they do not approach they may pass
  const bool all_approach = std::all_of(
      normals.begin(), normals.end(), [&](const Vector3d& n) { return rate.dot(n) < -threshold; });
  Vector3d sum = Vector3d::Zero();
  for (const Vector3d& n : normals) sum += n;
  // of a plate without thickness two opposite directions keep the bodies apart
  constexpr double kNone = 0.1;
  if (normals.empty() || !all_approach || !(sum.norm() > kNone)) return gap.normal_b_to_a_world;
  return sum.normalized();
}

void watch_normal(double t, const MeetingBodies& bodies, const collision::Gap& gap,
                  const Vector3d& normal, RunWatch& watch) {
  if (normal == gap.normal_b_to_a_world || watch.has_said(kNormalOfImpact, t)) return;
  constexpr double kZero = 1e-9;  // a rounding is not to be read
  const auto part = [&](double x) { return std::abs(x) < kZero ? 0.0 : x; };
  watch.say(kNormalOfImpact, t,
            fmt::format("at t = {:.6g} s '{}' meets '{}' corner on corner, or edge on parallel "
                        "edge: more than one normal keeps them apart there. The impact acts along "
                        "their middle, ({:.3g}, {:.3g}, {:.3g}); a shift of a rounding would leave "
                        "one of them, and give another motion",
                        t, bodies.a.name, bodies.b.name, part(normal.x()), part(normal.y()),
                        part(normal.z())));
}

}  // namespace tumble::engines
