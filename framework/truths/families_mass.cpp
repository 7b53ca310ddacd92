// mass_properties: volume, centre of mass and inertia of closed meshes.
#include "framework/core/error.h"
#include "framework/truths/families.h"
#include "framework/geometry/mass_properties.h"

namespace tumble::truths {
namespace {

TriangleMesh mesh_of(const Case& truth) {
  TriangleMesh mesh;
  for (const Value& vertex : truth.input("vertices").list())
    mesh.vertices.push_back(vertex.vector3());
  const int count = static_cast<int>(mesh.vertices.size());
  for (const Value& face : truth.input("faces").list()) {
    for (std::size_t i = 0; i < 3; ++i) {
      if (const int corner = face.at(i).integer(); corner < 0 || corner >= count)
        throw UserError(
            face.at(i).place(),
            "there is no vertex " + std::to_string(corner) + " among " + std::to_string(count),
            "Correct the face.");
    }
    mesh.faces.push_back({face.at(0).integer(), face.at(1).integer(), face.at(2).integer()});
  }
  return mesh;
}

/// Moments about the origin from those about the centre of mass (Steiner):  I_o = I_c + m (c.c 1 -
/// c c').
Matrix3d about_origin(const MassProperties& found) {
  const Vector3d& c = found.com_mesh;
  return found.inertia_com_mesh +
         found.mass * (c.squaredNorm() * Matrix3d::Identity() - c * c.transpose());
}

}  // namespace

void compare_mass_properties(const Case& truth, const Laws&, Comparison& comparison) {
  const MassProperties found =
      compute_mass_properties(mesh_of(truth), truth.input("density").number());
  const auto matrix = [&](const std::string& output, const Matrix3d& m) {
    comparison.closed_form(output, (m - truth.output(output).matrix3()).cwiseAbs().maxCoeff(),
                           truth.floor(output));
  };
  comparison.closed_form(truth, "volume", found.volume);
  comparison.closed_form(truth, "mass", found.mass);
  comparison.closed_form(truth, "com", VectorXd(found.com_mesh));
  matrix("inertia_about_origin", about_origin(found));
  matrix("inertia_about_com", found.inertia_com_mesh);
  comparison.closed_form(truth, "principal_moments_com", VectorXd(found.principal_moments));
  if (truth.has_output("naive_binary64_errors"))
    comparison.not_compared("naive_binary64_errors",
                            "errors of a textbook sum about the world's origin, for information");
}

}  // namespace tumble::truths
