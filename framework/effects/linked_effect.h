/// Effects whose entries are links between two anchors: springs and rods, and in parts joints and
/// motors.
#pragma once

#include <string>
#include <vector>

#include <fmt/format.h>

#include "framework/core/error.h"
#include "framework/dynamics/stopped_run.h"
#include "framework/effects/listed_effect.h"
#include "framework/scene/check_links.h"

namespace tumble::effects {

/// An anchor, found in the lists of a group.
struct PlacedEnd {
  int place;
  Vector3d point_body;

  Vector3d point_among(const std::vector<Body>& bodies) const {
    return bodies[place].com_world + bodies[place].world_from_body * point_body;
  }
  AnchorState state_among(const std::vector<Body>& bodies) const {
    const Vector3d point_world = point_among(bodies);
    return {point_world, bodies[place].velocity_world + bodies[place].omega_world.cross(
                                                            point_world - bodies[place].com_world)};
  }
};
struct PlacedLink {
  int entry;  // in the world's list
  PlacedEnd a, b;
};

/// These links, with their places in the group. @tparam Held  has anchors a and b
template <class Held>
std::vector<PlacedLink> placed_links(const std::vector<Held>& all, const std::vector<int>& entries,
                                     GroupPlaces& places) {
  std::vector<PlacedLink> links;
  const auto placed = [&](const Anchor& anchor) {
    return PlacedEnd{places.place_of(anchor.body), anchor.point_body};
  };
  for (const int entry : entries) {
    const Held& link = all[static_cast<std::size_t>(entry)];
    const PlacedEnd a = placed(link.a);
    links.push_back({entry, a, placed(link.b)});
  }
  return links;
}

inline void add_force(const Body& body, const Vector3d& force_world, const Vector3d& point_world,
                      Wrench& wrench) {
  wrench.force_world += force_world;
  wrench.torque_world += (point_world - body.com_world).cross(force_world);
}

/// The laws that anything asks which holds by rows.
inline void append_laws_of_rows(const scene::Scene& scene, const Laws& laws,
                                std::vector<NeededLaw>& needed) {
  needed.push_back(
      {static_cast<bool>(laws.constraint_multipliers), "the multipliers of rods and joints", "a3"});
  needed.push_back(
      {static_cast<bool>(laws.constraint_correction), "the correction onto rods and joints", "a3"});
  if (scene.stabilisation && scene.stabilisation->kind == scene::StabilisationKind::kBaumgarte)
    needed.push_back(
        {static_cast<bool>(laws.baumgarte_acceleration), "Baumgarte's acceleration", "a3"});
}

/// Whose rows hold a link, for a message that says where a force comes from: in joint coordinates
/// a tree asks for none.
inline std::string rows_in_words(const World& world, const std::string& rows) {
  if (world.coordinates != scene::Coordinates::kReduced) return rows;
  return "in joint coordinates; " + rows + " in loops and contact only";
}

/// Squares and products of what bodies farther or faster than this have overflow; no scene's do.
inline constexpr double kRunAway = 1e100;  // m, m/s, rad/s

/// Whether a law can answer for the body.
inline bool moves_within_numbers(const Body& body) {
  const auto within = [](const Vector3d& v) { return (v.array().abs() < kRunAway).all(); };
  return within(body.com_world) && body.world_from_body.coeffs().allFinite() &&
         within(body.velocity_world) && within(body.omega_world);
}

/// Does `work`, which asks a law about the bodies at the ends of a link; a StoppedRun out of it is
/// thrown again with the link in front. Where these bodies have run away, no answer of the law
/// could be a number, and it is not blamed. Words are made where they are needed only: this is
/// asked at every stage.
template <class Work>
auto naming_link(const char* kind, const std::string& name, const Body& a, const Body& b,
                 Work&& work) {
  try {
    return work();
  } catch (const OutOfTime&) {
    throw;
  } catch (const StoppedRun& stop) {
    if (!moves_within_numbers(a) || !moves_within_numbers(b))
      throw StoppedRun(
          fmt::format("{} '{}': a body that it holds goes farther or faster than numbers do: the "
                      "steps have run away, and no law could answer for it",
                      kind, name));
    throw StoppedRun(fmt::format("{} '{}': {}", kind, name, stop.what()));
  }
}

/// @tparam Spec  has name, anchors a and b of the scene, pointer  @tparam Held  has anchors a and b
/// of the world
template <class Spec, class Held>
class LinkedEffect : public ListedEffect<Spec, Held> {
 public:
  /// What scene::Link::length_m says of it.
  virtual double length_of(const Spec& spec) const = 0;

  std::vector<scene::Link> links(const scene::Scene& scene) const override {
    std::vector<scene::Link> links;
    for (const Spec& spec : this->specs(scene))
      links.push_back({spec.name, spec.a, spec.b, length_of(spec), spec.pointer});
    return links;
  }
  void visit_places(TypedLists& effects, const scene::VisitPlace& visit) const override {
    for (Spec& spec : effects.of<Spec>())
      for (scene::AnchorSpec* anchor : {&spec.a, &spec.b})
        if (anchor->body.empty()) visit(anchor->point_m, scene::PlaceKind::kHolds);
  }
  std::vector<int> ends_of(const Held& link) const override { return {link.a.body, link.b.body}; }
  void rename_ends(Held& link, const std::function<int(int)>& other) const override {
    for (Anchor* anchor : {&link.a, &link.b})
      if (anchor->body >= 0) anchor->body = other(anchor->body);
  }

 protected:
  void read_ends(scene::Entry& entry, Spec& spec) const {
    spec.pointer = entry.pointer();
    spec.name = this->name() + " " + std::to_string(entry.number());
    entry.read("name", spec.name);
    spec.a = entry.anchor("a");
    spec.b = entry.anchor("b");
  }
  static double distance_at_start(scene::Entry& entry, const Spec& spec) {
    return (entry.place_at_start(spec.b) - entry.place_at_start(spec.a)).norm();
  }
  static std::string between(const Spec& spec) {
    const auto ending = [](const std::string& body) { return body.empty() ? "the world" : body; };
    return ending(spec.a.body) + " to " + ending(spec.b.body);
  }
  /// Both anchors of a link. @throws UserError where neither can move
  std::pair<Anchor, Anchor> anchors_of(const Spec& spec, const BodyIndex& index,
                                       const World& world) const {
    const std::string subject = this->name() + " '" + spec.name + "'";
    const std::pair<Anchor, Anchor> anchors{index.anchor(spec.a, subject),
                                            index.anchor(spec.b, subject)};
    refuse_immovable(anchors.first.body, anchors.second.body, world, subject);
    return anchors;
  }
};

}  // namespace tumble::effects
