/// What a caller may keep about a pair of solids between questions, to be answered sooner. Answers are the same without it, bit for bit.
///
/// Keep one object a pair of solids (the same two, in the same order) and hand its address to every question about them; forget it
/// when the pair is forgotten. Where one of the two is not convex, of thousands of pairs of faces only
/// those near each other are looked at as long as the two have not moved far; two convex solids out of reach are told by one axis; and a
/// distance that is asked for again where the two still stand is the one that was found. Not to be shared between threads. Nothing in it
/// concerns the caller.
#pragma once

#include <vector>

#include "framework/collision/collision_shape.h"
#include "framework/core/math.h"

namespace tumble::collision {

struct PairCache {
  struct Near {
    int piece_a, piece_b;
    double distance;   // then [m]
  };
  std::vector<Near> near;                      // all pairs of pieces nearer than `reach` then, sorted
  double reach = -1.0;                         // [m]; negative: empty
  Matrix3d a_from_b = Matrix3d::Identity();    // where the two were then
  Vector3d b_in_a = Vector3d::Zero(), a_in_b = Vector3d::Zero();   // [m]
  int served = 0, unused = 0;                  // questions answered from it; to pass until it is filled again
  Vector3d apart_along_body_a = Vector3d::Zero();   // of two convex solids; zero: not known
  double measured = 0.0, measured_up_to = -1.0;     // the last gap_distance and its limit [m]; a limit below 0: none yet
  Pose measured_a, measured_b;                      // where the two stood for it

  /// Whether the last gap_distance was of these very places.
  bool measured_at(const Pose& a, const Pose& b) const {
    const auto same = [](const Pose& p, const Pose& q) { return p.com_world == q.com_world && p.world_from_body.coeffs() == q.world_from_body.coeffs(); };
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
