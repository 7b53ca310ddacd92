#include "framework/geometry/mass_properties.h"

#include <cmath>

#include "framework/core/decompositions.h"
#include "framework/core/error.h"

namespace tumble {
namespace {

// Integrals over the solid, with the origin at `centre`.
struct Moments {
  double volume = 0.0;                 // int 1
  Vector3d first = Vector3d::Zero();   // int x
  Matrix3d second = Matrix3d::Zero();  // int x x'
};

// Moves the origin by `shift`, an exact or nearly exact difference, and then by `fine`, a small
// one: with their sum, a solid far from the origin would be rounded to the spacing of its
// coordinates.
Moments integrate(const TriangleMesh& mesh, const Vector3d& shift, const Vector3d& fine) {
  Moments sum;
  for (const auto& [i, j, k] : mesh.faces) {
    const Vector3d a = (mesh.vertices[i] - shift) - fine;
    const Vector3d b = (mesh.vertices[j] - shift) - fine;
    const Vector3d c = (mesh.vertices[k] - shift) - fine;
    const double d = a.dot((b - a).cross(c - a));
    const Vector3d s = a + b + c;
    sum.volume += d;
    sum.first += d * s;
    sum.second +=
        d * (a * a.transpose() + b * b.transpose() + c * c.transpose() + s * s.transpose());
  }
  sum.volume /= 6.0;
  sum.first /= 24.0;
  sum.second /= 120.0;
  return sum;
}

void make_positive(Eigen::Ref<Vector3d> axis) {
  Eigen::Index largest = 0;
  axis.cwiseAbs().maxCoeff(&largest);
  if (axis[largest] < 0.0) axis = -axis;
}

void find_principal(MassProperties& found) {
  const SymmetricEigen3 eigen = symmetric_eigen(found.inertia_com_mesh);
  require(eigen.values.allFinite(), "compute_mass_properties: the principal axes did not converge");
  found.principal_moments = eigen.values;
  Matrix3d axes = eigen.vectors;
  make_positive(axes.col(0));
  make_positive(axes.col(1));
  axes.col(2) = axes.col(0).cross(axes.col(1));
  found.mesh_from_principal = axes;
}

Vector3d middle_of(const TriangleMesh& mesh) {
  if (mesh.vertices.empty()) return Vector3d::Zero();
  const Bounds bounds = bounds_of(mesh);
  return bounds.low + 0.5 * (bounds.high - bounds.low);
}

}  // namespace

Bounds bounds_of(const TriangleMesh& mesh) {
  require(!mesh.vertices.empty(), "bounds_of: a mesh without vertices has no bounds");
  Bounds bounds{mesh.vertices.front(), mesh.vertices.front()};
  for (const Vector3d& vertex : mesh.vertices) {
    bounds.low = bounds.low.cwiseMin(vertex);
    bounds.high = bounds.high.cwiseMax(vertex);
  }
  return bounds;
}

double signed_volume(const TriangleMesh& mesh) {
  return integrate(mesh, middle_of(mesh), Vector3d::Zero()).volume;
}

MassProperties compute_mass_properties(const TriangleMesh& mesh, double density) {
  require(density > 0.0, "compute_mass_properties: density must be positive");
  const Vector3d middle = middle_of(mesh);

  // First pass, about the centre of the bounding box: find the centre of mass.
  const Moments about_middle = integrate(mesh, middle, Vector3d::Zero());
  require(
      std::isfinite(about_middle.volume) && about_middle.volume != 0.0,
      "compute_mass_properties: the surface encloses no volume (check it with check_closed first)");
  const Vector3d com_from_middle = about_middle.first / about_middle.volume;

  // Second pass, about the centre of mass: no large moments cancel.
  const Moments about_com = integrate(mesh, middle, com_from_middle);
  const Vector3d rest = about_com.first / about_com.volume;
  const Matrix3d second = about_com.second - about_com.volume * rest * rest.transpose();

  MassProperties found;
  found.volume = about_com.volume;
  found.mass = density * found.volume;
  found.com_mesh = middle + (com_from_middle + rest);
  found.inertia_com_mesh = density * (second.trace() * Matrix3d::Identity() - second);
  find_principal(found);
  return found;
}

}  // namespace tumble
