#include "framework/engines/stepping/far_points.h"

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

std::vector<HeldPoint> points_off_centre(const scene::Scene& scene) {
  std::vector<HeldPoint> points;
  for (const scene::Words* words : scene::all_words())
    for (const scene::Link& link : words->links(scene))
      for (const scene::AnchorSpec& anchor : {link.a, link.b})
        if (!anchor.body.empty() && !anchor.point_m.isZero(0.0))
          points.push_back({anchor.body, anchor.point_m.norm(),
                            fmt::format("{} '{}' holds", words->name(), link.name)});
  const scene::BodiesByName bodies(scene);
  for (const effects::DrawnArrow& force : effects::drawn(scene).arrows)
    if (const scene::BodySpec* body = bodies.find(force.body);
        body != nullptr && force.start_s <= 0.0)
      points.push_back(
          {force.body, (force.point_world - body->position_m).norm(), "a force pushes"});
  return points;
}

}  // namespace

std::optional<std::string> notice_of_far_points(const scene::Scene& scene) {
  const std::vector<HeldPoint> points = points_off_centre(scene);
  if (points.empty()) return std::nullopt;
  const World world = build_world(scene);
  const effects::BodyIndex index(world);
  const HeldPoint* farthest = nullptr;
  double most = kFarOutside, reach = 0.0;
  for (const HeldPoint& point : points) {
    const WorldBody& body =
        world.bodies[static_cast<std::size_t>(index.of(point.body, point.words))];
    const double radius = bounding_radius(body.shape);
    if (body.immovable() || !(radius > 0.0) || !(point.arm > most * radius)) continue;
    farthest = &point;
    most = point.arm / radius;
    reach = radius;
  }
  if (farthest == nullptr) return std::nullopt;
  return fmt::format(
      "{} body '{}' at a point {:.3g} m from its centre of mass, and nothing of the body is "
      "farther "
      "from there than {:.3g} m: it acts as on an arm without mass. If that is not meant: "
      "\"point_body_m\" goes from the body's centre of mass along the body's axes, "
      "\"point_world_m\" and \"point_m\" are places in the world",
      farthest->words, farthest->body, farthest->arm, reach);
}

}  // namespace tumble::engines
