/// The scene for a player's page, as JSON. Internal to framework/report.
#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "framework/geometry/shape.h"
#include "framework/scene/scene.h"
#include "framework/trajectory/trajectory.h"

namespace tumble::report {

/// By body: radius of its bounding ball about the origin; infinite for planes. [m]
std::vector<double> radii_of(const std::vector<Shape>& shapes);

/// Where the places of a page are measured from, in the world: zero, but near what the camera looks
/// at where that is far from the world's origin, so that the page's single precision is enough. [m]
Vector3d page_origin(const scene::Scene& scene);

/// Bodies (shape, colour), links with their anchors, camera, ground, point forces. SI units, world
/// and body frames as in scene.h; places in the world, and heights, from "origin": page_origin.
/// @param first  the run's first frame: joints are given in world coordinates at the start
nlohmann::ordered_json player_scene(const scene::Scene& scene, const std::vector<Shape>& shapes,
                                    const Frame& first);

}  // namespace tumble::report
