#include "framework/effects/build_world.h"

#include <algorithm>

#include "framework/core/error.h"
#include "framework/effects/registry.h"
#include "framework/scene/build_shape.h"
#include "framework/scene/check_scene.h"

namespace tumble {
namespace {

WorldBody build_body(const scene::BodySpec& spec, scene::Solid solid) {
  WorldBody body;
  body.name = spec.name;
  body.shape = std::move(solid.shape);
  body.restitution = spec.restitution;
  body.friction = spec.friction;
  body.collides = spec.collides;
  body.passes_movable = spec.passes_movable;
  body.com_at_0_world = spec.position_m;
  body.inertia = solid.is_immovable() ? infinite_inertia()
                                      : finite_inertia(solid.mass_kg, solid.inertia_body_kg_m2);
  const auto* sphere = std::get_if<scene::SphereSpec>(&spec.shape);
  body.has_no_size = sphere && sphere->radius_m == 0.0 && !spec.inertia_body_kg_m2;
  if (spec.motion) body.motion = *spec.motion;
  body.state.com_world = spec.position_m;
  body.state.world_from_body = spec.world_from_body.normalized();
  if (solid.is_immovable()) {
    if (!spec.omega_world_rad_s.isZero(0.0))
      throw UserError("body '" + spec.name + "'", "is immovable and has an angular velocity",
                      "immovable bodies do not turn: leave it out");
    body.state.momentum_world = body.state.angular_momentum_world = Vector3d::Zero();
    return body;
  }
  if (std::holds_alternative<HalfSpace>(body.shape))
    throw UserError("body '" + spec.name + "'", "is a plane without end that can move",
                    "mark it \"immovable\", or use a box");
  body.state.momentum_world = body.inertia.mass * spec.velocity_m_s;
  body.state.angular_momentum_world =
      angular_momentum_of(spec.omega_world_rad_s, body.state.world_from_body, body.inertia);
  return body;
}

bool is_constrained(const World& world) {
  return std::any_of(effects::all().begin(), effects::all().end(),
                     [&](const effects::Effect* effect) {
                       return effect->traits().constrains && effect->count_in(world) > 0;
                     });
}

void correct_positions(const scene::Scene& scene, const effects::BodyIndex& index, World& world) {
  std::vector<std::pair<std::string, std::string>> pairs = scene.apart;
  for (const effects::Effect* effect : effects::all())
    for (auto& pair : effect->pairs_apart(scene)) pairs.push_back(std::move(pair));
  for (const auto& [a, b] : pairs)
    world.apart.push_back(std::minmax({index.of(a, "apart"), index.of(b, "apart")}));
  std::sort(world.apart.begin(), world.apart.end());
  world.apart.erase(std::unique(world.apart.begin(), world.apart.end()), world.apart.end());
}

// What no effect of this program reads would be left out of the run without a word.
void refuse_unknown(const TypedLists& lists, const std::string& name) {
  std::size_t known = 0;
  for (const effects::Effect* effect : effects::all()) known += effect->is_kept_in(lists) ? 1 : 0;
  if (lists.types().size() > known)
    throw UserError(name, "asks for an effect that this program is not built with",
                    "add its line to framework/effects/CMakeLists.txt and build again");
}

}  // namespace

World build_world(const scene::Scene& scene) {
  World world;
  scene::check_ellipsoids(
      scene, [&](const std::string&, const std::string& problem, const std::string& remedy) {
        throw UserError(scene.name, problem, remedy);
      });
  std::vector<scene::Solid> solids = scene::build_solids(scene);
  for (std::size_t i = 0; i < scene.bodies.size(); ++i)
    world.bodies.push_back(build_body(scene.bodies[i], std::move(solids[i])));
  const effects::BodyIndex index(world);
  refuse_unknown(scene.effects, scene.name);
  for (const effects::Effect* effect : effects::all()) effect->build(scene, index, world);
  world.contact = scene.contact;
  if (is_constrained(world))
    world.stabilisation = scene.stabilisation.value_or(scene::StabilisationSpec{});
  world.coordinates = scene.coordinates;
  correct_positions(scene, index, world);
  return world;
}

}  // namespace tumble
