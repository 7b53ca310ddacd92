/// Builds the solid of a scene's body: its surface, mass and moments of inertia.
#pragma once

#include <filesystem>
#include <limits>
#include <vector>

#include "framework/geometry/shape.h"
#include "framework/scene/scene.h"

namespace tumble::scene {

struct Solid {
  Shape shape = HalfSpace{};  // body frame
  // > 0; +infinity for an immovable body
  double mass_kg = std::numeric_limits<double>::infinity();
  // (3,3), about the centre of mass; unset where the mass is infinite
  Matrix3d inertia_body_kg_m2 = Matrix3d::Constant(kUnset);
  bool is_immovable() const { return mass_kg == std::numeric_limits<double>::infinity(); }
};

/// @param body        one entry of a scene that load_scene accepted
/// @param scene_file  the scene's file: models are searched beside it first
/// @param root        source root, whose models/ is searched next; empty: the environment's
///   TUMBLE_ROOT, else the nearest folder above the scene file (or the working folder) with a
///   models/
/// @return body frame: origin at the centre of mass, axes of the mesh. A sphere of radius 0 is a
///   point mass: no force acts off its centre, so its rotation never changes; its inertia is m * (1
///   m)^2, which keeps the equations regular.
/// @throws UserError with the body when a model is missing, not closed, or has no or several
///   objects of that name
Solid build_solid(const BodySpec& body, const std::filesystem::path& scene_file,
                  const std::filesystem::path& root = {});

/// The files of the scene's models, each once, in alphabetical order; also those that are missing.
/// @param root  as for build_solid
std::vector<std::filesystem::path> model_files(const Scene& scene,
                                               const std::filesystem::path& root = {});

/// The solids of all bodies, by body index; a model of several bodies is read once.
std::vector<Solid> build_solids(const Scene& scene, const std::filesystem::path& root = {});

}  // namespace tumble::scene
