/// An ellipsoid over a plane, in closed form.
///
/// Of the points c + A s, |s| = 1, of an ellipsoid with middle c and semi-axes A = diag(a, b, c), the lowest along a unit direction u is
///   c - A^2 u / |A u|,   at the height   c . u - |A u|                                                     (E.2)
/// (its support function; body frame). As the body turns the point wanders over the surface, and with it what touches.
/// Source: support function of an ellipsoid, e.g. S. Boyd, L. Vandenberghe, Convex Optimization, 2004, ch. 3.
#pragma once

#include "framework/geometry/shape.h"

namespace tumble::collision {

/// @param direction_body  (3), any length above 0  @return the point's place in the body frame [m]
inline Vector3d lowest_point(const Ellipsoid& e, const Vector3d& direction_body) {
  const Vector3d across = e.semi_axes_body.cwiseProduct(direction_body);
  return e.center_body - e.semi_axes_body.cwiseProduct(across) / across.norm();
}

/// The least of direction . point over the ellipsoid. [m, for a unit direction]
inline double lowest_height(const Ellipsoid& e, const Vector3d& direction_body) {
  return e.center_body.dot(direction_body) - e.semi_axes_body.cwiseProduct(direction_body).norm();
}

/// How the centre of mass moves against the plane: gap + rate t + half_acceleration t^2, each a bound from below.
struct Approach {
  double gap;                 // >= 0 [m]
  double rate;                // [m/s]
  double half_acceleration;   // [m/s^2]
};

/// How long an ellipsoid that turns certainly stays above a plane: (E.1) of time_bound.h for all points of its surface at once,
///   gap + min over points r of (u . r + t (n x w) . r) - min over r of u . r + rate t + half_acceleration t^2 > 0,
/// where both minima are (E.2). A sum of concave functions: above zero at a time, it is above zero all the way to it.
/// @param up_body    the plane's unit normal in the body's frame
/// @param turn_body  n x w in the body's frame, so that (n x w) . r is the rate at which the point r rises by turning [1/s]
/// @param approach   what turning bends paths by is part of half_acceleration
/// @return [s], in [0, horizon]; exactly the horizon where nothing touches before
double duration_of_ellipsoid(const Ellipsoid& e, const Vector3d& up_body, const Vector3d& turn_body, const Approach& approach, double horizon);

}  // namespace tumble::collision
