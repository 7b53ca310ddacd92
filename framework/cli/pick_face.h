/// Which face of which body a ray meets first: what a click on a picture picks.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "framework/dynamics/laws.h"
#include "framework/scene/scene.h"

namespace tumble::cli {

struct PickedFace {
  int body = -1;                           // index
  int face = -1;                           // of the body's surface as it is drawn
  Vector3d point_world = unset_vector();   // [m]
  double distance = kUnset;                // from the ray's origin [m]
};

/// @param laws  whose intersect_ray_triangle decides; bodies far from the ray are not asked about
/// @param root  source root, where models are looked for
/// @return the nearest hit at time 0, or nothing
/// Cost: O(faces of the bodies whose bounding ball the ray meets)
std::optional<PickedFace> pick_face(const scene::Scene& scene, const Laws& laws, const Ray& ray, const std::filesystem::path& root);

/// What a ray that hits nothing came nearest to, for people: "it passes body 'box' at 0.53 m from its centre, ...".
std::string nearest_miss(const scene::Scene& scene, const Ray& ray, const std::filesystem::path& root);

}  // namespace tumble::cli
