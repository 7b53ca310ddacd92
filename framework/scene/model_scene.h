/// A scene made of one .3ds file, to see how a model moves before there is a scene file for it.
///
/// Free in space (the default) no force acts on it: it rotates slowly, so that all its sides are
/// seen, and can be pushed. Dropped, it falls on a floor. Camera, grid, step and duration follow
/// from the model's size, so that models of all sizes are seen alike.
#pragma once

#include <filesystem>
#include <string>

#include "framework/scene/scene.h"

namespace tumble::scene {

struct ModelSceneOptions {
  // length of the file's unit [m], > 0: the format does not contain it
  double metres_per_unit = 1.0;
  double density_kg_m3 = 1000.0;  // > 0; that of water
  bool is_dropped = false;        // onto a floor, under gravity; else free in space
  bool turns = true;              // free in space: slowly, about a skew axis; else it is at rest
};

/// Whether a word names a model and not a scene: by its extension, or the first bytes of the file.
bool names_model(const std::string& word);

/// Every object of the file becomes a body, oriented as in the file; several are placed side by
/// side without contact. With checks.
/// @throws UserError when the file cannot be read, or an object is not closed (with each defect and
///   its remedy)
Scene make_model_scene(const std::filesystem::path& file, const ModelSceneOptions& options = {});

}  // namespace tumble::scene
