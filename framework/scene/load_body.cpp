#include "framework/scene/load_body.h"

#include <cmath>
#include <numbers>

#include "framework/scene/check_scene.h"
#include "framework/scene/read_json.h"

namespace tumble::scene {
namespace {

using nlohmann::json;

ShapeSpec shape(const json& value) {
  if (value.contains("sphere")) return SphereSpec{value.at("sphere").at("radius_m")};
  if (value.contains("box")) return BoxSpec{0.5 * read_vector(value.at("box").at("size_m"))};
  if (value.contains("plane")) {
    PlaneSpec plane;
    read(value.at("plane"), "drawn_half_extent_m", plane.drawn_half_extent_m);
    return plane;
  }
  if (value.contains("ellipsoid")) {
    EllipsoidSpec ellipsoid{read_vector(value.at("ellipsoid").at("semi_axes_m"))};
    read(value.at("ellipsoid"), "center_m", ellipsoid.center_m);
    return ellipsoid;
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
    const Quaterniond given(q.at(0).get<double>(), q.at(1).get<double>(), q.at(2).get<double>(),
                            q.at(3).get<double>());
    // 0.1 %: the rounding to three digits is repaired; a larger deviation is a mistake.
    if (std::abs(given.norm() - 1.0) > 1e-3)
      document.refuse(pointer + "/quaternion",
                      "found " + show(q) + " of length " + std::to_string(given.norm()) +
                          ", expected a unit quaternion [w, x, y, z]",
                      "Divide by its length, or give euler_deg or rotation_vector_rad.");
    return given.normalized();
  }
  using Axis = Eigen::AngleAxisd;
  if (value.contains("euler_deg")) {
    const Vector3d angles = read_vector(value.at("euler_deg")) * (std::numbers::pi / 180.0);
    return Axis(angles[0], Vector3d::UnitZ()) * Axis(angles[1], Vector3d::UnitY()) *
           Axis(angles[2], Vector3d::UnitX());
  }
  const Vector3d rotation = read_vector(value.at("rotation_vector_rad"));
  const double angle = rotation.norm();
  return angle == 0.0 ? Quaterniond::Identity() : Quaterniond(Axis(angle, rotation / angle));
}

Matrix3d inertia(const json& value) {
  if (value.at(0).is_number()) return read_vector(value).asDiagonal();
  Matrix3d matrix;
  for (int row = 0; row < 3; ++row)
    matrix.row(row) = read_vector(value.at(static_cast<std::size_t>(row))).transpose();
  return matrix;
}

}  // namespace

/// "#rrggbb" is sRGB, as in colour pickers; the renderer computes with linear light.
/// Source: IEC 61966-2-1, the inverse of the transfer function.
Vector3d read_color(const json& value) {
  if (value.is_array()) return read_vector(value);
  const std::string text = value;
  Vector3d linear;
  for (int i = 0; i < 3; ++i) {
    const double c =
        std::stoi(text.substr(1 + 2 * static_cast<std::size_t>(i), 2), nullptr, 16) / 255.0;
    linear[i] = c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
  }
  return linear;
}

BodySpec read_body(const json& value, const Document& document, const std::string& pointer) {
  BodySpec spec;
  spec.pointer = pointer;
  spec.name = value.at("name");
  spec.shape = shape(value.at("shape"));
  read(value, "immovable", spec.immovable);
  read(value, "density_kg_m3", spec.density_kg_m3);
  read(value, "mass_kg", spec.mass_kg);
  if (value.contains("inertia_body_kg_m2"))
    spec.inertia_body_kg_m2 = inertia(value.at("inertia_body_kg_m2"));
  if (value.contains("motion")) {
    spec.motion.emplace();
    read(value.at("motion"), "velocity_m_s", spec.motion->velocity_m_s);
    read(value.at("motion"), "amplitude_m", spec.motion->amplitude_m);
    read(value.at("motion"), "angular_frequency_rad_s", spec.motion->angular_frequency_rad_s);
  }
  read(value, "position_m", spec.position_m);
  if (value.contains("orientation"))
    spec.world_from_body = orientation(value.at("orientation"), document, pointer + "/orientation");
  read(value, "velocity_m_s", spec.velocity_m_s);
  read(value, "angular_velocity_rad_s", spec.omega_world_rad_s);
  read(value, "restitution", spec.restitution);
  read(value, "friction", spec.friction);
  read(value, "collides", spec.collides);
  if (value.contains("color")) spec.color = read_color(value.at("color"));
  spec.drawn_as_die = value.contains("drawn_as");  // the one word that the schema allows
  check_body(spec, [&](const std::string& key, const std::string& problem,
                       const std::string& remedy) {
    document.refuse(value.contains(key.substr(0, key.find('/'))) ? pointer + '/' + key : pointer,
                    "body '" + spec.name + "': " + problem, remedy);
  });
  return spec;
}

RepeatSpec read_repeat(const json& value, const Document& document, const std::string& pointer) {
  RepeatSpec spec;
  spec.body = read_body(value.at("body"), document, pointer + "/body");
  for (std::size_t i = 0; i < 3; ++i) spec.counts[i] = value.at("counts").at(i);
  spec.spacing_m = read_vector(value.at("spacing_m"));
  read(value, "jitter_m", spec.jitter_m);
  read(value, "speed_m_s", spec.speed_m_s);
  read(value, "directions", spec.directions);
  read(value, "seed", spec.seed);
  if (value.contains("colors"))
    for (const auto& entry : value.at("colors")) spec.colors.push_back(read_color(entry));
  if (!value.contains("seed") && (value.contains("jitter_m") || value.contains("speed_m_s")))
    document.refuse(pointer, "random positions or directions without a seed",
                    "Add \"seed\": 1, or any other whole number, so that every run is the same.");
  if (1.0 * spec.counts[0] * spec.counts[1] * spec.counts[2] > 100000.0)
    document.refuse(pointer + "/counts", "found more than 100000 copies", "Ask for fewer.");
  return spec;
}

}  // namespace tumble::scene
