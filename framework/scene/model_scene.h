/// A scene of one .3ds file, made at once: to see what a model does before anybody writes a scene about it.
///
/// Free in space (the default) nothing acts on it: it turns slowly, so that all its sides are seen, and can be pushed. Dropped, it falls
/// on a floor. Camera, grid, step and duration follow from the model's size, so that a bead and a ship are seen alike.
#pragma once

#include <filesystem>
#include <string>

#include "framework/scene/scene.h"

namespace tumble::scene {

struct ModelSceneOptions {
  double metres_per_unit = 1.0;    // length of the file's unit [m], > 0: the format does not say it
  double density_kg_m3 = 1000.0;   // > 0; water's
  bool is_dropped = false;         // onto a floor, under gravity; else free in space
  bool turns = true;               // free in space: slowly, about a skew axis; else it rests
};

/// Whether a word names a model rather than a scene: by its ending, or a file that begins as 3DS does.
bool names_model(const std::string& word);

/// Every object of the file is a body, turned as in the file; several stand side by side, clear of each other. With checks.
/// @throws UserError when the file cannot be read, or an object is not closed (with each defect and its remedy)
Scene make_model_scene(const std::filesystem::path& file, const ModelSceneOptions& options = {});

}  // namespace tumble::scene
