#include "framework/engines/timewarp/taught_motion.h"

#include <algorithm>

#include <fmt/format.h>

#include "framework/engines/timewarp/taught_search.h"

namespace tumble::engines {
namespace {

// states of a body: with fewer the scheduler is not called
constexpr std::size_t kWorthPurging = 6;

}  // namespace

void TaughtMotion::integrate(int body, double t) {
  while (processes_.local_time(body) < t) step_to(body, processes_.local_time(body) + run_.step());
}

void TaughtMotion::step_to(int body, double to) {
  const double from = processes_.local_time(body);
  processes_[body].integrate_to(to);
  ++run_.counters.steps;
  ++run_.counters.integrations;
  moves_.add(body, from, to, processes_.global_virtual_time());
  pairs_.find(body, from);
}

void TaughtMotion::go_to(int body, double t, std::optional<std::uint32_t> version,
                         const std::string& why) {
  const double now = processes_.local_time(body);
  if ((version && processes_.flight(body).version != *version) || now > t)
    throw StoppedRun(fmt::format(
        "{}, and {} was not rolled back to it: its local virtual time is {:.9g} s{}", why,
        processes_.name(body), now, now > t ? "" : ", on a flight that begins later"));
  if (now < t) step_to(body, t);
}

void TaughtMotion::go_back(const Rollback& rollback, const std::string& why) {
  TaughtLogicalProcess& back = processes_[rollback.body];
  const double from = back.local_time(), to = rollback.stamp.time;
  const auto is_undone = [&](const KeptState& state) {
    if (state.time > to) return true;
    const bool is_from_the_start = state.began.body_a < 0;
    return !is_from_the_start && state.began.time >= to &&
           !decide_.comes_before(stamp_of(state.began), rollback.stamp);
  };
  std::size_t dropped = 0;
  while (!back.states().empty() && is_undone(back.states().back())) {
    if (back.states().size() == 1)
      throw StoppedRun(
          fmt::format("{}: {} must be rolled back to t = {:.9g} s, but no earlier state is left: "
                      "the earliest is that of {:.9g} s, with global virtual time at {:.9g} s. "
                      "Likely: too many were purged (states_to_purge), or global virtual time is "
                      "too late",
                      why, processes_.name(rollback.body), to, back.states().front().time,
                      processes_.global_virtual_time()));
    back.drop_latest();
    ++dropped;
  }
  if (back.local_time() < to) back.integrate_to(to);
  if (dropped == 0) return;
  ++run_.counters.rollbacks;
  run_.counters.undone_integrations += dropped;
  moves_.add(rollback.body, from, to, processes_.global_virtual_time());
}

void TaughtMotion::purge() {
  const FlightWorld& world = processes_.world();
  const double gvt = processes_.global_virtual_time();
  std::uint64_t kept = 0;
  for (const int body : world.movers()) {
    const std::size_t count = processes_[body].states().size();
    kept += count;
    if (count < kWorthPurging) continue;
    const std::size_t purged = decide_.states_to_purge(processes_[body].times(), gvt);
    if (purged >= count)
      throw StoppedRun(fmt::format(
          "states_to_purge discards {} of the {} states of {}: none is left to continue from",
          purged, count, processes_.name(body)));
    if (purged == 0) continue;
    processes_[body].drop_oldest(purged);
    pairs_.drop(body);
  }
  if (world.processes()) world.processes()->segments().forget_before(gvt);
  run_.counters.states_kept = std::max(run_.counters.states_kept, kept);
}

}  // namespace tumble::engines
