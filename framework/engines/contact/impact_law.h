/// The law of impacts at one pair, on plain bodies: where the two approach, what counts as
/// approaching, when a body comes to rest.
///
/// A pair that approaches gets the impulse of the laws at the middle of the region where the two
/// touch, or, where the middle does not approach, at the corner of that region that approaches
/// fastest, or amid those that do so alike; this is repeated until no point approaches faster than
/// round-off. Callers fetch the bodies, and store what comes of it: a world of bodies with links
/// and friction (sequential_impacts.h), and two free flights (events/flight_impact_response.h).
#pragma once

#include <string>
#include <vector>

#include "framework/dynamics/laws.h"

namespace tumble::engines {

/// Where two bodies touch.
struct TouchedRegion {
  Vector3d normal_b_to_a_world;
  // the middle, then the corners if it is more than a point
  const std::vector<Vector3d>& points_world;
};

struct Approach {
  double velocity;       // [m/s], negative when approaching
  Vector3d point_world;  // of the region's points, or the mean of corners that approach alike
};

/// The middle counts first, so that a flat landing does not tip over its corners in turn; corners
/// that approach equally fast count together, so that what is symmetric stays so.
/// @param threshold  what counts as approaching [m/s], see ApproachThreshold
Approach fastest_approach(const Laws& laws, const TouchedRegion& region, const Body& a,
                          const Body& b, double threshold);

/// What rounding leaves of "not approaching", from the velocities before the first impulse.
class ApproachThreshold {
 public:
  void look(const Laws& laws, const TouchedRegion& region, const Body& a, const Body& b);
  /// [m/s]
  double value() const;
  /// The fastest normal velocity that was seen. [m/s]
  double fastest() const { return fastest_; }

 private:
  double fastest_ = 0.0, sliding_ = 0.0;  // [m/s]
};

/// More rounds of impulses than any right law needs: restitution 0.99 in a row of 50 balls takes
/// some hundred.
inline constexpr int kMostImpactRounds = 10000;
/// "collision (collision_impulse, ...) left them approaching ...": why a run stops whose law is
/// still approached after all these rounds.
std::string left_approaching_message(const Laws& laws);

/// A pair without a persistent contact that gravity or turning presses together would meet
/// infinitely often in no time: it is sent apart at the rest speed (a micro-collision, Mirtich
/// 1996). Pushes at several points approach that speed together, each round by a part of what is
/// missing.
// of the restitution threshold: what separates so fast gets no further push
inline constexpr double kFastEnough = 0.5;
inline constexpr int kMostPushes = 200;  // rounds

/// Not by the law that is being judged: a record of what the impulse did. [m/s]
double normal_velocity(const Contact& contact, const Body& a, const Body& b);

/// Kinetic energy that the laws' impulse changes: half the impulse times the sum of the normal
/// velocities before and after. [J]
inline double work_of_impulse(double impulse, double approach, double restitution) {
  return 0.5 * impulse * (1 - restitution) * approach;
}

/// A ball that has met a support.
struct BallOnSupport {
  Vector3d gravity_world;  // [m/s^2]
  Vector3d up_world;       // unit, away from the support
  // [m]: of the ball; of the place where the two touch, from which the normal's own rounding
  // follows
  double radius = 0.0, rounding = 0.0;
  Matrix3d inertia_body;  // [kg m^2]
  bool turns = false;
  // of the ball against the support, after its impacts [m/s]
  Vector3d relative_velocity_world;
  double restitution = 0.0;
  // [m/s]: fastest: of the impacts at this instant
  double restitution_threshold = 0.0, fastest = 0.0;
};

/// Whether it stays there: gravity presses it straight against the support (without friction a
/// slope holds nothing), it turns evenly if it turns, and it moves more slowly than the restitution
/// threshold (or does not bounce at all). That nothing else pushes it is the caller's to know.
bool comes_to_rest(const BallOnSupport& ball);

}  // namespace tumble::engines
