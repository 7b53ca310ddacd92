// Rolling everything back on trial. Part of Conductor.
#include <algorithm>
#include <cmath>

#include "solutions_private/a4_timewarp/fast/conductor.h"
#include "solutions_private/a4_timewarp/fast/standing.h"

namespace tumble::a4 {
namespace {

constexpr int kStride = 17;   // long and short trials in turn; no divisor of most numbers

}  // namespace

// Where states have a cap, what is committed to keep it cannot be taken back: no trials there.
bool Conductor::is_time_for_a_trial() { return all_.most_states == 0 && watch_ != nullptr && watch_->every > 0 && ++since_trial_ >= watch_->every; }

// Just before what is next: nothing happens at the very time, and nothing that is committed lies beyond it. Nothing more is committed
// meanwhile, and so nothing is let go.
void Conductor::try_rollback(const std::function<void()>& take_a_step) {
  const double t = std::nextafter(next_time(), 0.0);
  if (!(t > last_trial_)) return;   // else it would never come farther
  last_trial_ = t;
  since_trial_ = 0;
  const int steps = 1 + (watch_->first + kStride * trials_++) % watch_->most_steps;
  const auto go_back = [&] {
    all_.global_virtual_time = t;
    all_.committed = std::min(all_.committed, t);   // the rounding by which a trial goes back
    for (const int body : all_.world().movers()) alone().go_back(body, t);
    return standing_of(all_, workers_, t);
  };
  const engines::Standing before = go_back();
  int taken = 0;
  for (; taken < steps && next_time() <= all_.run.duration(); ++taken) take_a_step();
  watch_->tell(t, taken, before, go_back());
}

}  // namespace tumble::a4
