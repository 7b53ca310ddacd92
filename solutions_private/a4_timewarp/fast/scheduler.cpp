#include "solutions_private/a4_timewarp/fast/scheduler.h"

#include <algorithm>
#include <cmath>

#include "framework/core/error.h"
#include "framework/engines/guarded_laws.h"
#include "solutions_private/a4_timewarp/fast/fast_timewarp.h"

namespace tumble::a4 {

FastTimewarp::FastTimewarp(const scene::Scene& scene, const Laws& laws, const engines::RunOptions& options, TrajectorySink& sink, VirtualTimes* record)
    : run_(scene, laws, options, sink), trial_(options.trial), random_(options.trial.seed), histories_(static_cast<std::size_t>(run_.world().size())),
      processes_(static_cast<std::size_t>(run_.world().size())), lengths_(lengths_for(run_.world())), pairs_(run_.world().size(), lengths_.cell), queue_(bin_for(run_.world(), lengths_.way, run_.duration())), record_(record) {
  const FlightWorld& world = run_.world();
  if (record_)
    for (const int i : world.movers()) record_->processes.push_back(world.world().bodies[i].name);
  for (const int i : world.movers()) histories_.push(i, world.first_flight(i));
  for (const int i : world.obstacles()) {
    processes_[i].horizon = kInfinity;
    if (world.is_half_space(i)) {
      planes_.push_back(i);
      continue;
    }
    // An obstacle goes its prescribed way: a straight line, and no farther off it than its amplitude.
    const scene::PrescribedMotion& m = world.world().bodies[i].motion;
    const Vector3d start = world.first_flight(i).com_world, end = start + m.velocity_m_s * run_.duration();
    const Vector3d reach = m.amplitude_m.cwiseAbs() + Vector3d::Constant(kSlack * world.radius(i));
    Box box = engines::box_around(world.shape(i), world.first_flight(i).world_from_body);
    pairs_.set_box(i, {start.cwiseMin(end) + box.low - reach, start.cwiseMax(end) + box.high + reach});
  }
}

void FastTimewarp::run() {
  std::string stopped_by;
  try {
    loop();
    check_nothing_leaked();
  } catch (const engines::StoppedRun& stop) {
    stopped_by = stop.what();
  }
  run_.counters.states_kept = histories_.most_kept() + (run_.world().processes() ? run_.world().processes()->passages().most_kept() : 0);
  run_.end(stopped_by);
}

// Every flight that began has been dropped, forgotten or is among the last: what is left of passages and changes without one would never
// have been freed.
void FastTimewarp::check_nothing_leaked() {
  for (const int body : run_.world().movers())
    for (std::size_t k = 0; k < histories_[body].size(); ++k) forget(histories_[body][k]);
  require(run_.world().all_processes().passages().alive() == 0 && changes_.alive() == 0, "no passage or change outlives its flights");
}

void FastTimewarp::loop() {
  std::vector<int> order = run_.world().movers();
  if (trial_.shuffle)
    for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random_.below(i)]);
  now_ = 0.0;
  called_.assign(run_.callbacks().size(), false);
  for (const EventKey& callback : run_.callbacks()) expect_callback(callback);
  for (const int body : order)
    if (first_member(body) == body) advance(body);
  now_ = kInfinity;
  while (!queue_.empty() && queue_.front().key.time <= run_.duration()) {
    if (trial_.rollback_every > 0 && ++worked_at_ % static_cast<std::uint64_t>(trial_.rollback_every) == 0) {
      const int body = order[random_.below(order.size())];
      const double back_to = std::max(global_virtual_time(), std::min(processes_[body].horizon, run_.duration()) - random_.between(0.0, trial_.rollback_s));
      if (back_to < processes_[body].horizon) {
        roll_back(body, histories_[body].at(back_to) + 1);
        set_horizon(body, back_to);
        schedule(first_member(body));
      }
    }
    const Due due = trial_.disorder_s > 0 ? next_legal() : queue_.pop();
    now_ = due.key.time;
    if (!queue_.empty()) fetch(queue_.front());
    work_at(due);
    now_ = kInfinity;
    const double gvt = queue_.empty() ? kInfinity : queue_.front().key.time;
    if (executed_.size() >= commit_at_ || run_.next_frame() < gvt) {
      commit_before(std::min(gvt, run_.duration()));
      commit_at_ = executed_.size() + kCommitAfter;
    }
  }
  commit_before(kInfinity);
}

// What the next event will look at is on its way from memory while this one is worked at: in scenes of many bodies that is half the time.
void FastTimewarp::fetch(const Due& due) const {
  for (const int body : {due.key.body_a, due.key.body_b}) {
    if (body < 0) continue;
    __builtin_prefetch(&processes_[static_cast<std::size_t>(body)]);
    histories_.fetch(body);
    pairs_.fetch(body);
  }
}

// Any event that is not too far ahead of global virtual time may be taken: which, is drawn by lot.
Due FastTimewarp::next_legal() {
  const double latest = queue_.front().key.time + trial_.disorder_s;
  std::vector<Due> taken;
  const std::uint64_t most = 1 + random_.below(256);
  while (taken.size() < most && !queue_.empty() && queue_.front().key.time <= latest && queue_.front().key.time <= run_.duration()) taken.push_back(queue_.pop());
  const std::size_t chosen = random_.below(taken.size());
  for (std::size_t k = 0; k < taken.size(); ++k)
    if (k != chosen) queue_.push(taken[k]);
  return taken[chosen];
}

void FastTimewarp::work_at(const Due& due) {
  if (due.key.kind == EventClass::kCallback) return call(due);
  if (due.key.kind != EventClass::kAdvance) return collide(due);
  Process& process = processes_[due.key.body_a];
  if (process.ticket != due.serial_a || first_member(due.key.body_a) != due.key.body_a) return;
  if (process.horizon >= run_.duration()) set_horizon(due.key.body_a, kInfinity);   // nothing is left to find
  else advance(due.key.body_a);
}

void run_fast_timewarp(const scene::Scene& scene, const Laws& laws, const engines::RunOptions& options, TrajectorySink& sink, VirtualTimes* record) {
  FastTimewarp(scene, laws, options, sink, record).run();
}

}  // namespace tumble::a4
