#include "framework/engines/stepping/far_points.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "framework/effects/build_world.h"
#include "framework/effects/registry.h"
#include "framework/geometry/shape.h"
#include "framework/scene/names.h"

namespace tumble::engines {
namespace {

// of the radius of the ball about the centre of mass that holds the body: a pivot just beside it is
// common, and seen in a picture
constexpr double kFarOutside = 1.5;

struct HeldPoint {
  std::string body;
  double arm;         // from the body's centre of mass [m]
  std::string words;  // "rod 'rod 1' holds"
};

/// Points of which one at least should be on its body: of a rod or a spring each end by itself, of
/// a joint between two bodies both; a joint to the world makes a pendulum of whatever hangs on it.
using Points = std::vector<HeldPoint>;

std::vector<Points> points_of_scene(const scene::Scene& scene) {
  std::vector<Points> all;
  for (const scene::Words* words : scene::all_words())
    for (const scene::Link& link : words->links(scene)) {
      Points ends;
      for (const scene::AnchorSpec& anchor : {link.a, link.b})
        if (!anchor.body.empty())
          ends.push_back({anchor.body, anchor.point_m.norm(),
                          fmt::format("{} '{}' holds", words->name(), link.name)});
      if (!std::isnan(link.length_m))
        for (const HeldPoint& end : ends) all.push_back({end});
      else if (ends.size() == 2)
        all.push_back(ends);
    }
  const scene::BodiesByName bodies(scene);
  for (const effects::DrawnArrow& force : effects::drawn(scene).arrows)
    if (const scene::BodySpec* body = bodies.find(force.body);
        body != nullptr && force.start_s <= 0.0)
      all.push_back(
          {{force.body, (force.point_world - body->position_m).norm(), "a force pushes"}});
  return all;
}

}  // namespace

std::optional<std::string> notice_of_far_points(const scene::Scene& scene) {
  std::vector<Points> all = points_of_scene(scene);
  std::erase_if(all, [](const Points& points) {
    return std::any_of(points.begin(), points.end(),
                       [](const HeldPoint& point) { return point.arm == 0.0; });
  });
  if (all.empty()) return std::nullopt;
  const World world = build_world(scene);
  const effects::BodyIndex index(world);
  const HeldPoint* farthest = nullptr;
  double most = kFarOutside, reach = 0.0;
  const auto radius_of = [&](const HeldPoint& point) {
    const WorldBody& body =
        world.bodies[static_cast<std::size_t>(index.of(point.body, point.words))];
    return body.immovable() ? 0.0 : bounding_radius(body.shape);
  };
  for (const Points& points : all) {
    const bool is_farther = std::all_of(points.begin(), points.end(), [&](const HeldPoint& point) {
      const double radius = radius_of(point);
      return radius > 0.0 && point.arm > most * radius;
    });
    if (!is_farther) continue;
    farthest = &points.front();
    reach = radius_of(*farthest);
    most = farthest->arm / reach;
  }
  if (farthest == nullptr) return std::nullopt;
  return fmt::format(
      "{} body '{}' at a point {:.3g} m from its centre of mass, while no part of the body is "
      "more than {:.3g} m from it: it acts as on an arm without mass. If that is not meant: "
      "\"point_body_m\" goes from the body's centre of mass along the body's axes, "
      "\"point_world_m\" and \"point_m\" are places in the world",
      farthest->words, farthest->body, farthest->arm, reach);
}

}  // namespace tumble::engines
