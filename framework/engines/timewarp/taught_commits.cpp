#include "framework/engines/timewarp/taught_commits.h"

#include <algorithm>

#include <fmt/format.h>

#include "framework/engines/base/guarded_laws.h"
#include "framework/engines/timewarp/taught_search.h"

namespace tumble::engines {

void TaughtCommits::add(Discontinuity discontinuity, std::vector<std::int32_t> processes) {
  executed_.push_back({{stamp_of(discontinuity.key), std::move(processes)},
                       discontinuity.key,
                       discontinuity.first,
                       std::move(discontinuity.more),
                       discontinuity.is_silent,
                       std::move(discontinuity.noted)});
}

std::vector<Effect> TaughtCommits::effects() const {
  std::vector<Effect> effects;
  for (const Executed& executed : executed_) effects.push_back(executed.effect);
  return effects;
}

void TaughtCommits::cancel(const Rollback& rollback, const std::string& why) {
  if (rollback.stamp.time < committed_.time)
    throw StoppedRun(fmt::format(
        "{}: {} must be rolled back to t = {:.9g} s, but everything up to {:.9g} s is committed. "
        "Likely: global virtual time is too late, or may_commit accepts what is not certain",
        why, processes_.name(rollback.body), rollback.stamp.time, committed_.time));
  for (Executed& executed : executed_) {
    const auto& processes = executed.effect.processes;
    if (std::find(processes.begin(), processes.end(), rollback.body) != processes.end() &&
        !decide_.comes_before(executed.effect.stamp, rollback.stamp))
      executed.rolled_back.insert(rollback.body);
  }
}

std::vector<EventStamp> TaughtCommits::forget_cancelled() {
  std::vector<EventStamp> callbacks;
  std::erase_if(executed_, [&](const Executed& executed) {
    const bool is_gone = executed.rolled_back.size() == executed.effect.processes.size();
    if (is_gone && executed.effect.processes.size() > 1)
      run_.counters.anti_messages += executed.effect.processes.size() - 1;
    if (is_gone && executed.key.kind == StampKind::kCallback) callbacks.push_back(executed.key);
    return is_gone;
  });
  return callbacks;
}

void TaughtCommits::commit() {
  // Insertion sort: it tolerates an order that is not a strict weak order, and is fast where events
  // are almost sorted.
  for (std::size_t k = 1; k < executed_.size(); ++k)
    for (std::size_t i = k;
         i > 0 && decide_.comes_before(executed_[i].effect.stamp, executed_[i - 1].effect.stamp);
         --i)
      std::swap(executed_[i], executed_[i - 1]);
  const double gvt = processes_.global_virtual_time();
  for (;;) {
    const Stamp frame{run_.next_frame(), kLastMicrostep, WorkKind::kRedraw, -1, -1};
    const bool has_frame = frame.time <= drawn_until_, has_impact = !executed_.empty();
    if (!has_frame && !has_impact) return;
    const bool is_frame =
        has_frame && (!has_impact || decide_.comes_before(frame, executed_.front().effect.stamp));
    const Stamp next = is_frame ? frame : executed_.front().effect.stamp;
    if (!decide_.may_commit(next, gvt)) return;
    naming(fmt::format("with global virtual time at {:.9g} s", gvt), [&] {
      if (is_frame)
        commit_frame();
      else
        commit_event();
    });
    committed_ = next;
  }
}

void TaughtCommits::commit_event() {
  const Executed& executed = executed_.front();
  const EventStamp key = executed.key;
  if (!executed.rolled_back.empty())
    throw StoppedRun(
        fmt::format("{} was about to be committed, but only some of its processes were rolled back "
                    "past it: the anti-message to the others is missing",
                    processes_.name(key)));
  const bool is_later =
      committed_.time < key.time ||
      (committed_.time == key.time && committed_.kind != WorkKind::kRedraw && committed_key_ < key);
  if (!is_later)
    throw StoppedRun(
        fmt::format("{} was about to be committed after an event at {:.9g} s: comes_before orders "
                    "them wrongly, or it came too late because global virtual time or may_commit "
                    "accepted what was not certain",
                    processes_.name(key), committed_.time));
  run_.watch_order(
      key, [&](int body) -> const Flight& { return processes_.flight_before(body, key.time); });
  run_.count(executed.noted.get());
  if (executed.is_silent)
    run_.pass(key);
  else
    run_.commit(key, executed.first, executed.more);
  committed_key_ = key;
  executed_.erase(executed_.begin());
}

void TaughtCommits::commit_frame() {
  const double t = run_.next_frame();
  for (const int body : processes_.world().movers())
    if (processes_[body].at(t) == nullptr)
      throw StoppedRun(fmt::format(
          "the frame at t = {:.9g} s cannot be drawn: {} has no state that early. Likely: too many "
          "were purged (states_to_purge), or may_commit refused the frame too long",
          t, processes_.name(body)));
  run_.commit_frame([&](int body) -> const Flight& { return processes_.flight_at(body, t); });
}

void TaughtCommits::require_nothing_left() const {
  const double left = run_.next_frame();
  if (executed_.empty() && left > run_.duration()) return;
  throw StoppedRun(fmt::format("the run is over, but may_commit still refuses {}",
                               executed_.empty() ? fmt::format("the frame at t = {:.9g} s", left)
                                                 : processes_.name(executed_.front().key)));
}

}  // namespace tumble::engines
