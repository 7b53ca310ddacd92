#include "framework/engines/stepping/shared_forces.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "framework/effects/build_world.h"
#include "framework/effects/registry.h"
#include "framework/engines/base/guarded_laws.h"
#include "framework/engines/stepping/body_groups.h"
#include "framework/engines/stepping/linked_bodies.h"

namespace tumble::engines {
namespace {

// Of all multipliers: a force that changes by less along one is told by statics but for rounding.
constexpr double kShared = 1e-2;
// Of the links that would stretch: one whose part is smaller is held by others.
constexpr double kStretched = 1e-2;

std::string listed(const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 4;
  std::string words;
  for (std::size_t k = 0; k < std::min(kMost, names.size()); ++k)
    words += (k == 0 ? "'" : ", '") + names[k] + "'";
  if (names.size() > kMost) words += fmt::format(" and {} more", names.size() - kMost);
  return words;
}

/// Names of the links of a scene that `measure` raises by more than `part` where it begins, under
/// gravity.
using Measure = void (LinkedBodies::*)(const std::vector<RigidBodyState>& states, double t,
                                       LinkForces& raised);
std::vector<std::string> links_at_start(const scene::Scene& scene, const Laws& unguarded,
                                        Measure measure, double part) {
  const bool is_linked =
      std::any_of(effects::all().begin(), effects::all().end(), [&](const effects::Effect* effect) {
        return effect->traits().constrains && !effect->links(scene).empty();
      });
  if (!unguarded.constraint_multipliers || !is_linked) return {};
  const World world = build_world(scene);
  const Laws laws = guarded(unguarded);
  RunCounters counters;
  LinkForces raised(world);
  std::vector<RigidBodyState> states;
  for (const WorldBody& body : world.bodies) states.push_back(body.state);
  const auto weight = [&](int body, auto&&...) {
    const Inertia& inertia = world.bodies[static_cast<std::size_t>(body)].inertia;
    return Wrench{inertia.mass * world.gravity_world.value_or(Vector3d::Zero()), Vector3d::Zero()};
  };
  try {
    for (LinkedGroup& group : groups_of_linked_bodies(world)) {
      LinkedBodies linked(world, laws, counters, weight, std::move(group));
      (linked.*measure)(states, 0.0, raised);
    }
  } catch (const StoppedRun&) {
    return {};  // the run meets it, too, and says so
  }
  std::vector<std::string> names;
  for (std::size_t k = 0; k < raised.of_effects.size(); ++k) {
    const std::vector<scene::Link> links = effects::all()[k]->links(scene);
    for (std::size_t i = 0; i < links.size() && i < raised.of_effects[k].size(); ++i)
      if (std::abs(raised.of_effects[k][i]) > part) names.push_back(links[i].name);
  }
  return names;
}

// @param words  with one place for the names of links
std::optional<std::string> notice_of(const std::vector<std::string>& links, const char* words) {
  if (links.empty()) return std::nullopt;
  return fmt::format(fmt::runtime(words), listed(links));
}

}  // namespace

std::optional<std::string> notice_of_shared_forces(const scene::Scene& scene, const Laws& laws) {
  return notice_of(
      links_at_start(scene, laws, &LinkedBodies::measure_shared, kShared),
      "the forces of {} are not unique: more rods and joints hold their bodies than statics can "
      "tell apart. What is recorded of each is one of many ways to share the load; what they do "
      "together is right. Springs in their place share it by their stiffness");
}

std::optional<std::string> notice_of_stretched_links(const scene::Scene& scene, const Laws& laws) {
  return notice_of(
      links_at_start(scene, laws, &LinkedBodies::measure_stretched, kStretched),
      "{} hold their bodies as a rope does that is stretched straight, or a linkage that lies "
      "flat: nothing holds these across it at first, and a moment later no finite force does. "
      "Nothing that follows can be trusted, with any step. Start off that posture, by a hundredth "
      "of its length or more, or take springs in place of some of them");
}

}  // namespace tumble::engines
