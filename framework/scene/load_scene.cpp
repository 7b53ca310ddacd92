#include "framework/scene/load_scene.h"

#include <cmath>
#include <fstream>
#include <numbers>
#include <sstream>

#include "framework/scene/check_scene.h"
#include "framework/scene/document.h"
#include "framework/scene/repeat.h"
#include "framework/scene/scene_schema.h"

namespace tumble::scene {
namespace {

using nlohmann::json;

Vector3d vector(const json& value) { return Vector3d(value.at(0).get<double>(), value.at(1).get<double>(), value.at(2).get<double>()); }

void read(const json& object, const char* key, Vector3d& target) {
  if (object.contains(key)) target = vector(object.at(key));
}
template <class T>
void read(const json& object, const char* key, T& target) {
  if (object.contains(key)) target = object.at(key).get<T>();
}
template <class T>
void read(const json& object, const char* key, std::optional<T>& target) {
  if (!object.contains(key)) return;
  T value;
  read(object, key, value);
  target = value;
}

/// "#rrggbb" is sRGB, as people pick it; linear light is what the renderer adds up.
/// Source: IEC 61966-2-1, the inverse of the transfer function.
Vector3d color(const json& value) {
  if (value.is_array()) return vector(value);
  const std::string text = value;
  Vector3d linear;
  for (int i = 0; i < 3; ++i) {
    const double c = std::stoi(text.substr(1 + 2 * static_cast<std::size_t>(i), 2), nullptr, 16) / 255.0;
    linear[i] = c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
  }
  return linear;
}

ShapeSpec shape(const json& value) {
  if (value.contains("sphere")) return SphereSpec{value.at("sphere").at("radius_m")};
  if (value.contains("box")) return BoxSpec{0.5 * vector(value.at("box").at("size_m"))};
  if (value.contains("plane")) {
    PlaneSpec plane;
    read(value.at("plane"), "drawn_half_extent_m", plane.drawn_half_extent_m);
    return plane;
  }
  const json& entry = value.at("model");
  ModelSpec model;
  model.file = entry.at("file");
  read(entry, "object", model.object);
  read(entry, "metres_per_unit", model.metres_per_unit);
  return model;
}

Quaterniond orientation(const json& value, const Document& document, const std::string& pointer) {
  if (value.contains("quaternion")) {
    const json& q = value.at("quaternion");
    const Quaterniond given(q.at(0).get<double>(), q.at(1).get<double>(), q.at(2).get<double>(), q.at(3).get<double>());
    // 0.1 %: rounding to three digits is repaired, anything more is a slip.
    if (std::abs(given.norm() - 1.0) > 1e-3)
      document.refuse(pointer + "/quaternion", "found " + show(q) + " of length " + std::to_string(given.norm()) + ", expected a unit quaternion [w, x, y, z]",
                      "Divide by its length, or give euler_deg or rotation_vector_rad.");
    return given.normalized();
  }
  using Axis = Eigen::AngleAxisd;
  if (value.contains("euler_deg")) {
    const Vector3d angles = vector(value.at("euler_deg")) * (std::numbers::pi / 180.0);
    return Axis(angles[0], Vector3d::UnitZ()) * Axis(angles[1], Vector3d::UnitY()) * Axis(angles[2], Vector3d::UnitX());
  }
  const Vector3d rotation = vector(value.at("rotation_vector_rad"));
  const double angle = rotation.norm();
  return angle == 0.0 ? Quaterniond::Identity() : Quaterniond(Axis(angle, rotation / angle));
}

Matrix3d inertia(const json& value) {
  if (value.at(0).is_number()) return vector(value).asDiagonal();
  Matrix3d matrix;
  for (int row = 0; row < 3; ++row) matrix.row(row) = vector(value.at(static_cast<std::size_t>(row))).transpose();
  return matrix;
}

BodySpec body(const json& value, const Document& document, const std::string& pointer) {
  BodySpec spec;
  spec.name = value.at("name");
  spec.shape = shape(value.at("shape"));
  read(value, "immovable", spec.immovable);
  read(value, "density_kg_m3", spec.density_kg_m3);
  read(value, "mass_kg", spec.mass_kg);
  if (value.contains("inertia_body_kg_m2")) spec.inertia_body_kg_m2 = inertia(value.at("inertia_body_kg_m2"));
  if (value.contains("motion")) {
    spec.motion.emplace();
    read(value.at("motion"), "velocity_m_s", spec.motion->velocity_m_s);
    read(value.at("motion"), "amplitude_m", spec.motion->amplitude_m);
    read(value.at("motion"), "angular_frequency_rad_s", spec.motion->angular_frequency_rad_s);
  }
  read(value, "position_m", spec.position_m);
  if (value.contains("orientation")) spec.world_from_body = orientation(value.at("orientation"), document, pointer + "/orientation");
  read(value, "velocity_m_s", spec.velocity_m_s);
  read(value, "angular_velocity_rad_s", spec.omega_world_rad_s);
  read(value, "restitution", spec.restitution);
  if (value.contains("color")) spec.color = color(value.at("color"));
  check_body(spec, [&](const std::string& key, const std::string& problem, const std::string& remedy) {
    document.refuse(value.contains(key.substr(0, key.find('/'))) ? pointer + '/' + key : pointer, "body '" + spec.name + "': " + problem, remedy);
  });
  return spec;
}

RepeatSpec repeat(const json& value, const Document& document, const std::string& pointer) {
  RepeatSpec spec;
  spec.body = body(value.at("body"), document, pointer + "/body");
  for (std::size_t i = 0; i < 3; ++i) spec.counts[i] = value.at("counts").at(i);
  spec.spacing_m = vector(value.at("spacing_m"));
  read(value, "jitter_m", spec.jitter_m);
  read(value, "speed_m_s", spec.speed_m_s);
  read(value, "directions", spec.directions);
  read(value, "seed", spec.seed);
  if (value.contains("colors"))
    for (const auto& entry : value.at("colors")) spec.colors.push_back(color(entry));
  if (!value.contains("seed") && (value.contains("jitter_m") || value.contains("speed_m_s")))
    document.refuse(pointer, "random positions or directions without a seed", "Add \"seed\": 1, or any other whole number, so that every run is the same.");
  if (1.0 * spec.counts[0] * spec.counts[1] * spec.counts[2] > 100000.0)
    document.refuse(pointer + "/counts", "found more than 100000 copies", "Ask for fewer.");
  return spec;
}

PointForceSpec point_force(const json& value) {
  PointForceSpec spec;
  spec.body = value.at("body");
  spec.force_n = vector(value.at("force_n"));
  spec.point_m = vector(value.at("point_m"));
  read(value, "start_s", spec.start_s);
  spec.duration_s = value.at("duration_s");
  return spec;
}

CheckSpec check(const json& value) {
  CheckSpec spec;
  spec.kind = value.at("kind");
  spec.tolerance = value.at("tolerance");
  spec.why = value.at("why");
  read(value, "unit", spec.unit);
  read(value, "body", spec.body);
  read(value, "other", spec.other);
  read(value, "axis", spec.axis);
  if (spec.axis && spec.axis->norm() > 0) spec.axis->normalize();   // check_scene refuses a zero axis
  read(value, "expected", spec.expected);
  read(value, "at_s", spec.at_s);
  return spec;
}

void read_view(const json& root, Scene& scene) {
  if (root.contains("camera")) {
    const json& entry = root.at("camera");
    read(entry, "eye_m", scene.camera.eye_m);
    read(entry, "target_m", scene.camera.target_m);
    read(entry, "field_of_view_deg", scene.camera.field_of_view_deg);
    read(entry, "follow", scene.camera.follow);
  }
  if (root.contains("grid")) {
    scene.grid_spacing_m = root.at("grid").at("spacing_m").get<double>();
    read(root.at("grid"), "height_m", scene.grid_height_m);
  }
}

/// FNV-1a, 64 bit: names a file's bytes in records; no defence against malice is needed here.
std::string digest(const std::string& bytes) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  for (const char c : bytes) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  std::ostringstream text;
  text << std::hex;
  text.width(16);
  text.fill('0');
  text << hash;
  return text.str();
}

}  // namespace

Scene parse_scene(const std::string& text, const std::filesystem::path& file) {
  const Document document = parse_document(text, file);
  check_against_schema(document, json::parse(kSceneSchema));
  const json& root = document.json;

  Scene scene;
  scene.name = file.stem().string();
  scene.file = file;
  scene.hash = digest(text);
  scene.title = root.at("title");
  read(root, "about", scene.about);
  read(root, "needs", scene.needs);
  scene.duration_s = root.at("duration_s");
  read(root, "step_s", scene.step_s);
  read(root, "rest_speed_m_s", scene.rest_speed_m_s);
  read(root, "gravity_m_s2", scene.gravity_m_s2);
  const json none = json::array();
  const auto entries = [&](const char* key) -> const json& { return root.contains(key) ? root.at(key) : none; };
  std::vector<std::string> pointers;   // of each body, for errors
  for (std::size_t i = 0; i < entries("bodies").size(); ++i) {
    pointers.push_back("/bodies/" + std::to_string(i));
    scene.bodies.push_back(body(entries("bodies").at(i), document, pointers.back()));
  }
  for (std::size_t i = 0; i < entries("repeat").size(); ++i) {
    const std::string pointer = "/repeat/" + std::to_string(i);
    for (auto& copy : write_out(repeat(entries("repeat").at(i), document, pointer))) {
      pointers.push_back(pointer + "/body");
      scene.bodies.push_back(std::move(copy));
    }
  }
  for (const auto& entry : entries("point_forces")) scene.point_forces.push_back(point_force(entry));
  read_view(root, scene);
  for (const auto& entry : entries("checks")) scene.checks.push_back(check(entry));

  check_scene(scene, pointers, [&](const std::string& pointer, const std::string& problem, const std::string& remedy) {
    document.refuse(pointer, problem, remedy);
  });
  return scene;
}

Scene load_scene(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream || std::filesystem::is_directory(file))
    throw UserError(file.string(), std::filesystem::exists(file) ? "this cannot be read as a file" : "there is no such scene file", "Scenes stand in assignments/*/scenes.");
  std::ostringstream text;
  text << stream.rdbuf();
  return parse_scene(text.str(), file);
}

}  // namespace tumble::scene
