#include "framework/engines/contact/impact_law.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "framework/core/numbers.h"
#include "framework/engines/contact/impact_bodies.h"

namespace tumble::engines {
namespace {

// Approach slower than this part of the fastest one is what rounding leaves of "not approaching"; so is what rounding leaves of
// the speeds along the surface that cancel in it (a ball sliding in a groove).
constexpr double kRoundOffOfSpeed = 1e-13;
constexpr double kRoundOffOfSliding = 64 * kEpsilon;
constexpr double kLevelSupport = 1e-12;      // rad: a support that leans by less counts as level: in 100 s a ball would slide 5e-8 m
constexpr double kRoundOffOfRest = 64 * kEpsilon;   // of the fastest impact, and of a moment of inertia

double speed_at(const Body& body, const Vector3d& point_world) {
  return body.velocity_world.norm() + body.omega_world.norm() * (point_world - body.com_world).norm();
}

}  // namespace

Approach fastest_approach(const Laws& laws, const TouchedRegion& region, const Body& a, const Body& b, double threshold) {
  Approach fastest{kInfinity, &region.points_world[0]};
  for (const Vector3d& point : region.points_world) {
    const double velocity = laws.relative_normal_velocity({point, region.normal_b_to_a_world}, a, b);
    if (velocity < fastest.velocity) fastest = {velocity, &point};
    if (&point == &region.points_world[0] && velocity < -threshold) break;
  }
  return fastest;
}

void ApproachThreshold::look(const Laws& laws, const TouchedRegion& region, const Body& a, const Body& b) {
  for (const Vector3d& point : region.points_world) {
    fastest_ = std::max(fastest_, std::abs(laws.relative_normal_velocity({point, region.normal_b_to_a_world}, a, b)));
    sliding_ = std::max({sliding_, speed_at(a, point), speed_at(b, point)});
  }
}

double ApproachThreshold::value() const { return std::max(kRoundOffOfSpeed * fastest_, kRoundOffOfSliding * sliding_); }

std::string told_left_approaching(const Laws& laws) {
  return fmt::format("collision (collision_impulse, apply_impulse of {}) left them approaching, however often it was applied: the impulse has no effect, the wrong sign or too "
                     "little size, or a lasting contact is needed there", laws.impulse_source);
}

double normal_velocity(const Contact& contact, const Body& a, const Body& b) {
  return contact.normal_b_to_a_world.dot(relative_velocity(a, b, contact.point_world));
}

bool comes_to_rest(const BallOnSupport& ball) {
  const Vector3d &gravity = ball.gravity_world, &up = ball.up_world, &velocity = ball.relative_velocity_world;
  const double level = std::max(kLevelSupport, ball.radius > ball.rounding ? ball.rounding / ball.radius : 0.0);
  if (!(gravity.dot(up) < 0) || (gravity - gravity.dot(up) * up).norm() > level * gravity.norm()) return false;
  const Matrix3d& inertia = ball.inertia_body;
  if (ball.turns && (inertia - inertia(0, 0) * Matrix3d::Identity()).norm() > kRoundOffOfRest * inertia.norm()) return false;
  return velocity.norm() < ball.rest_speed && velocity.dot(up) <= ball.restitution * ball.rest_speed + kRoundOffOfRest * ball.fastest;
}

}  // namespace tumble::engines
