// Sizes are in metres, about 1 m across, so that a scene shows a model as it is.
#include "models/catalogue.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "framework/core/random.h"
#include "framework/geometry/shape.h"
#include "models/mountainside.h"
#include "models/surfaces.h"

namespace tumble::models {
namespace {

constexpr double kPi = std::numbers::pi;

/// Points of an arc in the (r, z) plane; angles from the outward horizontal, ccw.
void add_arc(std::vector<Vector2d>& profile, const Vector2d& centre, double radius, double from,
             double to, int steps) {
  for (int i = 0; i <= steps; ++i) {
    const double angle = from + (to - from) * i / steps;
    profile.push_back(centre + radius * Vector2d(std::cos(angle), std::sin(angle)));
  }
}

TriangleMesh torus() {
  constexpr double kRing = 0.4, kTube = 0.15;
  std::vector<Vector2d> profile;
  add_arc(profile, {kRing, 0.0}, kTube, 0.0, 2.0 * kPi * 23 / 24, 23);
  return revolve(profile, 48, true);
}

/// An L of three unit squares, a unit thick: the solid of Eberly's and Mirtich's examples, volume 3
/// by hand.
TriangleMesh l_shape() {
  return extrude({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}},
                 {{0, 1, 2}, {0, 2, 3}, {0, 3, 5}, {3, 4, 5}}, 0.0, 1.0);
}

/// The handle that turns over in weightlessness: a bar across (along x) on a stem (along y),
/// moments far apart.
TriangleMesh t_handle() {
  const std::vector<Vector2d> outline = {{-0.5, 0.0},    {-0.075, 0.0}, {-0.075, -0.45},
                                         {0.075, -0.45}, {0.075, 0.0},  {0.5, 0.0},
                                         {0.5, 0.15},    {-0.5, 0.15}};
  return extrude(outline, {{1, 2, 3}, {1, 3, 4}, {0, 1, 7}, {1, 4, 7}, {4, 5, 6}, {4, 6, 7}},
                 -0.075, 0.075);
}

TriangleMesh rod() { return revolve({{0, -0.5}, {0.05, -0.5}, {0.05, 0.5}, {0, 0.5}}, 32); }

TriangleMesh wedge() {
  return turned(extrude({{0, 0}, {1, 0}, {0, 0.5}}, {{0, 1, 2}}, -0.4, 0.4),
                Quaterniond(std::sqrt(0.5), std::sqrt(0.5), 0, 0));
}

/// An outline in the xz plane, counter-clockwise seen from -y, of a solid that reaches `half_width`
/// to both sides.
TriangleMesh upright(const std::vector<Vector2d>& outline, double half_width) {
  return turned(extrude(outline, {{0, 1, 2}, {0, 2, 3}}, -half_width, half_width),
                Quaterniond(std::sqrt(0.5), std::sqrt(0.5), 0, 0));
}

/// A stone of a semicircular arch of 25, of middle radius 1 m and this thickness [m]; the arch's
/// centre is the origin.
TriangleMesh arch_stone(double thickness) {
  constexpr double kHalfAngle = kPi / 50;
  const double s = std::sin(kHalfAngle), c = std::cos(kHalfAngle), inner = 1 - thickness / 2,
               outer = 1 + thickness / 2;
  return upright({{-inner * s, inner * c},
                  {inner * s, inner * c},
                  {outer * s, outer * c},
                  {-outer * s, outer * c}},
                 0.2);
}

/// A playing card to lean on another at 25 degrees: its top is cut so that the cut is upright when
/// the card leans.
TriangleMesh card() {
  constexpr double kThickness = 0.02, kLean = 25.0 / 180.0 * kPi;
  return upright(
      {{-kThickness, 0}, {0, 0}, {0, 1}, {-kThickness, 1 + kThickness / std::tan(kLean)}}, 0.36);
}

/// A tray that is open at the top, its underside at z = 0: what an arm holds a block in.
TriangleMesh scoop() {
  // as float32 holds them exactly: a block may lie on the floor
  constexpr double kOuter = 0.125, kInner = 0.1015625, kHigh = 0.1015625, kFloor = 0.015625;
  TriangleMesh mesh;
  // Rings of four corners: underside, outer rim, inner rim, floor.
  const double halves[] = {kOuter, kOuter, kInner, kInner}, heights[] = {0.0, kHigh, kHigh, kFloor};
  for (int ring = 0; ring < 4; ++ring)
    for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}})
      mesh.vertices.push_back({x * halves[ring], y * halves[ring], heights[ring]});
  const auto quad = [&](int a, int b, int c, int d) {
    mesh.faces.push_back({a, b, c});
    mesh.faces.push_back({a, c, d});
  };
  quad(3, 2, 1, 0);
  for (int ring = 0; ring < 3; ++ring)
    for (int k = 0; k < 4; ++k)
      quad(4 * ring + k, 4 * ring + (k + 1) % 4, 4 * ring + 4 + (k + 1) % 4, 4 * ring + 4 + k);
  quad(12, 13, 14, 15);
  return mesh;
}

/// Hull of points scattered about an ellipsoid: a stone as it comes off a beach.
TriangleMesh rock(std::uint64_t seed, int points, const Vector3d& half_axes) {
  Random random(seed);
  std::vector<Vector3d> cloud;
  while (static_cast<int>(cloud.size()) < points) {
    const Vector3d p(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1));
    if (p.norm() > 1.0 || p.norm() < 0.1) continue;  // uniform over directions
    const double radius = random.between(0.85, 1.1);
    cloud.push_back((radius * p.normalized()).cwiseProduct(half_axes));
  }
  return convex_hull(rounded({cloud, {}}).vertices);
}

/// Where a ray from the origin along `direction` leaves a ball that holds the origin. [m]
double far_side(const Vector3d& direction, const Vector3d& centre, double radius) {
  const double along = direction.dot(centre);
  return along + std::sqrt(std::max(0.0, along * along - centre.squaredNorm() + radius * radius));
}

/// H2O as balls of the van der Waals radii, 1 angstrom drawn as 0.25 m; the oxygen's centre, which
/// all three balls hold, is the origin. Radii: oxygen 1.52 (A. Bondi, J. Phys. Chem. 68, 1964),
/// hydrogen 1.10 (R. Rowland, R. Taylor, J. Phys. Chem. 100, 1996); bond 0.9584 angstrom, angle
/// 104.45 degrees (A. Hoy, P. Bunker, J. Mol. Spectrosc. 74, 1979).
TriangleMesh water_molecule() {
  constexpr double kScale = 0.25, kOxygen = 1.52, kHydrogen = 1.10, kBond = 0.9584,
                   kHalfAngle = 104.45 / 2.0 * kPi / 180.0;
  const Vector3d left(-kBond * std::sin(kHalfAngle), 0.0, -kBond * std::cos(kHalfAngle));
  const Vector3d right(-left.x(), 0.0, left.z());
  const auto radius = [&](const Vector3d& d) {
    return kScale *
           std::max({kOxygen, far_side(d, left, kHydrogen), far_side(d, right, kHydrogen)});
  };
  return star_shaped(radius, 4);
}

/// The hull of the same three balls, each by 42 points: as many collisions a second as balls have
/// are not to be had with thousands of faces.
TriangleMesh water_hull() {
  constexpr double kScale = 0.25, kOxygen = 1.52, kHydrogen = 1.10, kBond = 0.9584,
                   kHalfAngle = 104.45 / 2.0 * kPi / 180.0;
  const double x = kScale * kBond * std::sin(kHalfAngle),
               z = -kScale * kBond * std::cos(kHalfAngle);
  std::vector<Vector3d> points;
  // Turned differently, so that no four points lie in a plane: a hull of triangles is unique then.
  const auto turned = [](double angle) {
    return Quaterniond(Eigen::AngleAxisd(angle, Vector3d(1, 2, 3).normalized()));
  };
  for (const Vector3d& p : subdivided_sphere(1).vertices) {
    points.push_back(kScale * kOxygen * (turned(0.3) * p));
    points.push_back(kScale * kHydrogen * (turned(0.7) * p) + Vector3d(x, 0.0, z));
    points.push_back(kScale * kHydrogen * (turned(1.1) * p) + Vector3d(-x, 0.0, z));
  }
  return convex_hull(rounded({points, {}}).vertices);
}

TriangleMesh dumbbell() {
  constexpr double kBall = 0.2, kBar = 0.05, kApart = 0.35;
  // angle at which the bar enters a ball, from the axis
  const double meeting = std::asin(kBar / kBall);
  std::vector<Vector2d> profile;
  add_arc(profile, {0, -kApart}, kBall, -kPi / 2, kPi / 2 - meeting, 14);
  add_arc(profile, {0, kApart}, kBall, -kPi / 2 + meeting, kPi / 2, 14);
  profile.front().x() = profile.back().x() = 0.0;  // on the axis exactly
  return revolve(profile, 32);
}

/// A pawn in the manner of Staunton, 1 m tall.
TriangleMesh chess_pawn() {
  std::vector<Vector2d> profile = {{0, 0}, {0.31, 0}};
  add_arc(profile, {0.29, 0.055}, 0.045, -kPi / 3, kPi / 2, 6);  // rim of the foot
  add_arc(profile, {0.215, 0.14}, 0.055, -kPi / 4, kPi / 2, 5);  // step
  for (int i = 1; i <= 8; ++i) {                                 // stem, narrowing upward
    const double s = i / 8.0;
    profile.push_back({0.205 - 0.115 * std::sin(0.5 * kPi * s), 0.20 + 0.39 * s});
  }
  add_arc(profile, {0.15, 0.625}, 0.03, -kPi / 2, kPi / 2, 6);  // collar
  add_arc(profile, {0, 0.82}, 0.18, -0.30 * kPi, kPi / 2, 12);  // head
  profile.back().x() = 0.0;
  return revolve(profile, 40);
}

TriangleMesh gear() {
  constexpr int kTeeth = 12;
  std::vector<Vector2d> outline{Vector2d::Zero()};
  for (int tooth = 0; tooth < kTeeth; ++tooth) {
    // part of a tooth, radius
    const double corners[4][2] = {{0.00, 0.38}, {0.45, 0.38}, {0.58, 0.5}, {0.87, 0.5}};
    for (const auto& [part, radius] : corners) {
      const double angle = 2 * kPi * (tooth + part) / kTeeth;
      outline.push_back(radius * Vector2d(std::cos(angle), std::sin(angle)));
    }
  }
  // A ring of walls round an axle hole: outer and inner corners side by side.
  const int n = static_cast<int>(outline.size()) - 1;
  TriangleMesh mesh;
  for (double z : {-0.1, 0.1}) {
    for (int i = 1; i <= n; ++i) mesh.vertices.push_back({outline[i].x(), outline[i].y(), z});
    for (int i = 1; i <= n; ++i) {
      const Vector2d hole = 0.12 * outline[i].normalized();
      mesh.vertices.push_back({hole.x(), hole.y(), z});
    }
  }
  const auto quad = [&](int a, int b, int c, int d) {
    mesh.faces.push_back({a, b, c});
    mesh.faces.push_back({a, c, d});
  };
  for (int i = 0; i < n; ++i) {
    const int next = (i + 1) % n, up = 2 * n;
    quad(i, next, up + next, up + i);                    // teeth
    quad(n + next, n + i, up + n + i, up + n + next);    // hole
    quad(up + i, up + next, up + n + next, up + n + i);  // top
    quad(n + i, n + next, next, i);                      // bottom
  }
  return mesh;
}

}  // namespace

std::vector<Model> catalogue() {
  const TriangleMesh cube = box({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5});
  const auto constant = [](double radius) { return [radius](const Vector3d&) { return radius; }; };
  return {
      {"box.3ds", {{"box", cube}}},
      {"sphere.3ds", {{"sphere", star_shaped(constant(0.5), 4)}}},
      {"torus.3ds", {{"torus", torus()}}},
      {"l_shape.3ds", {{"l_shape", l_shape()}}},
      {"t_handle.3ds", {{"t_handle", t_handle()}}},
      {"rod.3ds", {{"rod", rod()}}},
      {"wedge.3ds", {{"wedge", wedge()}}},
      {"arch_stone.3ds", {{"arch_stone", arch_stone(0.12)}}},
      {"arch_stone_thin.3ds", {{"arch_stone", arch_stone(0.09)}}},
      {"card.3ds", {{"card", card()}}},
      {"rock_1.3ds", {{"rock_1", rock(1, 36, {0.5, 0.42, 0.33})}}},
      {"rock_2.3ds", {{"rock_2", rock(2, 24, {0.45, 0.45, 0.4})}}},
      {"rock_3.3ds", {{"rock_3", rock(3, 48, {0.6, 0.35, 0.25})}}},
      {"scoop.3ds", {{"scoop", scoop()}}},
      {"mountainside.3ds", {{"mountainside", mountainside()}}},
      {"water_molecule.3ds", {{"water", water_molecule()}}},
      {"water_hull.3ds", {{"water_hull", water_hull()}}},
      {"dumbbell.3ds", {{"dumbbell", dumbbell()}}},
      {"chess_pawn.3ds", {{"chess_pawn", chess_pawn()}}},
      {"gear.3ds", {{"gear", gear()}}},
      {"two_objects.3ds",
       {{"box", moved(cube, {-1, 0, 0})},
        {"ball", moved(star_shaped(constant(0.5), 3), {1, 0, 0})}}},
  };
}

}  // namespace tumble::models
