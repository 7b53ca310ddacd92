/// A run as it came: frames and events, byte for byte, with their heads.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "framework/report/comparison.h"
#include "framework/scene/scene.h"

namespace tumble::live {

class History {
 public:
  static constexpr std::size_t kMostKept = 400u << 20;  // bytes

  History() = default;
  /// @param head  JSON of the record kHead
  explicit History(std::string head, std::size_t most_bytes = kMostKept);

  const std::string& head() const { return head_; }
  /// Where the page measures places from, in the world. [m]
  const Vector3d& origin_world() const { return origin_world_; }
  const std::vector<std::string>& frames() const { return frames_; }
  const std::vector<std::string>& events() const { return events_; }
  bool is_full() const { return is_full_; }
  /// Up to where the run is kept, and why no further, for people; empty: all of it is kept.
  std::string limit_in_words() const;
  /// @param bytes  as packed by records.h; left out where the run is too long to be kept
  void add_frame(std::string bytes);
  void add_event(std::string bytes);
  /// Forgets what came at this time or later.
  void cut(double time_s);
  double end_s() const { return frames_.empty() ? 0.0 : time_of(frames_.back()); }
  static double time_of(const std::string& packed);

  /// Frames and events with from_s <= time < until_s, with the bodies' names.
  Trajectory part(double from_s, double until_s) const;
  /// What a comparison needs of the scene: bodies' names, the camera.
  const scene::Scene& outline() const { return outline_; }
  const std::vector<double>& radii_m() const { return radii_; }

 private:
  bool has_room_for(const std::string& bytes);

  std::string head_;
  Vector3d origin_world_ = Vector3d::Zero();
  scene::Scene outline_;
  std::vector<double> radii_;
  std::vector<std::string> frames_, events_;
  std::size_t bytes_ = 0, most_bytes_ = kMostKept;
  bool is_full_ = false;
};

/// Numbers of a record as the page gets them: float32, little-endian, in base64, with places from
/// the page's origin. Of a frame: time, kinetic and potential energy, momentum (3), angular
/// momentum (3), smallest gap, numbers of bodies, springs, rods, joints and contacts, and so on as
/// in records.cpp; last, what the total energy has changed by since the first frame, which float32
/// would not show.
/// @param first  the run's first frame, packed
std::string frame_for_page(const std::string& packed, const std::string& first,
                           const Vector3d& origin_world);
std::string event_for_page(const std::string& packed, const Vector3d& origin_world);

}  // namespace tumble::live
