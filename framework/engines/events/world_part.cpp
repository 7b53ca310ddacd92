#include "framework/engines/events/world_part.h"

#include <algorithm>

namespace tumble::engines {
namespace {

int place_of(const std::vector<int>& bodies, int body) {
  const auto found = std::lower_bound(bodies.begin(), bodies.end(), body);
  return found != bodies.end() && *found == body ? static_cast<int>(found - bodies.begin()) : -1;
}

// Without its solid, which may be large.
WorldBody body_of(const WorldBody& whole) {
  WorldBody body{whole.name, whole.inertia, Sphere{0.0}, whole.restitution, whole.friction, whole.collides, whole.passes_movable, whole.state, whole.motion, whole.com_at_0_world};
  return body;
}

template <class Link>
void take_links(const std::vector<Link>& whole, const std::vector<int>& members, const std::vector<int>& bodies, std::vector<Link>& part, std::vector<int>* indices) {
  for (std::size_t k = 0; k < whole.size(); ++k) {
    if (place_of(members, whole[k].a.body) < 0 && place_of(members, whole[k].b.body) < 0) continue;
    Link link = whole[k];
    for (Anchor* end : {&link.a, &link.b})
      if (end->body >= 0) end->body = place_of(bodies, end->body);
    part.push_back(std::move(link));
    if (indices) indices->push_back(static_cast<int>(k));
  }
}

std::vector<int> bodies_of_part(const World& whole, const std::vector<int>& members, const std::vector<int>& still) {
  std::vector<int> bodies = members;
  bodies.insert(bodies.end(), still.begin(), still.end());
  const auto take_ends = [&](const auto& links) {
    for (const auto& link : links)
      for (const auto& [end, other] : {std::pair{link.a.body, link.b.body}, std::pair{link.b.body, link.a.body}})
        if (place_of(members, end) >= 0 && other >= 0) bodies.push_back(other);
  };
  take_ends(whole.springs);
  take_ends(whole.rods);
  take_ends(whole.joints);
  std::sort(bodies.begin(), bodies.end());
  bodies.erase(std::unique(bodies.begin(), bodies.end()), bodies.end());
  return bodies;
}

}  // namespace

WorldPart part_of(const World& whole, const std::vector<int>& members, const std::vector<int>& still) {
  WorldPart part;
  part.bodies = bodies_of_part(whole, members, still);
  World& world = part.world;
  for (const int body : part.bodies) world.bodies.push_back(body_of(whole.bodies[body]));
  for (const int member : members) part.members.push_back(place_of(part.bodies, member));
  world.gravity_world = whole.gravity_world;
  world.contact = whole.contact;
  world.stabilisation = whole.stabilisation;
  std::vector<int> joints;
  take_links(whole.springs, members, part.bodies, world.springs, nullptr);
  take_links(whole.rods, members, part.bodies, world.rods, nullptr);
  take_links(whole.joints, members, part.bodies, world.joints, &joints);
  for (const Drag& drag : whole.drags)
    if (const int body = place_of(members, drag.body); body >= 0) world.drags.push_back({part.members[body], drag.linear, drag.angular});
  for (std::size_t k = 0; k < whole.motors.size(); ++k)
    if (const int joint = place_of(joints, whole.motors[k].joint); joint >= 0) {
      world.motors.push_back({joint, whole.motors[k].law});
      part.motors.push_back(static_cast<int>(k));
    }
  for (std::size_t k = 0; k < whole.point_forces.size(); ++k)
    if (const int body = place_of(members, whole.point_forces[k].body); body >= 0) {
      world.point_forces.push_back(whole.point_forces[k]);
      world.point_forces.back().body = part.members[body];
      part.forces.push_back(static_cast<int>(k));
    }
  for (const auto& [a, b] : whole.apart)
    if (const int i = place_of(part.bodies, a), j = place_of(part.bodies, b); i >= 0 && j >= 0) world.apart.emplace_back(i, j);
  return part;
}

}  // namespace tumble::engines
