/// What an Entry reads from. For the .cpp files of this folder only.
#pragma once

#include "framework/scene/anchors.h"
#include "framework/scene/entry.h"

namespace tumble::scene {

struct EntrySource {
  const nlohmann::json& value;
  const Document& document;
  Anchors& anchors;
};

}  // namespace tumble::scene
