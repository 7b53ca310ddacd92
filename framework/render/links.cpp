#include "framework/render/links.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "framework/effects/registry.h"
#include "framework/render/stage_geometries.h"
#include "framework/render/surfaces.h"

namespace tumble::render {
namespace {

// distance between turns in radii of the coil, at its length turned_m
constexpr double kPitch = 0.9;
constexpr double kWire = 0.17;  // radii of the coil
// fraction of a coil's length from the axis to the turns, at each end
constexpr double kHook = 0.07;
const Vector3d kSpringColor(0.10, 0.13, 0.17), kRodColor(0.16, 0.18, 0.21),
    kJointColor(0.52, 0.30, 0.03);

// Sizes relative to the distance of the camera's target: 0.004 is two pixels in a picture of height
// 480 at 40 degrees.
constexpr double kCoilRadius = 0.016, kRodRadius = 0.0032, kBallRadius = 0.0075;

// A point of the coil's centre line.
Vector3d on_coil(double share, int turns) {
  const double ramp = std::clamp(std::min(share, 1.0 - share) / kHook, 0.0, 1.0);
  const double radius = (1.0 - kWire) * ramp * ramp * (3.0 - 2.0 * ramp),
               angle = 2 * std::numbers::pi * turns * share;
  return {radius * std::cos(angle), radius * std::sin(angle), share};
}

int coil_level(double turns) {
  int level = 0;
  while (level + 1 < kCoilLevels && turns > 1.4 * coil_turns(level)) ++level;
  return level;
}

bool is_finite(const Link& link) { return link.a_world.allFinite() && link.b_world.allFinite(); }

}  // namespace

Geometry unit_coil(int turns) {
  constexpr int kSegments = 14, kSides = 6;  // per turn; around the wire
  // of the wire along z; scaling to turned_m undoes it
  const double squeeze = 1.0 / (kPitch * turns);
  Geometry coil;
  const int rings = kSegments * turns;
  for (int i = 0; i <= rings; ++i) {
    const double share = static_cast<double>(i) / rings, step = 0.5 / rings;
    const Vector3d middle = on_coil(share, turns);
    Vector3d along =
        on_coil(std::min(1.0, share + step), turns) - on_coil(std::max(0.0, share - step), turns);
    along.z() /= squeeze;
    const Vector3d side = along.normalized().cross(Vector3d(0.02, 0.01, 1.0)).normalized(),
                   up = side.cross(along.normalized());
    for (int k = 0; k < kSides; ++k) {
      const double angle = 2 * std::numbers::pi * k / kSides;
      const Vector3d out = std::cos(angle) * side + std::sin(angle) * up;
      const Vector3d place = middle + kWire * Vector3d(out.x(), out.y(), out.z() * squeeze);
      // Scaling along z divides the normal's z by the scale: this normal becomes `out`.
      const Vector3d normal = Vector3d(out.x(), out.y(), out.z() / squeeze).normalized();
      Vertex vertex;
      for (int axis = 0; axis < 3; ++axis)
        vertex.position[axis] = static_cast<float>(place[axis]),
        vertex.normal[axis] = static_cast<float>(normal[axis]);
      coil.vertices.push_back(vertex);
      if (i == rings) continue;
      const auto at = [&](int ring, int corner) {
        return static_cast<std::uint32_t>(ring * kSides + corner % kSides);
      };
      for (const std::uint32_t corner :
           {at(i, k), at(i + 1, k + 1), at(i, k + 1), at(i, k), at(i + 1, k), at(i + 1, k + 1)})
        coil.indices.push_back(corner);
    }
  }
  return coil;
}

void draw_links(const std::vector<Link>& links, int height, Drawing& drawing) {
  std::map<int, std::vector<Instance>> solid;  // by geometry
  const auto add_ball = [&](const Vector3d& centre, double radius, const Vector3d& color) {
    const int level = ball_level(radius / metres_per_pixel(drawing.view, height, centre));
    solid[kBall + level].push_back(placed(drawing.from_origin(centre), Eigen::Matrix3d::Identity(),
                                          Vector3d::Constant(radius), color));
  };
  for (const Link& link : links) {
    if (!is_finite(link)) continue;
    const Vector3d a = drawing.from_origin(link.a_world), b = drawing.from_origin(link.b_world);
    const double width_pixels =
        link.width_m / metres_per_pixel(drawing.view, height, 0.5 * (link.a_world + link.b_world));
    const Vector3d& color = link.kind == LinkKind::kSpring ? kSpringColor
                            : link.kind == LinkKind::kRod  ? kRodColor
                                                           : kJointColor;
    if (link.kind == LinkKind::kBallJoint) add_ball(link.a_world, link.width_m, color);
    if (link.kind == LinkKind::kRod)
      add_ball(link.a_world, 1.7 * link.width_m, color),
          add_ball(link.b_world, 1.7 * link.width_m, color);
    // a spring may have no length
    if (!((b - a).norm() > 0.0) || link.kind == LinkKind::kBallJoint) continue;
    const bool is_coil =
        link.kind == LinkKind::kSpring && !(width_pixels >= 0.0 && width_pixels < 2.0);
    const int geometry = is_coil ? kCoil + coil_level(link.turned_m / (kPitch * link.width_m))
                                 : static_cast<int>(kRod);
    const double width =
        link.kind == LinkKind::kSpring && !is_coil ? 0.5 * link.width_m : link.width_m;
    solid[geometry].push_back(laid_between(a, b, width, color));
  }
  for (auto& [geometry, instances] : solid)
    drawing.batches.push_back({geometry, Pass::kSolid, std::move(instances)});
}

SceneLinks::SceneLinks(const scene::Scene& scene, const Frame& first, double sight_m,
                       const std::vector<double>& radius_m) {
  std::map<std::string, int> index;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i)
    index[scene.bodies[i].name] = static_cast<int>(i);
  const auto body_of = [&](const std::string& name) { return name.empty() ? -1 : index.at(name); };
  // a point given in the world at the start
  const auto fixed = [&](int body, const Vector3d& point_world) {
    if (body < 0) return Anchor{body, point_world};
    const BodyPose& pose = first.poses[static_cast<std::size_t>(body)];
    return Anchor{body, pose.world_from_body.conjugate() * (point_world - pose.com_world)};
  };
  const auto place = [&](const Anchor& at) -> Vector3d {
    if (at.body < 0) return at.point;
    const BodyPose& pose = first.poses[static_cast<std::size_t>(at.body)];
    return pose.com_world + pose.world_from_body * at.point;
  };
  const auto slim = [&](double share, std::initializer_list<int> bodies) {
    double width = share * sight_m;
    for (const int body : bodies)
      if (body >= 0 && radius_m[static_cast<std::size_t>(body)] > 0.0)
        width = std::min(width, 0.4 * radius_m[static_cast<std::size_t>(body)]);
    return width;
  };
  const effects::Drawables drawn = effects::drawn(scene);
  const auto point = [&](const effects::DrawnPoint& drawn_point) {
    return Anchor{body_of(drawn_point.body), drawn_point.point};
  };
  for (const effects::DrawnCoil& coil : drawn.coils) {
    const Anchor a = point(coil.a), b = point(coil.b);
    const double length = std::max((place(b) - place(a)).norm(),
                                   std::isfinite(coil.rest_length) ? coil.rest_length : 0.0);
    const double wound = std::max(length, 0.05 * sight_m);
    links_.push_back(
        {LinkKind::kSpring, a, b, std::min(kCoilRadius * sight_m, wound / 7.0), wound});
  }
  for (const effects::DrawnBar& bar : drawn.bars) {
    const Anchor a = point(bar.a), b = point(bar.b);
    links_.push_back({LinkKind::kRod, a, b, slim(kRodRadius, {a.body, b.body}), 0.0});
  }
  for (const effects::DrawnPivot& pivot : drawn.pivots) {
    using Kind = effects::DrawnPivot::Kind;
    const int a = body_of(pivot.body_a), b = body_of(pivot.body_b);
    const double width = slim(kBallRadius, {a, b});
    if (pivot.kind == Kind::kBall)
      links_.push_back({LinkKind::kBallJoint, fixed(a, pivot.point_world),
                        fixed(a, pivot.point_world), width, 0.0});
    if (pivot.kind != Kind::kPin) continue;  // a weld is not drawn
    const Vector3d half = 2.2 * width * pivot.axis_world.normalized();
    links_.push_back({LinkKind::kHinge, fixed(a, pivot.point_world - half),
                      fixed(a, pivot.point_world + half), 0.7 * width, 0.0});
  }
}

std::vector<Link> SceneLinks::at(const Frame& frame) const {
  std::vector<Link> links;
  const auto place = [&](const Anchor& at) -> Vector3d {
    if (at.body < 0) return at.point;
    const BodyPose& pose = frame.poses[static_cast<std::size_t>(at.body)];
    return pose.com_world + pose.world_from_body * at.point;
  };
  for (const Placed& link : links_) {
    const Link now{link.kind, place(link.a), place(link.b), link.width_m, link.turned_m};
    if (is_finite(now)) links.push_back(now);
  }
  return links;
}

}  // namespace tumble::render
