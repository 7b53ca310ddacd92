#include "framework/engines/stepping/shared_forces.h"

#include <algorithm>

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

std::string listed(const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 4;
  std::string words;
  for (std::size_t k = 0; k < std::min(kMost, names.size()); ++k)
    words += (k == 0 ? "'" : ", '") + names[k] + "'";
  if (names.size() > kMost) words += fmt::format(" and {} more", names.size() - kMost);
  return words;
}

}  // namespace

std::optional<std::string> notice_of_shared_forces(const scene::Scene& scene,
                                                   const Laws& unguarded) {
  const bool is_linked =
      std::any_of(effects::all().begin(), effects::all().end(), [&](const effects::Effect* effect) {
        return effect->traits().constrains && !effect->links(scene).empty();
      });
  if (!unguarded.constraint_multipliers || !is_linked) return std::nullopt;
  const World world = build_world(scene);
  const Laws laws = guarded(unguarded);
  RunCounters counters;
  LinkForces shared(world);
  std::vector<RigidBodyState> states;
  for (const WorldBody& body : world.bodies) states.push_back(body.state);
  const auto weight = [&](int body, auto&&...) {
    const Inertia& inertia = world.bodies[static_cast<std::size_t>(body)].inertia;
    return Wrench{inertia.mass * world.gravity_world.value_or(Vector3d::Zero()), Vector3d::Zero()};
  };
  try {
    for (LinkedGroup& group : groups_of_linked_bodies(world))
      LinkedBodies(world, laws, counters, weight, std::move(group))
          .measure_shared(states, 0.0, shared);
  } catch (const StoppedRun&) {
    return std::nullopt;  // the run meets it, too, and says so
  }
  std::vector<std::string> names;
  for (std::size_t k = 0; k < shared.of_effects.size(); ++k) {
    const std::vector<scene::Link> links = effects::all()[k]->links(scene);
    for (std::size_t i = 0; i < links.size() && i < shared.of_effects[k].size(); ++i)
      if (shared.of_effects[k][i] > kShared) names.push_back(links[i].name);
  }
  if (names.empty()) return std::nullopt;
  return fmt::format(
      "the forces of {} are not unique: more rods and joints hold their bodies than statics can "
      "tell apart. What is recorded of each is one of many ways to share the load; what they do "
      "together is right. Springs in their place share it by their stiffness",
      listed(names));
}

}  // namespace tumble::engines
