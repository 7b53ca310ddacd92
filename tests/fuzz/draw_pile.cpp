#include "tests/fuzz/draw_pile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "framework/core/math.h"
#include "framework/core/random.h"
#include "framework/scene/load_scene.h"

namespace tumble::fuzz {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<const char*, 4> kHulls{"rock_1.3ds", "rock_2.3ds", "rock_3.3ds", "wedge.3ds"};
constexpr double kHullReach = 0.9;  // of these models, at 1 m per unit [m]

Json triple(const Vector3d& v) { return Json::array({v.x(), v.y(), v.z()}); }

Vector3d direction(Random& random) {
  const double z = random.between(-1.0, 1.0), angle = random.between(0.0, 2.0 * std::numbers::pi),
               around = std::sqrt(1.0 - z * z);
  return {around * std::cos(angle), around * std::sin(angle), z};
}

/// A shape of about this size, half of them boxes. @return the radius of its bounding ball [m]
double draw_shape(Random& random, double size, Json& body) {
  const std::uint64_t kind = random.below(8);
  if (kind < 4) {
    const Vector3d edges = size * Vector3d(random.between(0.5, 1.0), random.between(0.5, 1.0),
                                           random.between(0.5, 1.0));
    body["shape"] = {{"box", {{"size_m", triple(edges)}}}};
    return 0.5 * edges.norm();
  }
  if (kind < 6) {
    body["shape"] = {{"sphere", {{"radius_m", 0.5 * size}}}};
    return 0.5 * size;
  }
  body["shape"] = {
      {"model", {{"file", kHulls[random.below(kHulls.size())]}, {"metres_per_unit", 0.7 * size}}}};
  return kHullReach * 0.7 * size;
}

}  // namespace

scene::Scene draw_pile(std::uint64_t number) {
  Random random(number);
  Json scene{{"title", fmt::format("pile {}", number)},
             {"duration_s", 0.75},
             {"step_s", 1.0 / 240},
             {"gravity_m_s2", triple({0, 0, -9.81})},
             {"contact", Json::object()}};
  scene["bodies"].push_back({{"name", "floor"},
                             {"shape", {{"plane", Json::object()}}},
                             {"immovable", true},
                             {"friction", random.between(0.2, 0.8)},
                             {"restitution", 1.0}});
  // Columns beside each other, each body just above the one below it.
  constexpr int kColumns = 4;
  const double cell = random.between(0.16, 0.24);  // m: neighbours touch, or nearly so
  std::array<double, kColumns> top;
  for (double& height : top) height = random.between(0.01, 0.1);
  const int bodies = 5 + static_cast<int>(random.below(11));
  for (int i = 0; i < bodies; ++i) {
    const double size = random.between(0.05, 0.2);
    Json body{{"name", fmt::format("b{}", i)}};
    const double reach = draw_shape(random, size, body);
    body["mass_kg"] = random.between(0.2, 2.0);
    body["friction"] = random.between(0.2, 0.8);
    body["restitution"] = random.below(2) == 0 ? 0.0 : random.between(0.1, 0.6);
    const int column = i % kColumns;
    // its neighbours' columns are as high: bounding balls keep apart
    const double floor_of_it = *std::max_element(top.begin(), top.end());
    const double low = reach > 0.5 * cell ? floor_of_it : top[static_cast<std::size_t>(column)];
    body["position_m"] = triple({cell * (column % 2), cell * (column / 2), low + reach});
    const double above = low + 2.0 * reach * random.between(1.005, 1.05);
    if (reach > 0.5 * cell) top.fill(above);
    top[static_cast<std::size_t>(column)] = above;
    body["orientation"] = {
        {"rotation_vector_rad", triple(random.between(0.0, 3.0) * direction(random))}};
    body["velocity_m_s"] = triple(random.between(0.0, 0.5) * direction(random));
    body["angular_velocity_rad_s"] = triple(random.between(0.0, 3.0) * direction(random));
    scene["bodies"].push_back(body);
  }
  return scene::parse_scene(scene.dump(1), fmt::format("pile_{}.json", number));
}

}  // namespace tumble::fuzz
