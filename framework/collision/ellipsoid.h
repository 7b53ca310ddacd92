/// Ellipsoid against plane, in closed form.
///
/// The lowest point of an ellipsoid along a unit direction u; its points are c + A s, |s| = 1, with
/// centre c and semi-axes A = diag(a, b, c):
///   c - A^2 u / |A u|,   at the height   c . u - |A u|                                       (E.2)
/// (its support function; body frame). As the body rotates, this contact point moves over the
/// surface.
/// Source: support function of an ellipsoid, e.g. S. Boyd, L. Vandenberghe, Convex Optimization,
/// 2004, ch. 3.
#pragma once

#include "framework/geometry/shape.h"

namespace tumble::collision {

/// @param direction_body  (3), any length above 0
/// @return the lowest point, body frame [m]
inline Vector3d lowest_point(const Ellipsoid& e, const Vector3d& direction_body) {
  const Vector3d across = e.semi_axes_body.cwiseProduct(direction_body);
  return e.center_body - e.semi_axes_body.cwiseProduct(across) / across.norm();
}

/// The minimum of direction . point over the ellipsoid. [m, for a unit direction]
inline double lowest_height(const Ellipsoid& e, const Vector3d& direction_body) {
  return e.center_body.dot(direction_body) - e.semi_axes_body.cwiseProduct(direction_body).norm();
}

/// Lower bound on the gap from the motion of the centre of mass against the plane: gap + rate t +
/// half_acceleration t^2.
struct Approach {
  double gap;                // >= 0 [m]
  double rate;               // [m/s]
  double half_acceleration;  // [m/s^2]
};

/// How long a rotating ellipsoid certainly stays above a plane: (E.1) of time_bound.h for all
/// points of its surface at once,
///   gap + min over points r of (u . r + t (n x w) . r) - min over r of u . r + rate t +
///   half_acceleration t^2 > 0,
/// where both minima are (E.2). The sum is concave and not negative at 0: where it is positive at a
/// time, it is positive at all earlier times.
/// @param up_body    the plane's unit normal in the body's frame
/// @param turn_body  n x w in the body's frame: the rotation lifts the point r at the rate (n x w)
///   . r [1/s]
/// @param approach   its half_acceleration includes the bound on accelerations from rotation
/// @return [s], in [0, horizon]; exactly the horizon where no contact is possible before
double duration_of_ellipsoid(const Ellipsoid& e, const Vector3d& up_body, const Vector3d& turn_body,
                             const Approach& approach, double horizon);

}  // namespace tumble::collision
