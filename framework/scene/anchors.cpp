#include "framework/scene/anchors.h"

#include <algorithm>

#include "framework/scene/build_shape.h"
#include "framework/scene/read_json.h"

namespace tumble::scene {

using nlohmann::json;

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < std::min<std::size_t>(names.size(), 8); ++i)
    text += (i > 0 ? ", " : "") + names[i];
  return text + (names.size() > 8 ? ", ..." : "");
}

const BodySpec& Anchors::expect_body(const std::string& name, const std::string& pointer) {
  for (; indexed_ < scene_.bodies.size(); ++indexed_)
    index_.emplace(scene_.bodies[indexed_].name, indexed_);
  const auto found = index_.find(name);
  if (found != index_.end()) return scene_.bodies[found->second];
  std::vector<std::string> names;
  for (const BodySpec& body : scene_.bodies) names.push_back(body.name);
  document_.refuse(pointer, "no body is named '" + name + "'." + did_you_mean(name, names),
                   "Bodies: " + listed(names) + ".");
}

const std::vector<Vector3d>& Anchors::vertices_of(const BodySpec& body,
                                                  const std::string& pointer) {
  std::string key = body.name;  // bodies with one model share its vertices
  if (const auto* model = std::get_if<ModelSpec>(&body.shape))
    key = "\n" + model->file + "\n" + model->object + "\n" + std::to_string(model->metres_per_unit);
  const auto known = vertices_.find(key);
  if (known != vertices_.end()) return known->second;
  if (std::holds_alternative<SphereSpec>(body.shape) ||
      std::holds_alternative<PlaneSpec>(body.shape) ||
      std::holds_alternative<EllipsoidSpec>(body.shape))
    document_.refuse(pointer, "body '" + body.name + "' has no vertices",
                     "Only models and boxes have vertices: give point_body_m or point_world_m.");
  try {
    return vertices_.emplace(key, surface_of(build_solid(body, scene_.file).shape).vertices)
        .first->second;
  } catch (const UserError& error) {
    document_.refuse(pointer, error.where() + ": " + error.problem(), error.remedy());
  }
}

Vector3d Anchors::vertex(const json& value, const BodySpec& body, const std::string& pointer) {
  const bool by_number = value.contains("vertex");
  const std::string at = pointer + (by_number ? "/vertex" : "/vertex_towards");
  const std::vector<Vector3d>& vertices = vertices_of(body, at);
  if (by_number) {
    const auto number = value.at("vertex").get<std::size_t>();
    if (number < vertices.size()) return vertices[number];
    document_.refuse(at,
                     "found " + std::to_string(number) + ", but body '" + body.name + "' has " +
                         std::to_string(vertices.size()) + " vertices",
                     "Give a number from 0 to " + std::to_string(vertices.size() - 1) + ".");
  }
  const Vector3d direction = read_vector(value.at("vertex_towards"));
  if (direction.isZero(0.0)) document_.refuse(at, "found the zero vector, expected a direction");
  // The first of the farthest vertices.
  return *std::max_element(
      vertices.begin(), vertices.end(),
      [&](const Vector3d& a, const Vector3d& b) { return a.dot(direction) < b.dot(direction); });
}

AnchorSpec Anchors::read_anchor(const json& value, const std::string& pointer) {
  static const std::vector<std::string> ways = {"point_body_m", "point_world_m", "vertex",
                                                "vertex_towards"};
  std::vector<std::string> given;
  for (const auto& way : ways)
    if (value.contains(way)) given.push_back(way);
  if (given.size() > 1)
    document_.refuse(pointer, "the point is given twice, by " + given[0] + " and by " + given[1],
                     "Keep one of the two.");

  AnchorSpec anchor;
  if (!value.contains("body")) {
    if (given[0] != "point_world_m")
      document_.refuse(pointer, given[0] + " is about a body, and none is named",
                       "Add \"body\", or give point_world_m.");
    anchor.point_m = read_vector(value.at("point_world_m"));
    return anchor;
  }
  anchor.body = value.at("body");
  const BodySpec& body = expect_body(anchor.body, pointer + "/body");
  if (given.empty()) return anchor;  // the centre of mass
  if (given[0] == "point_body_m")
    anchor.point_m = read_vector(value.at("point_body_m"));
  else if (given[0] == "point_world_m")
    anchor.point_m = body.world_from_body.conjugate() *
                     (read_vector(value.at("point_world_m")) - body.position_m);
  else
    anchor.point_m = vertex(value, body, pointer);
  return anchor;
}

Vector3d Anchors::place_at_start(const AnchorSpec& anchor) {
  if (anchor.body.empty()) return anchor.point_m;
  const BodySpec& body = expect_body(anchor.body, "");
  return body.position_m + body.world_from_body * anchor.point_m;
}

}  // namespace tumble::scene
