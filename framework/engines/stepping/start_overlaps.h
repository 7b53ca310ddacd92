/// Bodies that overlap when a run begins: refused, or where the rounding of typed decimals and of
/// single-precision models explains it removed, and reported. One law for all engines.
///
/// An engine collects what is near at the start and calls refuse_overlaps; run_scene catches what
/// is thrown, moves bodies apart and begins again, or lets the refusal stand.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "framework/collision/gap.h"
#include "framework/collision/sweep.h"
#include "framework/core/error.h"
#include "framework/scene/scene.h"

namespace tumble::engines {

/// Two bodies that touch or overlap at the start, or are as near as what could be moved. By index
/// in the scene.
struct StartPair {
  int body_a, body_b;
  double gap;                    // [m]; < 0 overlapping
  double explained;              // the deepest overlap that rounding explains [m]
  bool overlaps;                 // by more than the roundings of doubles
  Vector3d normal_b_to_a_world;  // unit
};

/// How deep two bodies may be in each other because a scene's places are decimals cut short, and a
/// model's corners single precision: each of the two may be off by half a spacing of float32
/// numbers of the size of its place and its extent,
///   2^-24 (|x_a| + r_a + |x_b| + r_b),
/// and both for place and shape: 2^-23 of it. Never more than a ten-thousandth of the smaller body,
/// which would be seen.
double explained_overlap(const collision::CollisionShape& a, const collision::Pose& pose_a,
                         const collision::CollisionShape& b, const collision::Pose& pose_b);

/// Some bodies overlap at the start. What the user reads where nothing is done about it names the
/// first pair that rounding does not explain, with both numbers.
class OverlapAtStart : public UserError {
 public:
  OverlapAtStart(const std::string& where, const scene::Scene& scene, std::vector<StartPair> near);
  const std::vector<StartPair>& near() const { return near_; }
  /// Whether rounding explains every overlap.
  bool is_explained() const;

 private:
  std::vector<StartPair> near_;
};

/// A box about a body at the start, so wide that the boxes of two bodies overlap where
/// look_at_start would keep the pair.
collision::SweptBox start_box(const collision::CollisionShape& shape, const collision::Pose& pose,
                              bool can_move);

/// Looks at one pair for an engine, and keeps it where it matters.
/// @param touching  an overlap this deep is a rounding of doubles [m]
void look_at_start(int a, int b, const collision::CollisionShape& shape_a,
                   const collision::Pose& pose_a, const collision::CollisionShape& shape_b,
                   const collision::Pose& pose_b, double touching, std::vector<StartPair>& near);

/// @throws OverlapAtStart where one of the pairs overlaps
void refuse_overlaps(const std::string& where, const scene::Scene& scene,
                     const std::vector<StartPair>& near);

/// The scene with bodies moved apart, outward from what is immovable, so that none of the pairs
/// overlaps; and a sentence about it.
/// @return nothing where no such places were found (a body wedged between others)
struct MovedApart {
  scene::Scene scene;
  std::string notice;
};
std::optional<MovedApart> moved_apart(const scene::Scene& scene,
                                      const std::vector<StartPair>& near);

}  // namespace tumble::engines
