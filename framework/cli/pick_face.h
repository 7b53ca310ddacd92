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

/// A tree of boxes finds the face of each body, and the law says where on it. Where the law does not say what the tree says, the
/// law is asked about every face of that body, and its nearest answer counts.
/// @param laws  whose intersect_ray_triangle is asked; bodies whose bounding ball the ray misses are not asked about
/// @param root  source root, where models are looked for
/// @return the nearest hit at time 0, or nothing
/// Cost: O(n log n) for the tree over a body's n faces, and one call of the law a body; n calls where tree and law disagree
std::optional<PickedFace> pick_face(const scene::Scene& scene, const Laws& laws, const Ray& ray, const std::filesystem::path& root);

/// What a ray that hits nothing came nearest to, for people: "it passes body 'box' at 0.53 m from its centre, ...".
std::string nearest_miss(const scene::Scene& scene, const Ray& ray, const std::filesystem::path& root);

}  // namespace tumble::cli
