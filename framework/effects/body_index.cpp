#include "framework/effects/body_index.h"

#include "framework/core/error.h"

namespace tumble::effects {

BodyIndex::BodyIndex(const World& world) {
  for (std::size_t i = 0; i < world.bodies.size(); ++i)
    index_.emplace(world.bodies[i].name, static_cast<int>(i));
}

int BodyIndex::of(const std::string& name, const std::string& subject) const {
  const auto found = index_.find(name);
  if (found == index_.end())
    throw UserError(subject, "no body is named '" + name + "'", "name one of the scene's bodies");
  return found->second;
}

Anchor BodyIndex::anchor(const scene::AnchorSpec& spec, const std::string& subject) const {
  return {spec.body.empty() ? -1 : of(spec.body, subject), spec.point_m};
}

void refuse_immovable(int a, int b, const World& world, const std::string& subject) {
  const auto can_move = [&](int body) {
    return body >= 0 && !world.bodies[static_cast<std::size_t>(body)].immovable();
  };
  if (!can_move(a) && !can_move(b))
    throw UserError(subject, "neither of its ends can move", "tie a movable body");
}

}  // namespace tumble::effects
