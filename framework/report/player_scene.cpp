#include "framework/report/player_scene.h"

#include <cmath>
#include <deque>
#include <map>

#include "framework/effects/registry.h"
#include "framework/scene/die.h"

namespace tumble::report {
namespace {

using Json = nlohmann::ordered_json;

Json triple(const Vector3d& v) { return Json::array({v.x(), v.y(), v.z()}); }

/// Collects meshes; one that is used twice is stored once.
class Meshes {
 public:
  /// For a shape that the page draws by its triangles.
  std::size_t index_of_surface(const Shape& shape) {
    return index_of(made_.emplace_back(surface_of(shape)));
  }
  std::size_t index_of(const TriangleMesh& mesh) {
    for (std::size_t i = 0; i < meshes_.size(); ++i)
      if (meshes_[i]->vertices == mesh.vertices && meshes_[i]->faces == mesh.faces) return i;
    meshes_.push_back(&mesh);
    return meshes_.size() - 1;
  }
  Json json() const {
    Json all = Json::array();
    for (const TriangleMesh* mesh : meshes_) {
      Json vertices = Json::array(), faces = Json::array();
      for (const Vector3d& vertex : mesh->vertices)
        for (int i = 0; i < 3; ++i) vertices.push_back(static_cast<float>(vertex[i]));
      for (const Face& face : mesh->faces)
        for (const int corner : face) faces.push_back(corner);
      all.push_back({{"vertices", std::move(vertices)}, {"faces", std::move(faces)}});
    }
    return all;
  }

 private:
  std::vector<const TriangleMesh*> meshes_;
  std::deque<TriangleMesh> made_;
};

/// A die's pips are given as the box itself is drawn: in half edges.
Json box_json(const Box& box, bool is_die) {
  Json entry{{"kind", "box"}, {"half", triple(box.half_extents_body)}};
  if (!is_die) return entry;
  entry["pips"] = Json::array();
  for (const scene::Pip& pip : scene::pips_of_die(box.half_extents_body))
    entry["pips"].push_back(
        {{"point", triple(pip.point_body.cwiseQuotient(box.half_extents_body))},
         {"normal", triple(pip.normal_body)},
         {"radii", triple(Vector3d::Constant(pip.radius_m).cwiseQuotient(box.half_extents_body))}});
  return entry;
}

Json shape_json(const Shape& shape, const scene::BodySpec& spec, Meshes& meshes) {
  if (const auto* sphere = std::get_if<Sphere>(&shape))
    return {{"kind", "sphere"}, {"radius", sphere->radius}};
  if (const auto* box = std::get_if<Box>(&shape)) return box_json(*box, spec.drawn_as_die);
  if (const auto* solid = std::get_if<MeshSolid>(&shape))
    return {{"kind", "mesh"}, {"mesh", meshes.index_of(solid->mesh_body)}};
  if (std::holds_alternative<Ellipsoid>(shape))
    return {{"kind", "mesh"}, {"mesh", meshes.index_of_surface(shape)}};
  const auto* plane = std::get_if<scene::PlaneSpec>(&spec.shape);
  return {{"kind", "plane"}, {"extent", plane != nullptr ? plane->drawn_half_extent_m : 5.0}};
}

/// Anchors by body index, -1 for the world.
class Anchors {
 public:
  Anchors(const scene::Scene& scene, const Frame& first)
      : first_(first), origin_world_(page_origin(scene)) {
    for (std::size_t i = 0; i < scene.bodies.size(); ++i)
      index_[scene.bodies[i].name] = static_cast<int>(i);
  }
  int body(const std::string& name) const { return name.empty() ? -1 : index_.at(name); }
  Json of(const effects::DrawnPoint& point) const {
    const int index = body(point.body);
    return {{"body", index}, {"point", triple(index < 0 ? seen(point.point) : point.point)}};
  }
  /// A point in world coordinates at the start.
  Json fixed(const std::string& name, const Vector3d& point_world) const {
    const int index = body(name);
    if (index < 0) return {{"body", -1}, {"point", triple(seen(point_world))}};
    const BodyPose& pose = first_.poses[static_cast<std::size_t>(index)];
    return {{"body", index},
            {"point", triple(pose.world_from_body.conjugate() * (point_world - pose.com_world))}};
  }
  /// A point of the world, from the page's origin.
  Vector3d seen(const Vector3d& point_world) const { return point_world - origin_world_; }

 private:
  const Frame& first_;
  Vector3d origin_world_;
  std::map<std::string, int> index_;
};

void add_links(const scene::Scene& scene, const Anchors& anchors, Json& page) {
  page["springs"] = page["rods"] = page["joints"] = page["forces"] = page["sheets"] = Json::array();
  const effects::Drawables drawn = effects::drawn(scene);
  for (const effects::DrawnCoil& coil : drawn.coils)
    page["springs"].push_back({{"name", coil.name},
                               {"a", anchors.of(coil.a)},
                               {"b", anchors.of(coil.b)},
                               {"rest", coil.rest_length}});
  for (const effects::DrawnBar& bar : drawn.bars)
    page["rods"].push_back(
        {{"name", bar.name}, {"a", anchors.of(bar.a)}, {"b", anchors.of(bar.b)}});
  for (const effects::DrawnPivot& pivot : drawn.pivots) {
    using Kind = effects::DrawnPivot::Kind;
    const bool is_pin = pivot.kind == Kind::kPin;
    // In a joint with the world, body_a is the moving body.
    Json entry{{"name", pivot.name},
               {"kind", is_pin                      ? "hinge"
                        : pivot.kind == Kind::kBall ? "ball"
                                                    : "weld"}};
    entry["a"] = anchors.fixed(pivot.body_a, pivot.point_world);
    if (is_pin)
      entry["b"] = anchors.fixed(pivot.body_a, pivot.point_world + pivot.axis_world.normalized());
    page["joints"].push_back(std::move(entry));
  }
  for (const effects::DrawnArrow& force : drawn.arrows)
    page["forces"].push_back({{"body", anchors.body(force.body)},
                              {"force", triple(force.force_world)},
                              {"point", triple(anchors.seen(force.point_world))},
                              {"start", force.start_s},
                              {"duration", force.duration_s}});
  for (const effects::DrawnSheet& sheet : drawn.sheets)
    page["sheets"].push_back(
        {{"height", anchors.seen({0, 0, sheet.height_m}).z()}, {"color", triple(sheet.color)}});
}

}  // namespace

Vector3d page_origin(const scene::Scene& scene) {
  // Of the sight: this far away single precision is 6e-5 of the sight, a twentieth of a pixel.
  constexpr double kUsualReach = 1e3;
  const Vector3d& seen = scene.camera.target_m;
  const double sight_m = (scene.camera.eye_m - seen).norm();
  if (!seen.allFinite() || seen.norm() <= kUsualReach * sight_m) return Vector3d::Zero();
  const double step = scene.grid_spacing_m.value_or(sight_m);
  return step * (seen / step).array().round().matrix();
}

std::vector<double> radii_of(const std::vector<Shape>& shapes) {
  std::vector<double> radii;
  for (const Shape& shape : shapes) radii.push_back(bounding_radius(shape));
  return radii;
}

Json player_scene(const scene::Scene& scene, const std::vector<Shape>& shapes, const Frame& first) {
  const Anchors anchors(scene, first);
  Json page;
  page["scene"] = scene.name;
  page["title"] = scene.title.empty() ? scene.name : scene.title;
  page["about"] = scene.about;
  page["origin"] = triple(page_origin(scene));
  page["camera"] = {{"eye", triple(anchors.seen(scene.camera.eye_m))},
                    {"target", triple(anchors.seen(scene.camera.target_m))},
                    {"fov", scene.camera.field_of_view_deg},
                    {"follow", scene.camera.follow ? anchors.body(*scene.camera.follow) : -1}};
  page["grid"] = {{"spacing", scene.grid_spacing_m ? Json(*scene.grid_spacing_m) : Json()},
                  {"height", anchors.seen({0, 0, scene.grid_height_m}).z()}};
  Meshes meshes;
  page["bodies"] = Json::array();
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const scene::BodySpec& spec = scene.bodies[i];
    const double radius = bounding_radius(shapes[i]);
    Json body{{"name", spec.name},
              {"immovable", spec.immovable},
              {"shape", shape_json(shapes[i], spec, meshes)},
              {"radius", std::isfinite(radius) ? Json(radius) : Json()}};
    if (spec.color) body["color"] = triple(*spec.color);
    page["bodies"].push_back(std::move(body));
  }
  page["meshes"] = meshes.json();
  add_links(scene, anchors, page);
  return page;
}

}  // namespace tumble::report
