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

/// As a file says it.
inline nlohmann::json json_of(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }
inline nlohmann::json json_of(const AnchorSpec& anchor) {
  if (anchor.body.empty()) return {{"point_world_m", json_of(anchor.point_m)}};
  return {{"body", anchor.body}, {"point_body_m", json_of(anchor.point_m)}};
}

}  // namespace tumble::scene
