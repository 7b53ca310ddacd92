/// Bodies by name and points of them, while a scene is read. For the .cpp files of this folder
/// only.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "framework/geometry/triangle_mesh.h"
#include "framework/scene/document.h"
#include "framework/scene/scene.h"

namespace tumble::scene {

/// At most the first eight names of a list, for errors.
std::string listed(const std::vector<std::string>& names);

class Anchors {
 public:
  /// Both must outlive it. Bodies may still be added to the scene: a query sees those that exist at
  /// its time.
  Anchors(const Document& document, const Scene& scene) : document_(document), scene_(scene) {}

  /// @throws UserError at `pointer` when no body has that name
  const BodySpec& expect_body(const std::string& name, const std::string& pointer);

  /// @param value  an entry of the schema's kind "anchor"
  /// @throws UserError when it names no body, two points at once, or a missing vertex
  AnchorSpec read_anchor(const nlohmann::json& value, const std::string& pointer);

  /// Position of an anchor at the start. World frame [m].
  Vector3d place_at_start(const AnchorSpec& anchor);

 private:
  // body frame
  const std::vector<Vector3d>& vertices_of(const BodySpec& body, const std::string& pointer);
  Vector3d vertex(const nlohmann::json& value, const BodySpec& body, const std::string& pointer);

  const Document& document_;
  const Scene& scene_;
  std::map<std::string, std::size_t> index_;
  std::size_t indexed_ = 0;
  std::map<std::string, std::vector<Vector3d>> vertices_;  // by the definition of the shape
};

}  // namespace tumble::scene
