#include "framework/scene/build_shape.h"

#include <cmath>
#include <numbers>

#include "framework/core/error.h"

namespace tumble::scene {
namespace {

constexpr double kPointGyrationRadius = 1.0;   // m: of a point mass; of no consequence, see build_shape.h

/// Surface, volume, and moments of inertia at unit mass (about the centre of mass, body axes) [m^2].
struct UnitSolid {
  Shape shape = HalfSpace{};
  double volume_m3 = kUnset;
  Matrix3d inertia_per_mass = Matrix3d::Constant(kUnset);
};

UnitSolid sphere(double r) {
  // I = 2/5 m r^2
  const double gyration_squared = r > 0 ? 0.4 * r * r : kPointGyrationRadius * kPointGyrationRadius;
  return {Sphere{r}, 4.0 / 3.0 * std::numbers::pi * r * r * r, gyration_squared * Matrix3d::Identity()};
}

UnitSolid box(const Vector3d& h) {
  // I_xx = m (h_y^2 + h_z^2) / 3 with half extents h, and so on round
  const Vector3d s = h.cwiseProduct(h);
  const Vector3d moments = Vector3d(s.y() + s.z(), s.z() + s.x(), s.x() + s.y()) / 3.0;
  return {Box{h}, 8.0 * h.prod(), moments.asDiagonal()};
}

UnitSolid unit_solid(const BodySpec& body, const std::filesystem::path& scene_file, const std::filesystem::path& root) {
  (void)scene_file;
  (void)root;
  if (const auto* spec = std::get_if<SphereSpec>(&body.shape)) return sphere(spec->radius_m);
  if (const auto* spec = std::get_if<BoxSpec>(&body.shape)) return box(spec->half_extents_m);
  if (std::holds_alternative<PlaneSpec>(body.shape)) return {};
  throw UserError("body '" + body.name + "'", "models cannot be loaded yet");
}

Solid with_mass(const BodySpec& body, const UnitSolid& unit) {
  Solid solid;
  solid.shape = unit.shape;
  if (body.immovable) return solid;
  solid.mass_kg = body.mass_kg ? *body.mass_kg : *body.density_kg_m3 * unit.volume_m3;
  solid.inertia_body_kg_m2 = body.inertia_body_kg_m2 ? *body.inertia_body_kg_m2 : Matrix3d(solid.mass_kg * unit.inertia_per_mass);
  return solid;
}

}  // namespace

Solid build_solid(const BodySpec& body, const std::filesystem::path& scene_file, const std::filesystem::path& root) {
  return with_mass(body, unit_solid(body, scene_file, root));
}

std::vector<Solid> build_solids(const Scene& scene, const std::filesystem::path& root) {
  std::vector<Solid> solids;
  for (const auto& body : scene.bodies) solids.push_back(build_solid(body, scene.file, root));
  return solids;
}

}  // namespace tumble::scene
