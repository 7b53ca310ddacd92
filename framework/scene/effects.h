/// Which effects a scene calls for, and which entry of its file asked for each. An effect that is off has no code in a run.
#pragma once

#include <string>
#include <vector>

#include "framework/scene/words.h"

namespace tumble::scene {

/// An effect as a scene asks for it.
struct EffectUse {
  std::string name;           // "gravity", "spring", ...
  std::string stage;          // the part of a run that its code stands in: "integration", "constraints", ...
  std::string counter;        // the count of a run that tells how often it was asked
  std::vector<Asker> askers;  // in the file's order; empty: the effect is off
  std::string note;           // why it is off although something in the file seems to ask for it, or ""

  bool is_on() const { return !askers.empty(); }
};

/// All effects that the framework knows, on or off, always in the same order.
std::vector<EffectUse> effects_of(const Scene& scene);

}  // namespace tumble::scene
