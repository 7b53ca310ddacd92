#include "framework/truths/known_positions.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "framework/effects/build_world.h"
#include "framework/engines/base/tolerances.h"
#include "framework/scene/words.h"

namespace tumble::truths {
namespace {

bool same(double a, double b) {
  return std::abs(a - b) <= engines::kCoordinateRounding * std::max(1.0, std::abs(b));
}
bool same(const Vector3d& a, const Vector3d& b) {
  return (a - b).norm() <= engines::kCoordinateRounding * std::max(1.0, b.norm());
}

bool falls_along_z(const scene::Scene& scene, double g) {
  const std::optional<Vector3d> gravity = build_world(scene).gravity_world;
  return gravity && same(*gravity, Vector3d(0.0, 0.0, -g));
}

/// Whether a scene has no entries but these, by their keys in a file.
bool asks_only(const scene::Scene& scene, const std::vector<std::string>& keys) {
  const auto& words = scene::all_words();
  return !scene.contact && std::none_of(words.begin(), words.end(), [&](const scene::Words* one) {
    return std::find(keys.begin(), keys.end(), one->key()) == keys.end() && one->is_asked(scene);
  });
}

/// Bob i is attached to bob i - 1, the first to the world's origin, each at its centre.
bool hangs_in_a_row(const scene::Scene& scene, const VectorXd& lengths) {
  const scene::Words* words = scene::words_of("rods");
  const std::vector<scene::Link> rods =
      words == nullptr ? std::vector<scene::Link>{} : words->links(scene);
  if (rods.size() != scene.bodies.size()) return false;
  for (std::size_t i = 0; i < rods.size(); ++i) {
    const scene::Link& rod = rods[i];
    const bool upper = rod.a.body == (i == 0 ? "" : scene.bodies[i - 1].name),
               lower = rod.b.body == scene.bodies[i].name;
    if (!upper || !lower || !rod.a.point_m.isZero(engines::kCoordinateRounding) ||
        !rod.b.point_m.isZero(engines::kCoordinateRounding) ||
        !same(rod.length_m, lengths[static_cast<Eigen::Index>(i)]))
      return false;
  }
  return true;
}

bool is_that_chain(const scene::Scene& scene, const Case& truth) {
  const VectorXd masses = truth.input("masses").vector(), lengths = truth.input("lengths").vector(),
                 angles = truth.input("theta0").vector();
  const std::size_t n = static_cast<std::size_t>(masses.size());
  if (scene.bodies.size() != n || !asks_only(scene, {"gravity_m_s2", "rods"})) return false;
  if (!falls_along_z(scene, truth.input("g").number())) return false;
  if (truth.input("omega0").vector().cwiseAbs().maxCoeff() != 0.0 ||
      !hangs_in_a_row(scene, lengths))
    return false;
  Vector3d place = Vector3d::Zero();
  for (std::size_t i = 0; i < n; ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    const scene::BodySpec& bob = scene.bodies[i];
    place += lengths[at] * Vector3d(std::sin(angles[at]), 0.0, -std::cos(angles[at]));
    if (!bob.mass_kg || !same(*bob.mass_kg, masses[at]) || !same(bob.position_m, place) ||
        !bob.velocity_m_s.isZero(0.0) || !bob.omega_world_rad_s.isZero(0.0))
      return false;
  }
  return true;
}

std::vector<KnownPosition> places_of_chain(const scene::Scene& scene, const Case& truth) {
  if (!is_that_chain(scene, truth)) return {};
  std::vector<KnownPosition> places;
  for (const Value& time : truth.input("times").list()) {
    const Value& rows = truth.output("positions_t" + time.text());
    for (std::size_t i = 0; i < rows.list().size(); ++i)
      places.push_back(
          {time.number(),
           i,
           {rows.at(i).at(std::size_t{0}).number(), 0.0, rows.at(i).at(std::size_t{1}).number()}});
  }
  return places;
}

std::vector<KnownPosition> places_of_ball(const scene::Scene& scene, const Case& truth) {
  if (scene.bodies.size() != 2 || !asks_only(scene, {"gravity_m_s2"}) ||
      !falls_along_z(scene, truth.input("g").number()))
    return {};
  const std::size_t which = scene.bodies[0].immovable ? 1 : 0;
  const scene::BodySpec &ball = scene.bodies[which], &floor = scene.bodies[1 - which];
  const auto* sphere = std::get_if<scene::SphereSpec>(&ball.shape);
  const bool is_floor =
      floor.immovable && std::holds_alternative<scene::PlaneSpec>(floor.shape) &&
      floor.position_m.isZero(0.0) &&
      floor.world_from_body.isApprox(Quaterniond::Identity(), engines::kCoordinateRounding);
  if (sphere == nullptr || !is_floor || ball.immovable || !ball.velocity_m_s.isZero(0.0) ||
      !same(std::min(ball.restitution, floor.restitution), truth.input("e").number()))
    return {};
  if (!same(ball.position_m, Vector3d(0.0, 0.0, truth.input("h").number() + sphere->radius_m)))
    return {};
  std::vector<KnownPosition> places;
  for (const Value& time : truth.input("times").list())  // heights are those of the lowest point
    places.push_back({time.number(),
                      which,
                      {0.0, 0.0, truth.output("z_t" + time.text()).number() + sphere->radius_m}});
  return places;
}

}  // namespace

std::vector<KnownPosition> known_positions(const scene::Scene& scene, const Case& truth) {
  if (truth.family == "chain" || truth.family == "double_pendulum")
    return places_of_chain(scene, truth);
  if (truth.family == "bouncing_ball") return places_of_ball(scene, truth);
  return {};
}

}  // namespace tumble::truths
