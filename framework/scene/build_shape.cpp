#include "framework/scene/build_shape.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <numbers>
#include <set>
#include <tuple>

#include "framework/core/error.h"
#include "framework/core/nearest_word.h"
#include "framework/geometry/solid.h"

namespace tumble::scene {
namespace {

// m: of a point mass; without effect, see build_shape.h
constexpr double kPointGyrationRadius = 1.0;

/// Surface, volume, and moments of inertia at unit mass (about the centre of mass, body axes)
/// [m^2].
struct UnitSolid {
  Shape shape = HalfSpace{};
  double volume_m3 = kUnset;
  Matrix3d inertia_per_mass = Matrix3d::Constant(kUnset);
};

UnitSolid sphere(double r) {
  // I = 2/5 m r^2
  const double gyration_squared = r > 0 ? 0.4 * r * r : kPointGyrationRadius * kPointGyrationRadius;
  return {Sphere{r}, 4.0 / 3.0 * std::numbers::pi * r * r * r,
          gyration_squared * Matrix3d::Identity()};
}

UnitSolid box(const Vector3d& h) {
  // I_xx = m (h_y^2 + h_z^2) / 3 with half extents h, and cyclically
  const Vector3d s = h.cwiseProduct(h);
  const Vector3d moments = Vector3d(s.y() + s.z(), s.z() + s.x(), s.x() + s.y()) / 3.0;
  return {Box{h}, 8.0 * h.prod(), moments.asDiagonal()};
}

UnitSolid ellipsoid(const EllipsoidSpec& spec) {
  // I_xx = m (b^2 + c^2) / 5 with semi-axes a, b, c, and cyclically; about its centre
  const Vector3d s = spec.semi_axes_m.cwiseProduct(spec.semi_axes_m);
  const Vector3d moments = Vector3d(s.y() + s.z(), s.z() + s.x(), s.x() + s.y()) / 5.0;
  return {Ellipsoid{spec.semi_axes_m, spec.center_m},
          4.0 / 3.0 * std::numbers::pi * spec.semi_axes_m.prod(), moments.asDiagonal()};
}

std::filesystem::path find_root(const std::filesystem::path& scene_file) {
  if (const char* told = std::getenv("TUMBLE_ROOT")) return told;
  const auto start = scene_file.empty() ? std::filesystem::current_path()
                                        : std::filesystem::absolute(scene_file).parent_path();
  for (auto folder = start; folder != folder.root_path(); folder = folder.parent_path()) {
    if (std::filesystem::is_directory(folder / "models")) return folder;
  }
  return std::filesystem::current_path();
}

std::filesystem::path find_model(const std::string& file, const std::filesystem::path& scene_file,
                                 const std::filesystem::path& root) {
  const auto beside = scene_file.parent_path() / file;
  if (std::filesystem::exists(beside)) return beside;
  return (root.empty() ? find_root(scene_file) : root) / "models" / file;
}

std::vector<std::string> models_in(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  if (std::filesystem::is_directory(folder))
    for (const auto& entry : std::filesystem::directory_iterator(folder))
      if (entry.path().extension() == ".3ds") names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  return names;
}

/// The models of a scene, each read once.
class Models {
 public:
  Models(const std::filesystem::path& scene_file, const std::filesystem::path& root)
      : scene_file_(scene_file), root_(root) {}

  const UnitSolid& get(const ModelSpec& spec, const std::string& body) {
    const Key key{spec.file, spec.object, spec.metres_per_unit};
    const auto known = read_.find(key);
    return known != read_.end() ? known->second
                                : read_.emplace(key, read(spec, body)).first->second;
  }

 private:
  using Key = std::tuple<std::string, std::string, double>;

  UnitSolid read(const ModelSpec& spec, const std::string& body) const {
    const std::filesystem::path file = find_model(spec.file, scene_file_, root_);
    if (!std::filesystem::exists(file))
      throw UserError(
          "body '" + body + "': " + spec.file,
          "no such file." + did_you_mean(spec.file, models_in(file.parent_path())),
          "It is searched beside the scene, then in " + file.parent_path().string() + ".");
    try {
      SolidModel model = load_solid(file, spec.object, spec.metres_per_unit);
      return {std::move(model.solid), model.volume, model.inertia_per_density_body / model.volume};
    } catch (const UserError& error) {
      throw UserError("body '" + body + "': " + error.where(), error.problem(), error.remedy());
    }
  }

  std::filesystem::path scene_file_, root_;
  std::map<Key, UnitSolid> read_;
};

UnitSolid unit_solid(const BodySpec& body, Models& models) {
  if (const auto* spec = std::get_if<SphereSpec>(&body.shape)) return sphere(spec->radius_m);
  if (const auto* spec = std::get_if<BoxSpec>(&body.shape)) return box(spec->half_extents_m);
  if (const auto* spec = std::get_if<EllipsoidSpec>(&body.shape)) return ellipsoid(*spec);
  if (const auto* spec = std::get_if<ModelSpec>(&body.shape)) return models.get(*spec, body.name);
  return {};  // a half-space has neither volume nor inertia
}

Solid with_mass(const BodySpec& body, const UnitSolid& unit) {
  Solid solid;
  solid.shape = unit.shape;
  if (body.immovable) return solid;
  solid.mass_kg = body.mass_kg ? *body.mass_kg : *body.density_kg_m3 * unit.volume_m3;
  solid.inertia_body_kg_m2 = body.inertia_body_kg_m2
                                 ? *body.inertia_body_kg_m2
                                 : Matrix3d(solid.mass_kg * unit.inertia_per_mass);
  return solid;
}

}  // namespace

Solid build_solid(const BodySpec& body, const std::filesystem::path& scene_file,
                  const std::filesystem::path& root) {
  Models models(scene_file, root);
  return with_mass(body, unit_solid(body, models));
}

std::vector<std::filesystem::path> model_files(const Scene& scene,
                                               const std::filesystem::path& root) {
  std::set<std::filesystem::path> files;
  for (const BodySpec& body : scene.bodies)
    if (const auto* spec = std::get_if<ModelSpec>(&body.shape))
      files.insert(find_model(spec->file, scene.file, root));
  return {files.begin(), files.end()};
}

std::vector<Solid> build_solids(const Scene& scene, const std::filesystem::path& root) {
  Models models(scene.file, root);
  std::vector<Solid> solids;
  for (const auto& body : scene.bodies) {
    try {
      solids.push_back(with_mass(body, unit_solid(body, models)));
    } catch (const UserError& error) {
      throw UserError(place_of(scene, body.pointer + "/shape/model") + ": " + error.where(),
                      error.problem(), error.remedy());
    }
  }
  return solids;
}

}  // namespace tumble::scene
