/// Scenes with the number of bodies as a parameter, at constant density: for the comparison of
/// engines.
///
/// They are made by code because a file has one size. In every other respect they are scenes: each
/// has a name, a default size, a camera, checks, and the same bytes for the same size.
#pragma once

#include <string>
#include <vector>

#include "framework/scene/scene.h"

namespace tumble::scene {

struct SizedScene {
  std::string name;
  std::string title;
  std::string counts;  // the meaning of n
  int default_n;
  std::string about;  // what to observe
};

/// All of them, in the order of listings.
const std::vector<SizedScene>& sized_scenes();

/// Nothing where no scene with a size has that name.
const SizedScene* sized_scene_named(const std::string& name);

/// @param name  of sized_scenes()
/// @param n     >= 1; the room grows with it
/// @throws UserError for an unknown name, or an n out of range
Scene make_sized_scene(const std::string& name, int n);

}  // namespace tumble::scene
