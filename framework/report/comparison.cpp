#include "framework/report/comparison.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "framework/core/error.h"

namespace tumble::report {
namespace {

// s: rounding of the summed times of frames, which are multiples of the same interval
constexpr double kSameInstant = 1e-9;

// |x_a - x_b| + r |rotation|, an upper bound of the distance of a point of the body from its place
// in the other run.
double apart(const BodyPose& a, const BodyPose& b, double radius_m) {
  const double shift = (a.com_world - b.com_world).norm();
  if (!std::isfinite(radius_m)) return shift;
  return shift + radius_m * a.world_from_body.angularDistance(b.world_from_body);
}

// "ball is 0.062 m from where it is in the run before", of a body that has mostly turned "handle is
// turned by 0.01 rad from how it is in the run before".
std::string apart_in_words(const std::string& name, const BodyPose& a, const BodyPose& b,
                           double radius_m, const std::string& label_b) {
  const double shift = (a.com_world - b.com_world).norm(),
               angle = a.world_from_body.angularDistance(b.world_from_body);
  if (std::isfinite(radius_m) && radius_m * angle > shift)
    return fmt::format("{} is turned by {:.2g} rad from how it is in {}", name, angle, label_b);
  return fmt::format("{} is {:.2g} m from where it is in {}", name, apart(a, b, radius_m), label_b);
}

// "collision of ball and wall", "a force on box begins": before "at 2 s in ..." or "only in ...".
std::string in_words(const Event& event, const Trajectory& run) {
  const auto name = [&](int body) { return run.bodies[static_cast<std::size_t>(body)].name; };
  if (event.body_a < 0) return name_of_event(event.kind);
  const bool are_two = event.body_b >= 0;
  const std::string bodies = name(event.body_a) + (are_two ? " and " + name(event.body_b) : "");
  switch (event.kind) {
    case EventKind::kRest:
      return bodies + (are_two ? " come to rest on each other" : " comes to rest");
    case EventKind::kForceOn: return "a force on " + bodies + " begins";
    case EventKind::kForceOff: return "a force on " + bodies + " ends";
    case EventKind::kContact: return "contact of " + bodies + " begins";
    case EventKind::kBreak: return "contact of " + bodies + " ends";
    case EventKind::kStick: return bodies + (are_two ? " stick" : " sticks");
    case EventKind::kSlide: return bodies + (are_two ? " begin to slide" : " begins to slide");
    case EventKind::kSleep: return bodies + (are_two ? " fall asleep" : " falls asleep");
    case EventKind::kWake: return bodies + (are_two ? " wake" : " wakes");
    case EventKind::kCollision:
    case EventKind::kControl: break;
  }
  return std::string(name_of_event(event.kind)) + " of " + bodies;
}

bool differ(double a, double b, double scale) {
  return std::abs(a - b) > kEventShare * std::max({std::abs(a), std::abs(b), scale});
}

// The difference of two events in words; empty: none.
std::string difference_of(const Event& a, const Event& b, double impulse_scale,
                          const Trajectory& run_a, const Trajectory& run_b,
                          const std::string& label_a, const std::string& label_b) {
  const std::string head = in_words(a, run_a);
  if (a.kind != b.kind || a.body_a != b.body_a || a.body_b != b.body_b)
    return fmt::format("{} at {:.6g} s in {}, {} at {:.6g} s in {}", head, a.time, label_a,
                       in_words(b, run_b), b.time, label_b);
  if (differ(a.time, b.time, 1.0))
    return fmt::format("{}: at {:.6g} s in {}, at {:.6g} s in {}", head, a.time, label_a, b.time,
                       label_b);
  if (differ(a.impulse, b.impulse, impulse_scale))
    return fmt::format("{}: impulse {:.6g} N s in {}, {:.6g} N s in {}", head, a.impulse, label_a,
                       b.impulse, label_b);
  return "";
}

std::optional<Difference> first_event(const Trajectory& a, const std::string& label_a,
                                      const Trajectory& b, const std::string& label_b) {
  double strongest = 0.0;
  for (const Trajectory* run : {&a, &b})
    for (const Event& event : run->events)
      strongest = std::max(strongest, std::isfinite(event.impulse) ? std::abs(event.impulse) : 0.0);
  const std::size_t both = std::min(a.events.size(), b.events.size());
  for (std::size_t i = 0; i < both; ++i) {
    const std::string what =
        difference_of(a.events[i], b.events[i], 1e-6 * strongest, a, b, label_a, label_b);
    if (!what.empty())
      return Difference{std::min(a.events[i].time, b.events[i].time), what, a.events[i].body_a};
  }
  if (a.events.size() == b.events.size()) return std::nullopt;
  const bool a_has_more = a.events.size() > both;
  const Trajectory& more = a_has_more ? a : b;
  const Event& event = more.events[both];
  const Trajectory& other = a_has_more ? b : a;
  // that run ended earlier: not a difference of the motion
  if (other.frames.empty() || other.frames.back().time < event.time) return std::nullopt;
  return Difference{
      event.time,
      fmt::format("{} only in {}", in_words(event, more), a_has_more ? label_a : label_b),
      event.body_a};
}

std::optional<EarlyEnd> early_end_of(const Trajectory& a, const Trajectory& b) {
  if (a.frames.empty() || b.frames.empty()) return std::nullopt;
  const double end_a = a.frames.back().time, end_b = b.frames.back().time;
  if (std::abs(end_a - end_b) <= kSameInstant) return std::nullopt;
  return EarlyEnd{std::min(end_a, end_b), end_a < end_b};
}

}  // namespace

const char* name_of_event(EventKind kind) {
  switch (kind) {
    case EventKind::kCollision: return "collision";
    case EventKind::kRest: return "comes to rest";
    case EventKind::kForceOn: return "force on";
    case EventKind::kForceOff: return "force off";
    case EventKind::kContact: return "contact begins";
    case EventKind::kBreak: return "contact ends";
    case EventKind::kStick: return "sticks";
    case EventKind::kSlide: return "slides";
    case EventKind::kSleep: return "falls asleep";
    case EventKind::kWake: return "wakes";
    case EventKind::kControl: return "control";
  }
  return "event";
}

Comparison compare(const scene::Scene& scene, const std::vector<double>& radius_m,
                   const Trajectory& a, const std::string& label_a, const Trajectory& b,
                   const std::string& label_b) {
  require(a.bodies.size() == b.bodies.size() && a.bodies.size() == radius_m.size(),
          "compare: both runs must be of the same scene");
  const double threshold = kApart * (scene.camera.eye_m - scene.camera.target_m).norm();
  Comparison result;
  std::optional<Difference> moved;
  std::size_t at = 0;
  for (const Frame& frame : a.frames) {
    while (at < b.frames.size() && b.frames[at].time < frame.time - kSameInstant) ++at;
    if (at == b.frames.size() || b.frames[at].time > frame.time + kSameInstant) {
      result.apart_m.push_back(std::numeric_limits<double>::quiet_NaN());
      continue;
    }
    double farthest = 0.0;
    int body = -1;
    for (std::size_t i = 0; i < radius_m.size(); ++i) {
      const double distance = apart(frame.poses[i], b.frames[at].poses[i], radius_m[i]);
      if (distance > farthest || (std::isnan(distance) && body < 0))
        farthest = distance, body = static_cast<int>(i);
    }
    result.apart_m.push_back(farthest);
    if (!moved && !(farthest <= threshold))
      moved = Difference{frame.time,
                         apart_in_words(a.bodies[static_cast<std::size_t>(body)].name,
                                        frame.poses[static_cast<std::size_t>(body)],
                                        b.frames[at].poses[static_cast<std::size_t>(body)],
                                        radius_m[static_cast<std::size_t>(body)], label_b),
                         body};
  }
  result.first = first_event(a, label_a, b, label_b);
  if (moved && (!result.first || moved->time_s < result.first->time_s)) result.first = moved;
  result.early_end = early_end_of(a, b);
  return result;
}

}  // namespace tumble::report
