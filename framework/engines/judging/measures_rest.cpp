// Measures of bodies at rest, sliding, rotating and falling. From positions and velocities alone.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "framework/core/numbers.h"
#include "framework/dynamics/world.h"
#include "framework/effects/build_world.h"
#include "framework/engines/judging/measures.h"

namespace tumble::engines {
namespace {

/// A check without a body to judge fails.
const char* const kNobody = "no body can move";

/// The bodies of a check, by index: its list, its one body, or all movable bodies.
std::vector<std::size_t> bodies_of(const CheckSpec& check, const Trajectory& run) {
  std::vector<std::size_t> indices;
  for (const std::string& name : check.bodies)
    indices.push_back(static_cast<std::size_t>(index_of(name, run)));
  if (check.bodies.empty() && !check.body.empty())
    indices.push_back(static_cast<std::size_t>(index_of(check.body, run)));
  if (!indices.empty()) return indices;
  for (std::size_t i = 0; i < run.bodies.size(); ++i)
    if (!run.bodies[i].immovable) indices.push_back(i);
  return indices;
}

double turn_between(const Quaterniond& from, const Quaterniond& to) {
  const Quaterniond turn = to * from.conjugate();
  return 2.0 * std::atan2(turn.vec().norm(), std::abs(turn.w()));
}

/// The angle between the body's own axis and its first direction. [rad]
double lean(const CheckSpec& check, const Trajectory& run, const Frame& frame, std::size_t body) {
  const Vector3d first = run.frames.front().poses[body].world_from_body * *check.axis,
                 now = frame.poses[body].world_from_body * *check.axis;
  return std::atan2(first.cross(now).norm(), first.dot(now));
}

/// The largest value of `of_pose` over the bodies, relative to their poses in the first frame from
/// at_s on.
template <class OfPose>
Finding worst_since(const CheckSpec& check, const Trajectory& run, const OfPose& of_pose) {
  Finding finding;
  const Frame* first = nullptr;
  const auto bodies = bodies_of(check, run);
  for (const Frame& frame : run.frames) {
    if (frame.time < check.at_s) continue;
    if (first == nullptr) first = &frame;
    for (const std::size_t i : bodies)
      finding.worst(of_pose(first->poses[i], frame.poses[i]),
                    run.bodies[i].name + " " + at_time(frame.time));
  }
  if (first == nullptr) finding.worst(kInfinity, "the run ended before at_s");
  if (bodies.empty()) finding.worst(kInfinity, kNobody);
  return finding;
}

Finding no_frame(double time) {
  return {kInfinity, fmt::format("no frame was recorded {}", at_time(time))};
}

}  // namespace

Finding drift(const CheckSpec& check, const Scene&, const Trajectory& run) {
  return worst_since(check, run, [](const BodyPose& first, const BodyPose& now) {
    return (now.com_world - first.com_world).norm();
  });
}

Finding tilt(const CheckSpec& check, const Scene&, const Trajectory& run) {
  return worst_since(check, run, [](const BodyPose& first, const BodyPose& now) {
    return turn_between(first.world_from_body, now.world_from_body);
  });
}

Finding at_rest(const CheckSpec& check, const Scene& scene, const Trajectory& run) {
  // E / m = v^2 / 2 + w . I w / 2 m
  const World world = build_world(scene);
  const double from = check.at_s == 0.0 ? run.frames.back().time : check.at_s;
  Finding finding;
  if (run.frames.back().time < from) finding.worst(kInfinity, "the run ended before at_s");
  if (bodies_of(check, run).empty()) finding.worst(kInfinity, kNobody);
  for (const Frame& frame : run.frames) {
    if (frame.time < from) continue;
    for (const std::size_t i : bodies_of(check, run)) {
      const BodyPose& pose = frame.poses[i];
      const Inertia& inertia = world.bodies[i].inertia;
      const Vector3d omega_body = pose.world_from_body.conjugate() * pose.omega_world;
      const double turning =
          run.bodies[i].immovable
              ? 0.0
              : omega_body.dot(inertia.inertia_body * omega_body) * inertia.inverse_mass;
      finding.worst(0.5 * (pose.velocity_world.squaredNorm() + turning),
                    run.bodies[i].name + " " + at_time(frame.time));
    }
  }
  return finding;
}

Finding distance_travelled(const CheckSpec& check, const Scene&, const Trajectory& run) {
  const Frame* frame = frame_at(check.at_s, run);
  if (frame == nullptr) return no_frame(check.at_s);
  const auto body = static_cast<std::size_t>(index_of(check.body, run));
  const Vector3d way = frame->poses[body].com_world - run.frames.front().poses[body].com_world;
  const double found = check.axis ? check.axis->dot(way) : way.norm();
  Finding finding;
  finding.worst(std::abs(found - check.expected[0]),
                fmt::format("{:.9g} m, expected {:.9g} m, {}", found, check.expected[0],
                            at_time(frame->time)));
  return finding;
}

Finding centre_of_mass(const CheckSpec& check, const Scene& scene, const Trajectory& run) {
  // x = sum m_i x_i / sum m_i, over the bodies that can move
  const Frame* frame = frame_at(check.at_s, run);
  if (frame == nullptr) return no_frame(check.at_s);
  const World world = build_world(scene);
  Vector3d moment = Vector3d::Zero();
  double mass = 0.0;
  for (const std::size_t i : bodies_of(check, run)) {
    if (run.bodies[i].immovable) return {kInfinity, run.bodies[i].name + " has no finite mass"};
    moment += world.bodies[i].inertia.mass * frame->poses[i].com_world;
    mass += world.bodies[i].inertia.mass;
  }
  if (mass == 0.0) return {kInfinity, kNobody};
  const Vector3d found = moment / mass;
  Finding finding;
  finding.worst((found - Eigen::Map<const Vector3d>(check.expected.data())).norm(),
                fmt::format("({:.9g}, {:.9g}, {:.9g}) {}", found.x(), found.y(), found.z(),
                            at_time(frame->time)));
  return finding;
}

Finding angle_at(const CheckSpec& check, const Scene&, const Trajectory& run) {
  const Frame* end = frame_at(check.at_s, run);
  if (end == nullptr) return no_frame(check.at_s);
  const auto body = static_cast<std::size_t>(index_of(check.body, run));
  // Summed from frame to frame: places say each but for whole turns, and these the rates at its
  // ends, unless they differ by so much that their mean may be half a turn off.
  constexpr double kTurn = 2.0 * std::numbers::pi;
  double angle = 0.0;
  for (const Frame* frame = &run.frames.front(); frame != end; ++frame) {
    const BodyPose &from = frame->poses[body], &to = frame[1].poses[body];
    const double passed = frame[1].time - frame->time,
                 rate_before = check.axis->dot(from.omega_world),
                 rate_after = check.axis->dot(to.omega_world);
    if (std::abs(rate_after - rate_before) * passed >= kTurn)
      return {kInfinity,
              fmt::format("turns at {:.3g} rad/s and, {:.3g} s later, at {:.3g} rad/s {}: too far "
                          "from frame to frame to count its turns",
                          rate_before, passed, rate_after, at_time(frame[1].time))};
    const Quaterniond turn = to.world_from_body * from.world_from_body.conjugate();
    const double about = 0.5 * (rate_before + rate_after) * passed;
    angle += about +
             std::remainder(2.0 * std::atan2(check.axis->dot(turn.vec()), turn.w()) - about, kTurn);
  }
  Finding finding;
  finding.worst(std::abs(angle - check.expected[0]),
                fmt::format("{:.9g} rad, expected {:.9g} rad, {}", angle, check.expected[0],
                            at_time(end->time)));
  return finding;
}

Finding stands(const CheckSpec& check, const Scene&, const Trajectory& run) {
  const Frame* frame = frame_at(check.at_s, run);
  if (frame == nullptr) return no_frame(check.at_s);
  if (bodies_of(check, run).empty()) return {kInfinity, kNobody};
  Finding finding{-kInfinity, ""};
  for (const std::size_t i : bodies_of(check, run))
    finding.worst(lean(check, run, *frame, i),
                  "most of all " + run.bodies[i].name + ", " + at_time(frame->time));
  return finding;
}

Finding falls(const CheckSpec& check, const Scene&, const Trajectory& run) {
  const Frame* frame = frame_at(check.at_s, run);
  if (frame == nullptr) return {-kInfinity, no_frame(check.at_s).detail};
  if (bodies_of(check, run).empty()) return {-kInfinity, kNobody};
  Finding finding{-kInfinity, ""};  // of the negative: the least lean is the worst
  for (const std::size_t i : bodies_of(check, run))
    finding.worst(-lean(check, run, *frame, i),
                  "least of all " + run.bodies[i].name + ", " + at_time(frame->time));
  finding.value = -finding.value;
  return finding;
}

Finding order_of_falls(const CheckSpec& check, const Scene&, const Trajectory& run) {
  Finding finding;
  double before = 0.0;
  std::string times, first_wrong;
  for (const std::size_t i : bodies_of(check, run)) {
    double fell = kInfinity;
    for (const Frame& frame : run.frames)
      if (lean(check, run, frame, i) >= check.expected[0]) {
        fell = frame.time;
        break;
      }
    times += fmt::format("{}{:.3g}", times.empty() ? "" : ", ", fell);
    if (fell < before || fell == kInfinity) {
      finding.value += 1.0;
      if (first_wrong.empty())
        first_wrong = run.bodies[i].name +
                      (fell == kInfinity ? " does not fall; " : " falls before its turn; ");
    }
    if (fell != kInfinity) before = std::max(before, fell);
  }
  finding.detail = first_wrong + "at t = " + times + " s";
  return finding;
}

}  // namespace tumble::engines
