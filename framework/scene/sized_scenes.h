/// Scenes whose number of bodies is a parameter, at kept density: what engines are compared on.
///
/// They are made here instead of standing in files because a file holds one size. In every other way they are scenes: each has a name, a
/// default size, a camera, checks, and the same bytes for the same size.
#pragma once

#include <string>
#include <vector>

#include "framework/scene/scene.h"

namespace tumble::scene {

struct SizedScene {
  std::string name;
  std::string title;
  std::string counts;      // what n counts
  int default_n;
  std::string about;       // what a viewer should notice
};

/// All of them, in the order in which they are listed.
const std::vector<SizedScene>& sized_scenes();

/// Nothing where no scene with a size has that name.
const SizedScene* sized_scene_named(const std::string& name);

/// @param name  of sized_scenes()
/// @param n     >= 1; the room grows with it
/// @throws UserError for a name that is none of them, or an n that is out of range
Scene make_sized_scene(const std::string& name, int n);

}  // namespace tumble::scene
