/// Temporal coherence: a cache of a pair of solids that makes repeated queries cheaper. Results are
/// the same without it, bit for bit.
///
/// Keep one object per pair of solids (the same two, in the same order), pass its address to every
/// query of the pair, and drop it with the pair. Where a solid is not convex, only the near ones of
/// thousands of pairs of faces are tested until the solids have moved far. Two convex solids out of
/// reach are rejected by one separating axis, and known to be within reach by two of their points.
/// A distance query in unchanged poses returns the last result. Not to be shared between threads.
/// The members are internal to collision.
#pragma once

#include <optional>
#include <vector>

#include "framework/collision/collision_shape.h"
#include "framework/collision/polytope_gap.h"
#include "framework/core/math.h"
#include "framework/core/numbers.h"

namespace tumble::collision {

struct PairCache {
  struct Near {
    int piece_a, piece_b;
    double distance;  // when the cache was filled [m]
  };
  // all pairs of pieces closer than `reach` when the cache was filled, sorted
  std::vector<Near> near;
  double reach = -1.0;                       // [m]; negative: empty
  Matrix3d a_from_b = Matrix3d::Identity();  // relative poses when the cache was filled
  Vector3d b_in_a = Vector3d::Zero(), a_in_b = Vector3d::Zero();  // [m]
  // queries answered from it; queries to wait until it is filled again
  int served = 0, unused = 0;
  // Of two convex solids: the separating axis of the last query, in the world, where it stays while
  // one rolls on the other, and how far they were apart along it; 0 before the first [m]
  Vector3d apart_along_world = Vector3d::Zero();
  double apart_by = 0.0;
  // of two convex solids: a point of each that were nearest when last looked for; NaN: not known
  Vector3d near_body_a = Vector3d::Constant(kUnset), near_body_b = near_body_a;
  // The last gap of two convex solids that were within reach, and where that was: the same instant
  // is often asked for again, as a step's end and the next one's start.
  struct Placed {
    Matrix3d rotation_a, rotation_b;
    Vector3d offset;  // centre of A minus centre of B [m]
    PolytopeGap gap;
    bool has_points;
  };
  std::optional<Placed> last;
  // the last gap_distance and its limit [m]; limit < 0: none yet
  double measured = 0.0, measured_up_to = -1.0;
  Pose measured_a, measured_b;  // the poses of the last gap_distance

  /// Whether the last gap_distance was for exactly these poses.
  bool measured_at(const Pose& a, const Pose& b) const {
    const auto same = [](const Pose& p, const Pose& q) {
      return p.com_world == q.com_world && p.world_from_body.coeffs() == q.world_from_body.coeffs();
    };
    return measured_up_to >= 0.0 && same(a, measured_a) && same(b, measured_b);
  }
  void note(const Pose& a, const Pose& b, double distance, double limit) {
    measured = distance;
    measured_up_to = limit;
    measured_a = a;
    measured_b = b;
  }
};

}  // namespace tumble::collision
