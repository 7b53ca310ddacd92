#include "framework/live/former_run.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tumble::live {
namespace {

constexpr std::chrono::milliseconds kComparesEvery{400};

}  // namespace

void FormerRun::clear() {
  run_ = History();
  has_ended_ = false;
  compare_anew(0.0);
}

void FormerRun::keep(History& run, bool has_ended) {
  if (run.frames().size() <= 1) return;
  run_ = std::move(run);
  has_ended_ = has_ended;
}

void FormerRun::compare_anew(double from_s) {
  compared_until_ = std::min(compared_until_, from_s);
  has_difference_ = false;
  told_.clear();
}

void FormerRun::compare(const History& shown, bool has_ended) {
  const auto now = std::chrono::steady_clock::now();
  if (has_difference_ || !is_there() || now - compared_at_ < kComparesEvery) return;
  compared_at_ = now;
  const double end = std::min(run_.end_s(), shown.end_s());
  // The last common instant is compared, too, when nothing more can come at it.
  const bool is_whole = (has_ended_ || run_.end_s() > end) && (has_ended || shown.end_s() > end);
  const double until =
      is_whole ? std::nextafter(end, std::numeric_limits<double>::infinity()) : end;
  if (!(until > compared_until_) || run_.radii_m().size() != shown.radii_m().size()) return;
  const Trajectory a = run_.part(compared_until_, until), b = shown.part(compared_until_, until);
  if (a.frames.empty() || b.frames.empty()) return;
  const auto found =
      report::compare(shown.outline(), shown.radii_m(), b, "this run", a, "the run before");
  compared_until_ = until;
  Json words{{"kind", "difference"}, {"same_until_s", end}};
  if (found.first) {
    has_difference_ = true;
    words["time_s"] = found.first->time_s;
    words["what"] = found.first->what;
    words["body"] = found.first->body;
  }
  told_ = pages_.tell(words);
}

}  // namespace tumble::live
