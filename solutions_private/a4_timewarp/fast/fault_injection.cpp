// Rollback of everything, for tests. Part of Coordinator.
#include <algorithm>
#include <cmath>

#include "solutions_private/a4_timewarp/fast/coordinator.h"
#include "solutions_private/a4_timewarp/fast/state_snapshot.h"

namespace tumble::a4 {
namespace {

constexpr int kStride = 17;  // mixes short and long injections; no divisor of most numbers

}  // namespace

// With a limit of states, what is committed to keep it cannot be rolled back: no injections then.
bool Coordinator::is_injection_due() {
  return all_.most_states == 0 && watch_ != nullptr && watch_->every > 0 &&
         ++since_injection_ >= watch_->every;
}

// Rolls back to just before the next event: nothing happens at that very time, and nothing
// committed lies after it. Nothing is committed or released meanwhile.
void Coordinator::inject_rollback(const std::function<void()>& take_a_step) {
  const double t = std::nextafter(next_time(), 0.0);
  if (!(t > last_injection_)) return;  // otherwise it would make no progress
  last_injection_ = t;
  since_injection_ = 0;
  const int steps = 1 + (watch_->first + kStride * injections_++) % watch_->most_steps;
  const auto roll_back_to = [&] {
    all_.global_virtual_time = t;
    all_.committed = std::min(all_.committed, t);  // rounding by which an injection may go back
    for (const int body : all_.world().movers()) alone().roll_back_to(body, t);
    return snapshot_of(all_, workers_, t);
  };
  const engines::StateSnapshot before = roll_back_to();
  int taken = 0;
  for (; taken < steps && next_time() <= all_.run.duration(); ++taken) take_a_step();
  watch_->report(t, taken, before, roll_back_to());
}

}  // namespace tumble::a4
