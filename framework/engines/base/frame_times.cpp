#include "framework/engines/base/frame_times.h"

#include <algorithm>

#include "framework/engines/base/run_options.h"
#include "framework/engines/base/tolerances.h"

namespace tumble::engines {
namespace {

std::vector<double> instants_of(const scene::Scene& scene) {
  std::vector<double> instants;
  for (const scene::CheckSpec& check : scene.checks) instants.push_back(check.at_s);
  return instants;
}

}  // namespace

FrameTimes::FrameTimes(double rate_hz, double duration_s, std::vector<double> instants_s)
    : rate_(rate_hz),
      duration_(duration_s),
      slack_(kNegligible * std::min(1.0 / rate_hz, duration_s)),
      instants_(std::move(instants_s)) {
  std::sort(instants_.begin(), instants_.end());
}

FrameTimes::FrameTimes(const scene::Scene& scene, const RunOptions& options)
    : FrameTimes(options.frame_rate_hz, options.duration_s.value_or(scene.duration_s),
                 instants_of(scene)) {}

void FrameTimes::take() {
  if (next_ >= duration_) {
    next_ = std::numeric_limits<double>::infinity();
    return;
  }
  const double earliest = next_ + slack_;
  while (static_cast<double>(multiple_) / rate_ <= earliest) ++multiple_;
  while (taken_instants_ < instants_.size() && instants_[taken_instants_] <= earliest)
    ++taken_instants_;
  const double multiple = static_cast<double>(multiple_) / rate_;
  next_ = multiple;
  // a multiple rather than what rounding parts from it
  if (taken_instants_ < instants_.size() && instants_[taken_instants_] < multiple - slack_)
    next_ = instants_[taken_instants_];
  if (next_ >= duration_ - slack_) next_ = duration_;
}

}  // namespace tumble::engines
