#include "framework/render/path.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "framework/core/error.h"

namespace tumble::render {
namespace {

double angle_between(const Vector3d& a, const Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

// Directions in which a line from the last kept point passes all points since within the slack.
class Sleeve {
 public:
  explicit Sleeve(double slack_m) : slack_m_(slack_m) {}

  // Whether the line to this point, given from the last kept one, passes all points since.
  bool reaches(const Vector3d& along) const {
    const double distance = along.norm();
    // Not back from the farthest point, which would be beyond the line's end.
    if (!(distance >= farthest_m_ - slack_m_)) return false;
    return half_angle_ >= std::numbers::pi || angle_between(axis_, along) <= half_angle_;
  }

  // Narrows the sleeve to the lines that pass this point too.
  void add(const Vector3d& along) {
    const double distance = along.norm();
    farthest_m_ = std::max(farthest_m_, distance);
    if (distance <= slack_m_) return;  // every line passes it
    const Vector3d axis = along / distance;
    const double half_angle = std::asin(slack_m_ / distance);
    const double apart = half_angle_ >= std::numbers::pi ? 0.0 : angle_between(axis_, axis);
    if (apart + half_angle <= half_angle_) {  // the new cone is within the old one
      axis_ = axis;
      half_angle_ = half_angle;
    } else if (apart + half_angle_ > half_angle) {
      // The largest cone in both touches both on the great circle through their axes. `reaches` has
      // found the new axis in the old cone: apart <= half_angle_, so it is not empty.
      const double both = 0.5 * (half_angle_ + half_angle - apart);
      const double turn = (half_angle_ - both) / apart;  // fraction of the way to the new axis
      axis_ = (std::sin((1.0 - turn) * apart) * axis_ + std::sin(turn * apart) * axis).normalized();
      half_angle_ = both;
    }
  }

 private:
  double slack_m_;
  double farthest_m_ = 0.0;
  Vector3d axis_ = Vector3d::UnitZ();
  double half_angle_ = std::numbers::pi;  // pi: every direction
};

}  // namespace

std::vector<std::size_t> path_frames(const Trajectory& run, std::size_t body, double slack_m) {
  require(slack_m > 0.0, "path_frames: the slack is not above 0");
  const auto place = [&](std::size_t frame) -> const Vector3d& {
    return run.frames[frame].poses[body].com_world;
  };
  std::vector<std::size_t> kept;
  Sleeve sleeve(slack_m);
  std::size_t before = 0;  // the last finite frame
  for (std::size_t f = 0; f < run.frames.size(); ++f) {
    if (!place(f).allFinite()) continue;
    if (kept.empty()) kept.push_back(f);
    if (!sleeve.reaches(place(f) - place(kept.back()))) {
      kept.push_back(before);
      sleeve = Sleeve(slack_m);
    }
    sleeve.add(place(f) - place(kept.back()));
    before = f;
  }
  if (!kept.empty() && kept.back() != before) kept.push_back(before);
  return kept;
}

}  // namespace tumble::render
