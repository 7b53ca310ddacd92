/// The point of a simplex of up to four points that is nearest to the origin: the inner step of the
/// GJK algorithm.
#pragma once

#include <array>

#include "framework/core/math.h"

namespace tumble::collision {

/// A corner of the Minkowski difference, and the vertices of A and B that it comes from.
struct DifferencePoint {
  Vector3d difference;  // a - b
  int vertex_a, vertex_b;
};

struct Simplex {
  std::array<DifferencePoint, 4> points;
  std::array<double, 4> weights;  // barycentric, of the nearest point
  int size = 0;
};

/// Reduces a simplex to the smallest face that contains its point nearest to the origin, and sets
/// the weights.
/// @return the nearest point; exactly zero, with the simplex unchanged, where four points enclose
///   the origin
/// Source: C. Ericson, Real-Time Collision Detection, 2005, sec. 5.1.
Vector3d reduce_to_nearest(Simplex& simplex);

}  // namespace tumble::collision
