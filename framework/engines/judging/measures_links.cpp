// Measures of springs, rods, joints and contacts. Lengths and gaps are taken from the places of the bodies alone, so that an engine
// cannot be judged by what it says of itself.
#include <algorithm>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "framework/core/numbers.h"
#include "framework/effects/registry.h"
#include "framework/engines/judging/measures.h"

namespace tumble::engines {
namespace {

/// Where a point of a body that was at `point_at_start` is in a frame; of the world (body "") it stays there.
struct Carried {
  const BodyPose* pose = nullptr;
  Vector3d com_at_start = Vector3d::Zero();
  Quaterniond turned = Quaterniond::Identity();   // since the start

  Vector3d point(const Vector3d& point_at_start) const {
    return pose == nullptr ? point_at_start : Vector3d(pose->com_world + turned * (point_at_start - com_at_start));
  }
};

Carried carried_by(const std::string& body, const Scene& scene, const Trajectory& run, const Frame& frame) {
  if (body.empty()) return {};
  const auto index = static_cast<std::size_t>(index_of(body, run));
  const scene::BodySpec& spec = scene.bodies[index];
  const BodyPose& pose = frame.poses[index];
  return {&pose, spec.position_m, pose.world_from_body * spec.world_from_body.conjugate()};
}

Vector3d place(const scene::AnchorSpec& anchor, const Trajectory& run, const Frame& frame) {
  if (anchor.body.empty()) return anchor.point_m;
  const BodyPose& pose = frame.poses[static_cast<std::size_t>(index_of(anchor.body, run))];
  return pose.com_world + pose.world_from_body * anchor.point_m;
}

/// Angle between two unit vectors or of a rotation; exact near 0, where acos is not.
double angle_between(const Vector3d& a, const Vector3d& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }
double angle_of(const Quaterniond& rotation) { return 2.0 * std::atan2(rotation.vec().norm(), std::abs(rotation.w())); }

/// The largest of what `measure` says of each joint that the check means, in every frame.
template <class OfJoint>
Finding worst_of_joints(const CheckSpec& check, const Scene& scene, const Trajectory& run, const OfJoint& of_joint) {
  Finding finding{-kInfinity, "there is no such joint"};
  for (const Frame& frame : run.frames)
    for (const scene::JointSpec& joint : scene.joints) {
      if (!check.link.empty() && joint.name != check.link) continue;
      const Carried a = carried_by(joint.body_a, scene, run, frame), b = carried_by(joint.body_b, scene, run, frame);
      finding.worst(of_joint(joint, a, b), joint.name + " " + at_time(frame.time));
    }
  if (finding.value == -kInfinity) finding.value = kInfinity;   // nothing to judge is not right
  return finding;
}

/// How far off a truth, as a part of it; where the truth is 0, in its own unit.
double relative_error(double found, double expected) { return std::abs(found - expected) / (expected == 0.0 ? 1.0 : std::abs(expected)); }

template <class Link>
const double* force_in(const std::vector<Link>& links, const std::vector<double>& forces, const std::string& name) {
  for (std::size_t i = 0; i < std::min(links.size(), forces.size()); ++i)
    if (links[i].name == name) return &forces[i];
  return nullptr;
}

}  // namespace

Finding rod_length(const CheckSpec& check, const Scene& scene, const Trajectory& run) {
  Finding finding{-kInfinity, "there is no such rod"};
  for (const Frame& frame : run.frames)
    for (const scene::RodSpec& rod : scene.rods) {
      if (!check.link.empty() && rod.name != check.link) continue;
      const double length = (place(rod.b, run, frame) - place(rod.a, run, frame)).norm();
      finding.worst(std::abs(length - rod.length_m), fmt::format("{} is {:.9g} m long {}", rod.name, length, at_time(frame.time)));
    }
  if (finding.value == -kInfinity) finding.value = kInfinity;
  return finding;
}

Finding joint_gap(const CheckSpec& check, const Scene& scene, const Trajectory& run) {
  return worst_of_joints(check, scene, run, [](const scene::JointSpec& joint, const Carried& a, const Carried& b) {
    return (a.point(joint.point_m) - b.point(joint.point_m)).norm();
  });
}

Finding joint_angle(const CheckSpec& check, const Scene& scene, const Trajectory& run) {
  return worst_of_joints(check, scene, run, [](const scene::JointSpec& joint, const Carried& a, const Carried& b) {
    if (joint.kind == scene::JointKind::kBall) return 0.0;   // free to turn
    if (joint.kind == scene::JointKind::kHinge) return angle_between(a.turned * joint.axis, b.turned * joint.axis);
    return angle_of(a.turned * b.turned.conjugate());
  });
}

Finding link_force(const CheckSpec& check, const Scene& scene, const Trajectory& run) {
  const Frame* frame = frame_at(check.at_s, run);
  if (frame == nullptr) return {kInfinity, fmt::format("no frame was recorded {}", at_time(check.at_s))};
  const double* found = nullptr;
  for (const effects::Effect* effect : effects::all())
    if (const auto kept = effect->measured_as(); kept && found == nullptr) found = force_in(effect->links(scene), frame->*kept, check.link);
  if (found == nullptr) found = force_in(scene.rods, frame->rod_tensions, check.link);
  if (found == nullptr) found = force_in(scene.joints, frame->joint_forces, check.link);
  if (found == nullptr) return {kInfinity, fmt::format("the run has no force of '{}'", check.link)};
  Finding finding;
  finding.worst(relative_error(*found, check.expected[0]), fmt::format("{:.9g} N, expected {:.9g} N, {}", *found, check.expected[0], at_time(frame->time)));
  return finding;
}

Finding reaction(const CheckSpec& check, const Scene&, const Trajectory& run) {
  const Frame* frame = frame_at(check.at_s, run);
  if (frame == nullptr) return {kInfinity, fmt::format("no frame was recorded {}", at_time(check.at_s))};
  const int body = index_of(check.body, run), other = check.other.empty() ? -1 : index_of(check.other, run);
  Vector3d force_world = Vector3d::Zero();
  int points = 0;
  for (const ContactPoint& contact : frame->contacts) {
    const bool is_a = contact.body_a == body, is_b = contact.body_b == body;
    if ((!is_a && !is_b) || (other >= 0 && (is_a ? contact.body_b : contact.body_a) != other)) continue;
    force_world += (is_a ? 1.0 : -1.0) * contact.force_on_a_world;
    ++points;
  }
  const double found = check.axis->dot(force_world);
  Finding finding;
  finding.worst(relative_error(found, check.expected[0]), fmt::format("{:.9g} N in {} points, expected {:.9g} N, {}", found, points, check.expected[0], at_time(frame->time)));
  return finding;
}

}  // namespace tumble::engines
