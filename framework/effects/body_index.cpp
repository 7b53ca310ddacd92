#include "framework/effects/body_index.h"

#include "framework/core/error.h"

namespace tumble::effects {

BodyIndex::BodyIndex(const World& world) {
  for (std::size_t i = 0; i < world.bodies.size(); ++i) index_.emplace(world.bodies[i].name, static_cast<int>(i));
}

int BodyIndex::of(const std::string& name, const std::string& who) const {
  const auto found = index_.find(name);
  if (found == index_.end()) throw UserError(who, "no body is named '" + name + "'", "name one of the scene's bodies");
  return found->second;
}

Anchor BodyIndex::anchor(const scene::AnchorSpec& spec, const std::string& who) const { return {spec.body.empty() ? -1 : of(spec.body, who), spec.point_m}; }

}  // namespace tumble::effects
