#include "framework/engines/events/world_part.h"

#include <algorithm>

#include "framework/effects/registry.h"

namespace tumble::engines {
namespace {

int place_of(const std::vector<int>& bodies, int body) {
  const auto found = std::lower_bound(bodies.begin(), bodies.end(), body);
  return found != bodies.end() && *found == body ? static_cast<int>(found - bodies.begin()) : -1;
}

// Without its shape, which may be large.
WorldBody body_of(const WorldBody& whole) {
  WorldBody body{whole.name,     whole.inertia,        Sphere{0.0},          whole.restitution,
                 whole.friction, whole.collides,       whole.passes_movable, whole.state,
                 whole.motion,   whole.com_at_0_world, whole.has_no_size};
  return body;
}

void note(std::vector<std::vector<int>>& places, int body, std::size_t index) {
  if (body < 0) return;
  std::vector<int>& its = places[static_cast<std::size_t>(body)];
  if (its.empty() || its.back() != static_cast<int>(index)) its.push_back(static_cast<int>(index));
}

// The union over all members, ascending, in the order of the whole world.
std::vector<int> of_members(const std::vector<std::vector<int>>& places,
                            const std::vector<int>& members) {
  std::vector<int> indices;
  for (const int body : members)
    indices.insert(indices.end(), places[static_cast<std::size_t>(body)].begin(),
                   places[static_cast<std::size_t>(body)].end());
  std::sort(indices.begin(), indices.end());
  indices.erase(std::unique(indices.begin(), indices.end()), indices.end());
  return indices;
}

}  // namespace

EntriesByBody::EntriesByBody(const World& whole) {
  for (const effects::Effect* effect : effects::all()) {
    Places& places = effects_.emplace_back();
    const int count = effect->count_in(whole);
    if (count > 0) places.resize(whole.bodies.size());
    for (int entry = 0; entry < count; ++entry)
      for (const int body : effect->bodies_of(whole, entry))
        note(places, body, static_cast<std::size_t>(entry));
  }
  apart_.resize(whole.bodies.size());
  for (std::size_t k = 0; k < whole.apart.size(); ++k)
    for (const int body : {whole.apart[k].first, whole.apart[k].second}) note(apart_, body, k);
}

struct PartMaker {
  const World& whole;
  const EntriesByBody& entries;
  const std::vector<int>& members;

  WorldPart make(const std::vector<int>& still) const {
    WorldPart part;
    World& world = part.world;
    take_bodies(still, part);
    for (const int body : part.bodies)
      world.bodies.push_back(body_of(whole.bodies[static_cast<std::size_t>(body)]));
    for (const int member : members) part.members.push_back(place_of(part.bodies, member));
    world.gravity_world = whole.gravity_world;
    world.contact = whole.contact;
    world.stabilisation = whole.stabilisation;
    world.coordinates = whole.coordinates;
    const auto in_part = [&](int body) { return body < 0 ? body : place_of(part.bodies, body); };
    for (std::size_t k = 0; k < part.entries.size(); ++k)
      if (!part.entries[k].empty())
        effects::all()[k]->copy_entries(whole, part.entries[k], in_part, world);
    for (const int k : of_members(entries.apart_, members)) {
      const auto& [a, b] = whole.apart[static_cast<std::size_t>(k)];
      if (in_part(a) >= 0 && in_part(b) >= 0) world.apart.emplace_back(in_part(a), in_part(b));
    }
    return part;
  }

 private:
  // Adds the members, the immovable bodies, and the bodies that entries of members name.
  void take_bodies(const std::vector<int>& still, WorldPart& part) const {
    part.bodies = members;
    part.bodies.insert(part.bodies.end(), still.begin(), still.end());
    for (std::size_t k = 0; k < entries.effects_.size(); ++k) {
      part.entries.push_back(entries.effects_[k].empty()
                                 ? std::vector<int>{}
                                 : of_members(entries.effects_[k], members));
      for (const int entry : part.entries.back())
        for (const int body : effects::all()[k]->bodies_of(whole, entry))
          if (body >= 0) part.bodies.push_back(body);
    }
    std::sort(part.bodies.begin(), part.bodies.end());
    part.bodies.erase(std::unique(part.bodies.begin(), part.bodies.end()), part.bodies.end());
  }
};

WorldPart part_of(const World& whole, const EntriesByBody& entries, const std::vector<int>& members,
                  const std::vector<int>& still) {
  return PartMaker{whole, entries, members}.make(still);
}

}  // namespace tumble::engines
