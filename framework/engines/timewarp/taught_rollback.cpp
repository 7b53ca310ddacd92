// Rollback and commit. Part of TaughtTimewarp.
#include "framework/engines/timewarp/taught_run.h"

#include <algorithm>

#include "framework/core/numbers.h"

namespace tumble::engines {
namespace {

// states of a body: with fewer the scheduler is not called
constexpr std::size_t kWorthPurging = 6;

}  // namespace

// ---- Rollback ----------------------------------------------------------------------------------

void TaughtTimewarp::roll_back(const std::vector<Rollback>& first, const std::string& why) {
  std::vector<Effect> effects;
  for (const Executed& executed : executed_) effects.push_back(executed.effect);
  const std::vector<Rollback> plan = decide_.plan_rollback(effects, first);
  // A process is rolled back once: a longer plan would cost its length times the queue's.
  if (plan.size() > first.size() + static_cast<std::size_t>(world().size()))
    throw StoppedRun(fmt::format("{}, and plan_rollback rolls back {} processes of {}", why,
                                 plan.size(), world().size()));
  for (const Rollback& rollback : plan) {
    if (rollback.body < 0 || rollback.body >= world().size() || !world().can_move(rollback.body))
      throw StoppedRun(fmt::format("{}, and plan_rollback rolls back {}, which is no process", why,
                                   name(rollback.body)));
    roll_back_one(rollback, why);
  }
  std::erase_if(executed_, [&](const Executed& executed) {
    const bool is_gone = executed.rolled_back.size() == executed.effect.processes.size();
    if (is_gone && executed.effect.processes.size() > 1)
      run_.counters.anti_messages += executed.effect.processes.size() - 1;
    if (is_gone && executed.key.kind == StampKind::kCallback) expect_callback(executed.key);
    return is_gone;
  });
  for (const int id : queue_.ids()) {
    const ScheduledEvent event = queue_.event(id);
    const bool is_asked = std::any_of(plan.begin(), plan.end(), [&](const Rollback& rollback) {
      return std::find(event.receivers.begin(), event.receivers.end(), rollback.body) !=
             event.receivers.end();
    });
    if (!is_asked) continue;
    ScheduledEvent moved = event;
    const ScheduledEvent answer = decide_.after_rollback(event, plan);
    moved.stamp.time = answer.stamp.time;
    moved.safe_time = answer.safe_time;
    if (moved.stamp.time != event.stamp.time || moved.safe_time != event.safe_time)
      put_check(id, moved);
  }
  for (const Rollback& rollback : plan) drop_pairs_of(rollback.body);
  keep_group_checks();
}

void TaughtTimewarp::roll_back_one(const Rollback& rollback, const std::string& why) {
  TaughtLogicalProcess& back = process(rollback.body);
  const double from = back.local_time(), to = rollback.stamp.time;
  if (to > from) return;  // it has not advanced to that time
  if (to < committed_.time)
    throw StoppedRun(fmt::format(
        "{}: {} must be rolled back to t = {:.9g} s, but everything up to {:.9g} s is committed. "
        "Likely: global virtual time is too late, or may_commit accepts what is not certain",
        why, name(rollback.body), to, committed_.time));
  // Drops the states after the rollback's stamp.
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
                      why, name(rollback.body), to, back.states().front().time, gvt_));
    back.drop_latest();
    ++dropped;
  }
  // Restores the state at that time, and marks the executed events that it cancels.
  if (back.local_time() < to) back.integrate_to(to);
  for (Executed& executed : executed_) {
    const auto& processes = executed.effect.processes;
    if (std::find(processes.begin(), processes.end(), rollback.body) != processes.end() &&
        !decide_.comes_before(executed.effect.stamp, rollback.stamp))
      executed.rolled_back.insert(rollback.body);
  }
  if (dropped == 0) return;
  ++run_.counters.rollbacks;
  run_.counters.undone_integrations += dropped;
  move(rollback.body, from, to);
}

// ---- Global virtual time -----------------------------------------------------------------------

void TaughtTimewarp::look_at_gvt(bool is_over) {
  since_asked_ = 0;
  std::vector<ScheduledEvent> events;
  for (const int id : queue_.ids()) events.push_back(queue_.event(id));
  const double gvt = is_over ? kInfinity : decide_.global_virtual_time(local_times(), events);
  if (gvt < gvt_)
    throw StoppedRun(fmt::format(
        "global virtual time falls from {:.9g} to {:.9g} s: it must never fall. Likely: it was too "
        "late before, because a local time or a safe time was left out",
        gvt_, gvt));
  if (!(gvt > gvt_)) return;
  gvt_ = gvt;
  since_gvt_ = 0;
  // of the last move of all, and not of the last that is recorded
  if (!times_.moves.empty() && !times_.is_cut)
    times_.moves.back().global_virtual_time_s = std::min(gvt_, run_.duration());
  tell_moves();
  commit();
  if (!is_over) return purge();
  const double left = run_.next_frame();
  if (!executed_.empty() || left <= run_.duration())
    throw StoppedRun(fmt::format("the run is over, but may_commit still refuses {}",
                                 executed_.empty() ? fmt::format("the frame at t = {:.9g} s", left)
                                                   : name(executed_.front().key)));
}

void TaughtTimewarp::commit() {
  // Insertion sort: it tolerates an order that is not a strict weak order, and is fast where events
  // are almost sorted.
  for (std::size_t k = 1; k < executed_.size(); ++k)
    for (std::size_t i = k;
         i > 0 && decide_.comes_before(executed_[i].effect.stamp, executed_[i - 1].effect.stamp);
         --i)
      std::swap(executed_[i], executed_[i - 1]);
  for (;;) {
    const Stamp frame{run_.next_frame(), kLastMicrostep, WorkKind::kRedraw, -1, -1};
    const bool has_frame = frame.time <= drawn_until_, has_impact = !executed_.empty();
    if (!has_frame && !has_impact) return;
    const bool is_frame =
        has_frame && (!has_impact || decide_.comes_before(frame, executed_.front().effect.stamp));
    const Stamp next = is_frame ? frame : executed_.front().effect.stamp;
    if (!decide_.may_commit(next, gvt_)) return;
    naming(fmt::format("with global virtual time at {:.9g} s", gvt_), [&] {
      if (is_frame)
        commit_frame();
      else
        commit_event();
    });
    committed_ = next;
  }
}

void TaughtTimewarp::commit_event() {
  const Executed& executed = executed_.front();
  const EventStamp key = executed.key;
  if (!executed.rolled_back.empty())
    throw StoppedRun(
        fmt::format("{} was about to be committed, but only some of its processes were rolled back "
                    "past it: the anti-message to the others is missing",
                    name(key)));
  const bool is_later =
      committed_.time < key.time ||
      (committed_.time == key.time && committed_.kind != WorkKind::kRedraw && committed_key_ < key);
  if (!is_later)
    throw StoppedRun(
        fmt::format("{} was about to be committed after an event at {:.9g} s: comes_before orders "
                    "them wrongly, or it came too late because global virtual time or may_commit "
                    "accepted what was not certain",
                    name(key), committed_.time));
  run_.watch_order(key, [&](int body) -> const Flight& {
    return world().can_move(body) ? process(body).before(key.time) : world().first_flight(body);
  });
  run_.count(executed.noted.get());
  if (executed.is_silent)
    run_.pass(key);
  else
    run_.commit(key, executed.first, executed.more);
  committed_key_ = key;
  executed_.erase(executed_.begin());
}

void TaughtTimewarp::commit_frame() {
  const double t = run_.next_frame();
  for (const int body : world().movers())
    if (process(body).at(t) == nullptr)
      throw StoppedRun(fmt::format(
          "the frame at t = {:.9g} s cannot be drawn: {} has no state that early. Likely: too many "
          "were purged (states_to_purge), or may_commit refused the frame too long",
          t, name(body)));
  run_.commit_frame([&](int body) -> const Flight& {
    return world().can_move(body) ? process(body).at(t)->flight : world().first_flight(body);
  });
}

void TaughtTimewarp::purge() {
  std::uint64_t kept = 0;
  for (const int body : world().movers()) {
    const std::size_t count = process(body).states().size();
    kept += count;
    if (count < kWorthPurging) continue;
    const std::size_t purged = decide_.states_to_purge(process(body).times(), gvt_);
    if (purged >= count)
      throw StoppedRun(fmt::format(
          "states_to_purge discards {} of the {} states of {}: none is left to continue from",
          purged, count, name(body)));
    if (purged == 0) continue;
    process(body).drop_oldest(purged);
    drop_pairs_of(body);
  }
  if (world().processes()) world().processes()->segments().forget_before(gvt_);
  run_.counters.states_kept = std::max(run_.counters.states_kept, kept);
}

}  // namespace tumble::engines
