#include "framework/engines/base/frame_times.h"

#include <algorithm>
#include <limits>

#include "framework/engines/base/run_options.h"
#include "framework/engines/base/tolerances.h"

namespace tumble::engines {
namespace {

// Of a frame time and of a run: an instant nearer to a frame than this has no other state, and
// who steps from frame to frame would not see it.
constexpr double kSamePart = 1e-3;

}  // namespace

FrameTimes::FrameTimes(double rate_hz, double duration_s, std::vector<double> instants_s)
    : rate_(rate_hz),
      duration_(duration_s),
      slack_(kNegligible * std::min(1.0 / rate_hz, duration_s)),
      same_(std::min(kSameInstant, kSamePart * std::min(1.0 / rate_hz, duration_s))),
      instants_(std::move(instants_s)) {
  std::sort(instants_.begin(), instants_.end());
}

FrameTimes::FrameTimes(const RunOptions& options, double duration_s)
    : FrameTimes(options.frame_rate_hz, options.duration_s.value_or(duration_s),
                 options.instants_s) {}

void FrameTimes::take() {
  if (next_ >= duration_) {
    next_ = std::numeric_limits<double>::infinity();
    return;
  }
  while (static_cast<double>(multiple_) / rate_ <= next_ + slack_) ++multiple_;
  const double multiple = std::min(static_cast<double>(multiple_) / rate_, duration_);
  while (taken_instants_ < instants_.size() && instants_[taken_instants_] <= next_ + same_)
    ++taken_instants_;
  next_ = multiple;
  if (taken_instants_ < instants_.size() && instants_[taken_instants_] < multiple - same_)
    next_ = instants_[taken_instants_];
  if (next_ >= duration_ - slack_) next_ = duration_;
}

}  // namespace tumble::engines
