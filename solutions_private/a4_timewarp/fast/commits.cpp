// What is committed, and when. Part of Conductor.
#include <algorithm>

#include <fmt/format.h>

#include "framework/core/error.h"
#include "solutions_private/a4_timewarp/fast/conductor.h"

namespace tumble::a4 {

bool Conductor::still_stands(int body, std::uint32_t serial) const {
  return body < 0 || !all_.world().can_move(body) || all_.histories[body].find(serial) < all_.histories[body].size();
}

// What is committed stays: it lies before all that is still to come, and global virtual time never falls.
void Conductor::require_certain(const EventKey& key) const {
  if (key.time < all_.committed) throw PreconditionError(fmt::format("timewarp: global virtual time fell from {:.17g} s to {:.17g} s", all_.committed, key.time));
  for (const Domain& domain : all_.domains)
    if (!domain.queue.empty() && domain.queue.front().key.time <= all_.run.duration() && domain.queue.front().key < key)
      throw PreconditionError(fmt::format("timewarp: what lies before {:.17g} s is to be committed while an event at {:.17g} s is still to come", key.time, domain.queue.front().key.time));
}

// Everything before `key`, in order, and frames among it.
void Conductor::commit_before(const EventKey& key) {
  require_certain(key);
  std::vector<Executed>& executed = alone().executed;
  for (std::size_t k = 1; k < workers_.size(); ++k) {
    executed.insert(executed.end(), std::make_move_iterator(workers_[k]->executed.begin()), std::make_move_iterator(workers_[k]->executed.end()));
    workers_[k]->executed.clear();
  }
  const auto in_order = [](const Executed& x, const Executed& y) { return x.key < y.key; };
  if (!std::is_sorted(executed.begin(), executed.end(), in_order)) std::sort(executed.begin(), executed.end(), in_order);
  const auto draw_before = [&](double until) {
    while (all_.run.next_frame() < until) {
      const double time = all_.run.next_frame();
      all_.run.commit_frame([&](int body) -> const Flight& { return all_.world().can_move(body) ? all_.histories[body][all_.histories[body].at(time)] : all_.immovable(body); });
    }
  };
  std::size_t done = 0;
  for (; done < executed.size() && executed[done].key < key; ++done) {
    const Executed& event = executed[done];
    if (!still_stands(event.key.body_a, event.serial_a) || !still_stands(event.key.body_b, event.serial_b)) continue;   // taken back
    draw_before(event.key.time);
    if (event.is_silent) all_.run.pass(event.key);
    else all_.run.commit(event.key, event.first, event.more);
  }
  executed.erase(executed.begin(), executed.begin() + static_cast<std::ptrdiff_t>(done));
  draw_before(key.time);
  note_kept();
  all_.committed = std::min(key.time, all_.run.duration());
  if (all_.world().processes()) all_.world().processes()->passages().forget_before(all_.committed);
}

void Conductor::note_kept() {
  std::int64_t kept = 0;
  for (const auto& worker : workers_) kept += worker->kept;
  if (workers_.size() == 1) kept = alone().most_kept;
  most_kept_ = std::max(most_kept_, kept + static_cast<std::int64_t>(all_.world().all_processes().passages().kept()));
}

}  // namespace tumble::a4
