#include "framework/engines/contact/impact_law.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "framework/core/numbers.h"
#include "framework/engines/base/tolerances.h"
#include "framework/engines/contact/impact_bodies.h"

namespace tumble::engines {
namespace {

double speed_at(const Body& body, const Vector3d& point_world) {
  return body.velocity_world.norm() +
         body.omega_world.norm() * (point_world - body.com_world).norm();
}

}  // namespace

Approach fastest_approach(const Laws& laws, const TouchedRegion& region, const Body& a,
                          const Body& b, double threshold) {
  const auto velocity_at = [&](const Vector3d& point) {
    return laws.relative_normal_velocity({point, region.normal_b_to_a_world}, a, b);
  };
  const Vector3d& middle = region.points_world[0];
  Approach fastest{velocity_at(middle), middle};
  if (fastest.velocity < -threshold || region.points_world.size() == 1) return fastest;
  std::vector<double> velocities{fastest.velocity};
  for (std::size_t k = 1; k < region.points_world.size(); ++k) {
    velocities.push_back(velocity_at(region.points_world[k]));
    fastest.velocity = std::min(fastest.velocity, velocities.back());
  }
  if (velocities[0] == fastest.velocity) return fastest;
  const double alike = fastest.velocity + kSixDigits * std::abs(fastest.velocity);
  Vector3d sum = Vector3d::Zero();
  int count = 0;
  for (std::size_t k = 1; k < velocities.size(); ++k) {
    if (velocities[k] > alike) continue;
    sum += region.points_world[k];
    fastest.point_world = region.points_world[k];
    ++count;
  }
  if (count > 1) fastest.point_world = sum / count;
  return fastest;
}

void ApproachThreshold::look(const Laws& laws, const TouchedRegion& region, const Body& a,
                             const Body& b) {
  for (const Vector3d& point : region.points_world) {
    fastest_ = std::max(fastest_, std::abs(laws.relative_normal_velocity(
                                      {point, region.normal_b_to_a_world}, a, b)));
    sliding_ = std::max({sliding_, speed_at(a, point), speed_at(b, point)});
  }
}

// Approach slower than a part of the fastest one is what rounding leaves of "not approaching"; so
// is what rounding leaves of the speeds along the surface that cancel in it (a ball sliding in a
// groove).
double ApproachThreshold::value() const {
  return std::max(kSolverRounding * fastest_, kRoundOff * sliding_);
}

std::string left_approaching_message(const Laws& laws) {
  return fmt::format(
      "collision (collision_impulse, apply_impulse of {}) left them approaching, however often it "
      "was applied: the impulse has no effect, the wrong sign or too "
      "little size, or bodies that lie on each other need \"contact\": {{}} in the scene",
      laws.impulse_source);
}

double normal_velocity(const Contact& contact, const Body& a, const Body& b) {
  return contact.normal_b_to_a_world.dot(relative_velocity(a, b, contact.point_world));
}

bool comes_to_rest(const BallOnSupport& ball) {
  const Vector3d &gravity = ball.gravity_world, &up = ball.up_world,
                 &velocity = ball.relative_velocity_world;
  const double level =
      std::max(kSolverResidue, ball.radius > ball.rounding ? ball.rounding / ball.radius : 0.0);
  if (!(gravity.dot(up) < 0) || (gravity - gravity.dot(up) * up).norm() > level * gravity.norm())
    return false;
  const Matrix3d& inertia = ball.inertia_body;
  if (ball.turns &&
      (inertia - inertia(0, 0) * Matrix3d::Identity()).norm() > kRoundOff * inertia.norm())
    return false;
  return velocity.norm() < ball.restitution_threshold &&
         velocity.dot(up) <=
             ball.restitution * ball.restitution_threshold + kRoundOff * ball.fastest;
}

}  // namespace tumble::engines
