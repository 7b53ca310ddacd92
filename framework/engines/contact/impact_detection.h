/// Which bodies meet within a step, and which of them first; which touch where the world stands.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "framework/engines/stepping/moving_world.h"

namespace tumble::engines {

/// The first impact of a step.
struct Earliest {
  double time;       // [s]
  std::size_t pair;  // place in the list of pairs that was asked about
};

/// How readily an impulse moves two bodies: their inverse masses, 0 of one that stands. [1/kg]
struct Moved {
  double a, b;
};

/// The middle of where two solids touch, then the corners of that region if it is more than a
/// point. World frame. [m]
/// @param rounding  what rounding leaves of the places there [m]
std::vector<Vector3d> touching_points(const collision::CollisionShape& a,
                                      const collision::Pose& pose_a,
                                      const collision::CollisionShape& b,
                                      const collision::Pose& pose_b, const collision::Gap& gap,
                                      const Moved& moved, double rounding);

class ImpactDetection {
 public:
  using Pair = std::pair<int, int>;  // bodies, first < second

  ImpactDetection(MovingWorld& moving, const Laws& laws, RunCounters& counters);

  /// Whether there are bodies that may meet at all.
  bool any() const { return colliding_.size() > 1; }
  /// @throws OverlapAtStart (start_overlaps.h) naming two bodies that overlap at the start by more
  /// than roundings, and `where` they were asked for
  void refuse_overlap(const std::string& where, const scene::Scene& scene) const;

  /// Pairs whose swept boxes meet in the step under way, sorted; none of bodies that both stand
  /// still.
  std::vector<Pair> candidates();
  /// The first impact of these pairs in the step under way; nothing where none meets.
  std::optional<Earliest> earliest(const std::vector<Pair>& pairs);
  /// Whether that search has found all its pairs farther apart at the step's target than rounding
  /// could bring together.
  bool apart_at_target() const { return apart_at_target_; }

  /// At the committed time.
  collision::Gap gap(Pair pair) const;
  /// Gaps up to this count as touching: what rounding of places and times leaves. [m]
  double touching_distance(Pair pair) const;
  /// The middle of where the two touch, then the corners of that region if it is more than a point.
  /// World frame. [m]
  /// @param band  that much farther apart than the nearest, points touch too [m]
  std::vector<Vector3d> touching_points(Pair pair, const collision::Gap& gap,
                                        double band = 0.0) const;
  /// Takes back what rounding left of overlaps. Notes what it cannot take back (kOverlapLeft).
  void separate(const std::vector<Pair>& pairs);

 private:
  void note_overlaps(const std::vector<Pair>& pairs);
  std::vector<Pair> pairs_of_boxes();
  bool ask_for_ends(const std::vector<Pair>& pairs);
  struct Plane;
  Plane plane_of(int box);
  std::optional<Earliest> find_earliest(const std::vector<Pair>& pairs);
  std::optional<Earliest> find_missed(const std::vector<Pair>& pairs, double target);
  double gap_on_path(Pair pair, double t);
  collision::Pose pose_of(int body) const {
    return {moving_.state(body).com_world, moving_.state(body).world_from_body};
  }

  MovingWorld& moving_;
  const Laws& laws_;
  RunCounters& counters_;
  bool apart_at_target_ = false;
  std::vector<int> colliding_;              // bodies that may touch others, ascending
  std::vector<collision::SweptBox> boxes_;  // of these, in the step under way
  collision::NearBoxes near_boxes_;
};

}  // namespace tumble::engines
