#include "framework/scene/effects.h"

#include <algorithm>

#include <fmt/format.h>

namespace tumble::scene {
namespace {

/// Bodies that may collide; none where all of them are fixed or there is only one.
std::vector<const BodySpec*> colliding_bodies(const Scene& scene) {
  std::vector<const BodySpec*> bodies;
  for (const auto& body : scene.bodies)
    if (body.collides) bodies.push_back(&body);
  const bool can_meet =
      bodies.size() > 1 && std::any_of(bodies.begin(), bodies.end(),
                                       [](const BodySpec* body) { return !body->immovable; });
  return can_meet ? bodies : std::vector<const BodySpec*>{};
}

EffectUse collision(const Scene& scene) {
  EffectUse effect{"collision", "collision, impacts", "candidate_pairs", {}, ""};
  for (const BodySpec* body : colliding_bodies(scene))
    effect.askers.push_back(
        {body->pointer, fmt::format("{}: restitution {:g}", body->name, body->restitution)});
  if (!effect.is_on())
    effect.note = "no two bodies can collide: one alone, immovable, or \"collides\": false";
  return effect;
}

EffectUse contact(const Scene& scene) {
  EffectUse effect{"persistent contact", "contacts", "contact_solves", {}, ""};
  if (!scene.contact) return effect;
  if (colliding_bodies(scene).empty()) {
    effect.note = "/contact asks for it, but no two bodies can collide";
    return effect;
  }
  const bool simultaneous = scene.contact->impact_law == ImpactLaw::kSimultaneous;
  const PlasticImpacts plastic = scene.contact->plastic_impacts;
  effect.askers.push_back(
      {"/contact",
       fmt::format("impacts {}, plastic ones {}", simultaneous ? "simultaneous" : "sequential",
                   plastic == PlasticImpacts::kInStep ? "in their step"
                   : plastic == PlasticImpacts::kLocated
                       ? "at their instant"
                       : "at their instant, in busy heaps in their step")});
  return effect;
}

EffectUse friction(const Scene& scene) {
  EffectUse effect{"friction", "contacts", "friction_points", {}, ""};
  for (const BodySpec* body : colliding_bodies(scene))
    if (body->friction > 0.0)
      effect.askers.push_back({body->pointer.empty() ? "" : body->pointer + "/friction",
                               fmt::format("{}: {:g}", body->name, body->friction)});
  if (effect.askers.size() == 1)
    effect.note =
        effect.askers[0].pointer +
        " asks for it, but of a pair the smaller coefficient counts, and no other body has one";
  if (effect.is_on() && !scene.contact)
    effect.note = "it acts in persistent contact only, and the scene has none";
  if (!effect.note.empty()) effect.askers.clear();
  return effect;
}

EffectUse sleep(const Scene& scene) {
  EffectUse effect{"sleep", "sleep", "bodies_put_to_sleep", {}, ""};
  if (scene.contact && scene.contact->sleep && !colliding_bodies(scene).empty())
    effect.askers.push_back({"/contact/sleep", "bodies at rest are left alone"});
  return effect;
}

}  // namespace

std::vector<EffectUse> effects_of(const Scene& scene) {
  std::vector<EffectUse> effects;
  for (const Words* words : all_words())
    effects.push_back({words->name(), words->stage(), words->counter(), words->askers(scene),
                       words->note(scene)});
  for (const auto& use : {collision, contact, friction, sleep}) effects.push_back(use(scene));
  for (EffectUse& effect : effects)
    for (Asker& asker : effect.askers) asker.line = line_of(scene, asker.pointer);
  return effects;
}

}  // namespace tumble::scene
