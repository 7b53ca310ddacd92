// The loop of several threads, and of one with several regions. Part of Coordinator.
#include <algorithm>
#include <barrier>
#include <system_error>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "framework/core/cpu_time.h"
#include "framework/core/error.h"
#include "solutions_private/a4_timewarp/fast/coordinator.h"

namespace tumble::a4 {
namespace {

// with one thread and several regions: longer epochs check more pairs, shorter ones switch between
// regions more often
constexpr double kEpochAlone = 0.125;
// events that wait in the first pass's boundary, per body
constexpr double kWorthAPass = 0.04;

}  // namespace

/// What threads do between two barriers. Written while one of them runs.
struct Coordinator::Pass {
  std::barrier<> both_ends;
  int number = 0;
  double end = 0.0;  // of the epoch [s]
  bool is_over = false;
};

void Coordinator::run_in_epochs() {
  all_.optimism_window = first_optimism_window_;
  Pass now{std::barrier<>(all_.threads)};
  std::vector<std::jthread> threads;
  // An exception in this thread ends the others.
  struct Release {
    Pass& now;
    ~Release() {
      now.is_over = true;
      now.both_ends.arrive_and_wait();
    }
  };
  threads.reserve(static_cast<std::size_t>(all_.threads));
  // gone before the threads are: they are joined after it has ended them
  const Release release{now};
  try {
    for (int thread = 1; thread < all_.threads; ++thread)
      threads.emplace_back([&, thread] {
        for (;;) {
          now.both_ends.arrive_and_wait();
          if (now.is_over) return;
          work_as(thread, now);
          now.both_ends.arrive_and_wait();
        }
      });
  } catch (const std::system_error&) {
    const int made = 1 + static_cast<int>(threads.size());
    // those that are there wait for all: for the missing ones, too
    for (int missing = made; missing < all_.threads; ++missing) now.both_ends.arrive_and_drop();
    throw UserError("--threads " + std::to_string(all_.threads),
                    fmt::format("the system gives only {} of them", made), "Give fewer.");
  }
  while (next_time() <= all_.run.duration()) {
    if (is_injection_due()) inject_rollback([&] { run_epoch(now); });
    run_epoch(now);
    const double began = thread_seconds();
    commit_before(std::min(next_time(), all_.run.duration()));
    adapt_optimism_window();
    alone().counters.alone_seconds += thread_seconds() - began;
  }
}

void Coordinator::run_epoch(Pass& now) {
  all_.global_virtual_time = next_time();
  now.end =
      all_.global_virtual_time + (all_.threads > 1 ? round_ : kEpochAlone) * all_.optimism_window;
  const double began = thread_seconds();
  settle();
  double alone_seconds = thread_seconds() - began;
  double reached = now.end;
  for (now.number = 0; now.number < passes(); ++now.number) {
    if (now.number > 0 && !is_worth_a_pass()) break;
    reached = run_pass(now);
    const double worked = thread_seconds();
    alone().is_between_passes = true;
    collect_deferred();
    alone().is_between_passes = false;
    alone_seconds += thread_seconds() - worked;
  }
  const double worked = thread_seconds();
  work_alone_before(reached);
  ++alone().counters.rounds;
  alone().counters.alone_seconds += alone_seconds + thread_seconds() - worked;
}

// @return the time that all threads have reached: with several of them the end of the epoch
double Coordinator::run_pass(Pass& now) {
  all_.run.share(all_.threads > 1);
  now.both_ends.arrive_and_wait();
  const double reached = work_as(0, now);
  now.both_ends.arrive_and_wait();
  all_.run.share(false);
  for (const auto& worker : workers_)
    if (worker->deferred.out_of_time) std::rethrow_exception(worker->deferred.out_of_time);
  double busiest = 0.0;
  for (int thread = 0; thread < all_.threads; ++thread) {
    double its = 0.0;
    for_each_worker(now.number, thread,
                    [&](Worker& worker) { its += std::exchange(worker.cpu_seconds, 0.0); });
    busiest = std::max(busiest, its);
  }
  alone().counters.together_seconds += busiest;
  return reached;
}

// Whether the first pass has left enough for all threads together: a pass has two more barriers,
// and for a few bodies one thread alone is as quick.
bool Coordinator::is_worth_a_pass() const {
  std::size_t waiting = 0;
  for (std::size_t k = 1; k < all_.domains.size(); ++k)
    if (all_.domains[k].site.territory[0] == kBoundary) waiting += all_.domains[k].queue.size();
  return static_cast<double>(waiting) >
         kWorthAPass * static_cast<double>(all_.world().movers().size());
}

// Threads take the regions in turn, each to the end of the epoch, so that a region's data stays in
// the caches meanwhile.
// @return the time that all of them have reached
double Coordinator::work_as(int thread, const Pass& pass) const {
  double end = pass.end;
  for_each_worker(pass.number, thread, [&](Worker& worker) { end = worker.work_before(end); });
  return end;
}

// As many as there is room for.
void Coordinator::collect_moves(Worker& worker) {
  const std::size_t taken =
      std::min(worker.moves.size(), engines::kMostMoves - alone().moves.size());
  const auto end = worker.moves.begin() + static_cast<std::ptrdiff_t>(taken);
  alone().moves.insert(alone().moves.end(), worker.moves.begin(), end);
  if (worker.has_more_moves || end != worker.moves.end()) alone().has_more_moves = true;
  worker.moves.clear();
}

// From now on the workers of the next pass, or the one that runs alone, may execute it.
void Coordinator::collect_deferred() {
  for (std::size_t k = 1; k < workers_.size(); ++k) {
    collect_moves(*workers_[k]);
    Worker::Deferred& deferred = workers_[k]->deferred;
    for (const auto& [due, site] : deferred.due)
      all_.domains[all_.domain_of(common(site, all_.site_of(due.key)))].queue.push(due);
    for (const EventStamp& callback : deferred.cancelled_callbacks)
      if (all_.called[callback.microstep]) alone().expect_callback(callback);
    deferred.due.clear();
    deferred.cancelled_callbacks.clear();
  }
  for (std::size_t k = 1; k < workers_.size(); ++k) {
    for (const auto& [body, version] : workers_[k]->deferred.anti_messages)
      alone().roll_back_from(body, version);
    workers_[k]->deferred.anti_messages.clear();
  }
}

void Coordinator::work_alone_before(double end) {
  for (Domain* next = next_domain(); next && next->queue.front().key.time < end &&
                                     next->queue.front().key.time <= all_.run.duration();
       next = next_domain())
    work_alone_at(next->queue.pop());
}

}  // namespace tumble::a4
