#include "framework/engines/stepping/start_watch.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "framework/engines/base/tolerances.h"
#include "framework/scene/words.h"

namespace tumble::engines {
namespace {

constexpr std::size_t kMostNamed = 3;

std::string show(const Vector3d& v) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", v.x(), v.y(), v.z());
}

/// Rods and joints.
std::vector<scene::Link> holding_links(const scene::Scene& scene) {
  std::vector<scene::Link> all;
  for (const scene::Words* words : scene::all_words())
    if (words->traits().constrains)
      for (scene::Link& link : words->links(scene)) all.push_back(std::move(link));
  return all;
}

/// By body's name: the rods and joints that hold it.
std::map<std::string, std::string> holders(const scene::Scene& scene) {
  std::map<std::string, std::string> all;
  const auto add = [&](const std::string& body, const std::string& link) {
    if (body.empty()) return;
    std::string& links = all[body];
    links += (links.empty() ? "'" : ", '") + link + "'";
  };
  for (const scene::Link& link : holding_links(scene))
    add(link.a.body, link.name), add(link.b.body, link.name);
  return all;
}

/// How far the links of a scene reach from the bodies that they hold. [m]
double longest_arm(const scene::Scene& scene) {
  double arm = 0.0;
  for (const scene::Link& link : holding_links(scene)) {
    if (link.length_m > arm) arm = link.length_m;  // NaN is not
    for (const scene::AnchorSpec* anchor : {&link.a, &link.b})
      if (!anchor->body.empty()) arm = std::max(arm, anchor->point_m.norm());
  }
  return arm;
}

struct Change {
  double size;  // what is sorted by [m/s]
  std::string words;
};

}  // namespace

void StartWatch::frame(const Frame& frame) {
  if (!is_compared_ && scene::is_constrained(scene_)) compare(frame);
  is_compared_ = true;
  sink_.frame(frame);
}

void StartWatch::compare(const Frame& start) {
  const std::map<std::string, std::string> held_by = holders(scene_);
  const double arm = longest_arm(scene_);
  double fastest = 0.0;
  for (const scene::BodySpec& body : scene_.bodies)
    fastest = std::max(fastest, body.velocity_m_s.norm() + body.omega_world_rad_s.norm() * arm);
  std::vector<Change> changes;
  for (std::size_t i = 0; i < scene_.bodies.size(); ++i) {
    const scene::BodySpec& body = scene_.bodies[i];
    const auto links = held_by.find(body.name);
    if (body.immovable || links == held_by.end()) continue;
    const BodyPose& pose = start.poses[i];
    const double moved = (pose.com_world - body.position_m).norm();
    if (moved > kNegligible * (arm + body.position_m.cwiseAbs().maxCoeff()))
      notices_.push_back(
          fmt::format("the start place of '{}' does not fit what holds it ({}): moved by {:.3g} m, "
                      "to {} m. Give it that place as \"position_m\"",
                      body.name, links->second, moved, show(pose.com_world)));
    if (pushed_.contains(static_cast<int>(i))) continue;
    const double faster = (pose.velocity_world - body.velocity_m_s).norm(),
                 turns = (pose.omega_world - body.omega_world_rad_s).norm();
    if (!(faster + turns * arm > kSixDigits * fastest)) continue;
    changes.push_back({faster + turns * arm,
                       fmt::format("the start velocities of '{}' do not fit what holds it ({}): "
                                   "changed by {:.3g} m/s and {:.3g} rad/s, to \"velocity_m_s\" {} "
                                   "and \"angular_velocity_rad_s\" {}. Give it these, or "
                                   "others that leave rods and joints as long as they are",
                                   body.name, links->second, faster, turns,
                                   show(pose.velocity_world), show(pose.omega_world))});
  }
  std::stable_sort(changes.begin(), changes.end(),
                   [](const Change& a, const Change& b) { return a.size > b.size; });
  for (std::size_t k = 0; k < std::min(changes.size(), kMostNamed); ++k)
    notices_.push_back(changes[k].words);
  if (changes.size() > kMostNamed)
    notices_.push_back(fmt::format("and the start velocities of {} more bodies, by less",
                                   changes.size() - kMostNamed));
}

void StartWatch::end(const Counters& counters, const std::string& stopped_by) {
  if (notices_.empty()) return sink_.end(counters, stopped_by);
  Counters all = counters;
  all.notices.insert(all.notices.begin(), notices_.begin(), notices_.end());
  sink_.end(all, stopped_by);
}

}  // namespace tumble::engines
