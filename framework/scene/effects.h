/// The effects that a scene calls for, and the entries of its file that call for each. An effect
/// that is off has no code in a run.
#pragma once

#include <string>
#include <vector>

#include "framework/scene/words.h"

namespace tumble::scene {

/// An effect in a scene.
struct EffectUse {
  std::string name;           // "gravity", "spring", ...
  std::string stage;          // the part of a run with its code: "integration", "constraints", ...
  std::string counter;        // the counter of its calls in a run
  std::vector<Asker> askers;  // in the file's order; empty: the effect is off
  std::string
      note;  // why it is off although an entry seems to call for it, what to know of it, or ""

  bool is_on() const { return !askers.empty(); }
};

/// All effects of the framework, on or off, always in the same order.
std::vector<EffectUse> effects_of(const Scene& scene);

}  // namespace tumble::scene
