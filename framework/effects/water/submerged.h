/// How much of a solid lies under a plane, and where: exactly, for balls, ellipsoids and closed
/// surfaces.
#pragma once

#include <utility>
#include <variant>

#include "framework/geometry/shape.h"

namespace tumble::effects {

/// The part of a solid on the negative side of a plane. All in one frame, moments about its origin.
///   volume = int 1 dV,   first = int x dV,   second = int x x' dV
struct Submerged {
  double volume = 0.0;                 // [m^3]
  Vector3d first = Vector3d::Zero();   // (3) [m^4]
  Matrix3d second = Matrix3d::Zero();  // (3, 3) [m^5]
};

/// Of a ball about the origin: the cap x . n <= offset.  [-R, d] along n:
///   V = pi (R^2 z - z^3 / 3),   int z = pi (R^2 z^2 / 2 - z^4 / 4),
///       int z^2 = pi (R^2 z^3 / 3 - z^5 / 5),   int x^2 = pi / 4 (R^4 z - 2 R^2 z^3 / 3 + z^5 / 5)
/// @param normal  (3), unit, out of what is under the plane  @param offset  [m]
Submerged submerged_ball(double radius, const Vector3d& normal, double offset);

/// Of an ellipsoid: the image of a unit ball.
Submerged submerged_ellipsoid(const Ellipsoid& ellipsoid, const Vector3d& normal, double offset);

/// Of the solid inside a closed, outward-oriented surface: the sum over tetrahedra from a point of
/// the plane to the faces, each cut off at the plane. What closes the cut lies in the plane and
/// adds nothing.   Source: as compute_mass_properties (geometry/mass_properties.h)
/// Cost: O(faces)
Submerged submerged_mesh(const TriangleMesh& mesh, const Vector3d& normal, double offset);

/// What may lie in water: a solid in its body's frame.
class Floatable {
 public:
  /// @throws PreconditionError for a half-space
  explicit Floatable(const Shape& shape);

  Submerged under(const Vector3d& normal_body, double offset) const;
  /// How far it reaches along a direction: the least and the largest x . direction. (2) [m]
  std::pair<double, double> reach(const Vector3d& direction_body) const;
  const Submerged& whole() const { return whole_; }
  // of a ball about the body's origin that holds it [m]
  double radius() const { return radius_; }

 private:
  std::variant<Sphere, Ellipsoid, TriangleMesh> solid_;
  double radius_;
  Submerged whole_;
};

}  // namespace tumble::effects
