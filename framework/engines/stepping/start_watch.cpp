#include "framework/engines/stepping/start_watch.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

namespace tumble::engines {
namespace {

// Of the fastest start: what decimals of six digits leave of velocities that were meant to fit is not worth a word.
constexpr double kTyped = 1e-6;
constexpr double kMoved = 1e-9;               // of the longest arm: load_scene lets a rod's length be off by as much as this
constexpr std::size_t kMostNamed = 3;

std::string show(const Vector3d& v) { return fmt::format("({:.6g}, {:.6g}, {:.6g})", v.x(), v.y(), v.z()); }

/// By body's name: the rods and joints that hold it.
std::map<std::string, std::string> holders(const scene::Scene& scene) {
  std::map<std::string, std::string> all;
  const auto add = [&](const std::string& body, const std::string& link) {
    if (body.empty()) return;
    std::string& links = all[body];
    links += (links.empty() ? "'" : ", '") + link + "'";
  };
  for (const scene::RodSpec& rod : scene.rods) add(rod.a.body, rod.name), add(rod.b.body, rod.name);
  for (const scene::JointSpec& joint : scene.joints) add(joint.body_a, joint.name), add(joint.body_b, joint.name);
  return all;
}

/// How far the links of a scene reach from the bodies that they hold. [m]
double longest_arm(const scene::Scene& scene) {
  double arm = 0.0;
  for (const scene::RodSpec& rod : scene.rods) arm = std::max({arm, rod.length_m, rod.a.body.empty() ? 0.0 : rod.a.point_m.norm(), rod.b.body.empty() ? 0.0 : rod.b.point_m.norm()});
  for (const scene::JointSpec& joint : scene.joints)
    for (const scene::BodySpec& body : scene.bodies)
      if (body.name == joint.body_a || body.name == joint.body_b) arm = std::max(arm, (joint.point_m - body.position_m).norm());
  return arm;
}

struct Change {
  double size;          // what is sorted by [m/s]
  std::string words;
};

}  // namespace

void StartWatch::frame(const Frame& frame) {
  if (!is_compared_ && (!scene_.rods.empty() || !scene_.joints.empty())) compare(frame);
  is_compared_ = true;
  sink_.frame(frame);
}

void StartWatch::compare(const Frame& start) {
  const std::map<std::string, std::string> held_by = holders(scene_);
  const double arm = longest_arm(scene_);
  double fastest = 0.0;
  for (const scene::BodySpec& body : scene_.bodies) fastest = std::max(fastest, body.velocity_m_s.norm() + body.omega_world_rad_s.norm() * arm);
  std::vector<Change> changes;
  for (std::size_t i = 0; i < scene_.bodies.size(); ++i) {
    const scene::BodySpec& body = scene_.bodies[i];
    const auto links = held_by.find(body.name);
    if (body.immovable || links == held_by.end()) continue;
    const BodyPose& pose = start.poses[i];
    const double moved = (pose.com_world - body.position_m).norm();
    if (moved > kMoved * (arm + body.position_m.cwiseAbs().maxCoeff()))
      notices_.push_back(fmt::format("the start place of '{}' does not fit what holds it ({}): moved by {:.3g} m, to {} m. Give it that place as \"position_m\"", body.name, links->second, moved, show(pose.com_world)));
    if (pushed_.contains(static_cast<int>(i))) continue;
    const double faster = (pose.velocity_world - body.velocity_m_s).norm(), turns = (pose.omega_world - body.omega_world_rad_s).norm();
    if (!(faster + turns * arm > kTyped * fastest)) continue;
    changes.push_back({faster + turns * arm, fmt::format("the start velocities of '{}' do not fit what holds it ({}): changed by {:.3g} m/s and {:.3g} rad/s, to \"velocity_m_s\" {} and \"angular_velocity_rad_s\" {}. Give it these, or "
                                                         "others that leave rods and joints as long as they are", body.name, links->second, faster, turns, show(pose.velocity_world), show(pose.omega_world))});
  }
  std::stable_sort(changes.begin(), changes.end(), [](const Change& a, const Change& b) { return a.size > b.size; });
  for (std::size_t k = 0; k < std::min(changes.size(), kMostNamed); ++k) notices_.push_back(changes[k].words);
  if (changes.size() > kMostNamed) notices_.push_back(fmt::format("and the start velocities of {} more bodies, by less", changes.size() - kMostNamed));
}

void StartWatch::end(const Counters& counters, const std::string& stopped_by) {
  if (notices_.empty()) return sink_.end(counters, stopped_by);
  Counters all = counters;
  all.notices.insert(all.notices.begin(), notices_.begin(), notices_.end());
  sink_.end(all, stopped_by);
}

}  // namespace tumble::engines
