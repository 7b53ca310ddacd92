#include "framework/geometry/solid.h"

#include <algorithm>

#include <fmt/format.h>

#include "framework/core/error.h"
#include "framework/geometry/load_3ds.h"
#include "framework/geometry/mass_properties.h"

namespace tumble {
namespace {

// Spacing of float32 coordinates relative to the solid's size, with a factor 2 for a transform
// after rounding.
constexpr double kRounding = 0x1.0p-22;
// vertices against planes, about half a second; above it only every n-th plane is tested
constexpr double kMostTests = 2e8;

SolidModel solid_from_report(const ClosedReport& report, const std::string& where) {
  if (!report.is_closed()) {
    std::string problem, remedy;
    for (const Defect& defect : report.defects) {
      problem += (problem.empty() ? "" : "; ") + defect.problem;
      if (remedy.find(defect.remedy) == std::string::npos)
        remedy += (remedy.empty() ? "" : " ") + defect.remedy;
    }
    throw UserError(where, problem, remedy);
  }
  const MassProperties mass = compute_mass_properties(report.mesh);
  SolidModel model;
  model.solid = {report.mesh, is_convex(report.mesh)};
  for (Vector3d& vertex : model.solid.mesh_body.vertices) vertex -= mass.com_mesh;
  model.com_mesh = mass.com_mesh;
  model.volume = mass.volume;
  model.inertia_per_density_body = mass.inertia_com_mesh;
  model.notices = report.notices;
  return model;
}

const LoadedObject& pick_object(const LoadedFile& file, const std::string& object) {
  std::string names;
  for (const LoadedObject& one : file.objects) {
    if (one.name == object || (object.empty() && file.objects.size() == 1)) return one;
    names += (names.empty() ? "'" : ", '") + one.name + "'";
  }
  if (object.empty()) {
    throw UserError(file.where, fmt::format("holds {} objects: {}", file.objects.size(), names),
                    "Say which one is meant (\"object\").");
  }
  throw UserError(file.where, fmt::format("holds no object '{}'; it holds {}", object, names),
                  "Name one of these.");
}

}  // namespace

SolidModel solid_from_mesh(const TriangleMesh& mesh, const std::string& where) {
  return solid_from_report(check_closed(mesh), where);
}

SolidModel load_solid(const std::filesystem::path& path, const std::string& object,
                      double metres_per_unit) {
  const LoadedFile file = load_3ds(path, {metres_per_unit});
  const LoadedObject& chosen = pick_object(file, object);
  return solid_from_report(chosen.report, fmt::format("{}: object '{}'", file.where, chosen.name));
}

// A vertex may lie above a face's plane by as much as the rounding of the face's corners explains:
// `rounding` near the face, growing with distance / height of the face, because rounding tilts a
// narrow face more. A violation of convexity within this bound changes a gap by no more than the
// bound.
bool is_convex(const TriangleMesh& mesh) {
  require(!mesh.vertices.empty() && !mesh.faces.empty(), "is_convex: the mesh is empty");
  const Bounds bounds = bounds_of(mesh);
  const double size = (bounds.high - bounds.low).norm();
  const double rounding = kRounding * size;
  const double most_allowed = 1e-3 * size;
  const double tests =
      static_cast<double>(mesh.faces.size()) * static_cast<double>(mesh.vertices.size());
  const std::size_t stride =
      tests > kMostTests ? static_cast<std::size_t>(tests / kMostTests) + 1 : 1;
  for (std::size_t f = 0; f < mesh.faces.size(); f += stride) {
    const auto& [i, j, k] = mesh.faces[f];
    const Vector3d& a = mesh.vertices[i];
    const Vector3d u = mesh.vertices[j] - a, v = mesh.vertices[k] - a;
    const Vector3d area = u.cross(v);
    const double longest = std::max({u.norm(), v.norm(), (u - v).norm()});
    const double height = area.norm() / longest;
    if (!(height > rounding)) continue;  // a sliver has no reliable plane
    const Vector3d normal = area.normalized();
    for (const Vector3d& vertex : mesh.vertices) {
      const Vector3d to_vertex = vertex - a;
      const double above = normal.dot(to_vertex);
      if (above <= rounding) continue;
      if (above > std::min(most_allowed, rounding * (1.0 + 2.0 * to_vertex.norm() / height)))
        return false;
    }
  }
  return true;
}

}  // namespace tumble
