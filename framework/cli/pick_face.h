/// The first face that a ray hits: what a click on a picture selects.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "framework/dynamics/laws.h"
#include "framework/scene/scene.h"

namespace tumble::cli {

struct PickedFace {
  int body = -1;                          // index
  int face = -1;                          // of the body's surface as drawn
  Vector3d point_world = unset_vector();  // [m]
  double distance = kUnset;               // from the ray's origin [m]
};

/// A tree of boxes finds the face of each body, and the law computes the point on it. Where the two
/// disagree, the law is called for every face of that body, and its nearest answer counts.
/// @param laws  for intersect_ray_triangle; bodies whose bounding ball the ray misses are skipped
/// @param root  source root, for models
/// @return the nearest hit at time 0, or nothing
/// Cost: O(n log n) for the tree over a body's n faces, and one call of the law per body; n calls
/// where tree and law disagree
std::optional<PickedFace> pick_face(const scene::Scene& scene, const Laws& laws, const Ray& ray,
                                    const std::filesystem::path& root);

/// The nearest miss of a ray without a hit, for people: "it passes body 'box' at 0.53 m from its
/// centre, ...".
std::string nearest_miss(const scene::Scene& scene, const Ray& ray,
                         const std::filesystem::path& root);

}  // namespace tumble::cli
