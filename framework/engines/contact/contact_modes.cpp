#include "framework/engines/contact/contact_modes.h"

#include "framework/engines/base/tolerances.h"

#include <algorithm>
#include <limits>

namespace tumble::engines {
namespace {

constexpr double kQuiet = 0.05;  // s: changes that come sooner after the last one are chatter

struct Votes {
  const ContactPoint* first = nullptr;
  bool all_on = true, all_in = true, slips = false;
};

}  // namespace

// The faster of both ends of the step. [m/s]
double ContactModes::slip_of(const ContactPoint& point) {
  const auto at = [&](double t) {
    const auto velocity = [&](int body) -> Vector3d {
      const collision::MotionState motion = moving_.motion_at(body, t);
      return motion.velocity_world +
             (moving_.can_move(body)
                  ? motion.omega_world.cross(point.point_world - motion.pose.com_world)
                  : Vector3d::Zero());
    };
    const Vector3d relative = velocity(point.body_a) - velocity(point.body_b),
                   &n = point.normal_b_to_a_world;
    return (relative - relative.dot(n) * n).norm();
  };
  return std::max(at(moving_.time()), at(moving_.target()));
}

void ContactModes::look() {
  const double time = moving_.time();
  std::map<PersistentContacts::Pair, Votes> votes;
  for (const ContactPoint& point : contacts_.forces()) {
    const double friction = contacts_.friction({point.body_a, point.body_b});
    if (friction == 0.0) continue;
    Votes& pair = votes[{point.body_a, point.body_b}];
    if (!pair.first) pair.first = &point;
    const double push = point.force_on_a_world.dot(point.normal_b_to_a_world);
    const double share =
        (point.force_on_a_world - push * point.normal_b_to_a_world).norm() / (friction * push);
    // Impulses of sliding contacts lie on the edge of the cone to round-off, those of sticking ones
    // below what the solver leaves open.
    pair.all_on = pair.all_on && share >= 1 - kNegligible;
    pair.all_in = pair.all_in && share < 1 - kSixDigits;
    pair.slips = pair.slips || (pair.all_on && slip_of(point) > kCreep * restitution_threshold_);
  }
  std::erase_if(modes_, [&](const auto& entry) {
    return !contacts_.lasts(entry.first) && time > entry.second.seen + kQuiet;
  });
  for (const auto& [pair, vote] : votes) {
    Mode& mode =
        modes_.try_emplace(pair, Mode{false, false, -std::numeric_limits<double>::infinity(), time})
            .first->second;
    mode.seen = time;
    if (vote.all_on || vote.all_in) mode.slides = vote.all_on && vote.slips;
    if (mode.slides == mode.reported_sliding || time < mode.told + kQuiet) continue;
    mode.reported_sliding = mode.slides;
    mode.told = time;
    sink_.event({time, mode.slides ? EventKind::kSlide : EventKind::kStick, pair.first, pair.second,
                 vote.first->point_world, vote.first->normal_b_to_a_world, 0.0, 0.0});
  }
}

bool ContactModes::slides(PersistentContacts::Pair pair) const {
  const auto found = modes_.find(pair);
  return found != modes_.end() && found->second.slides;
}

}  // namespace tumble::engines
