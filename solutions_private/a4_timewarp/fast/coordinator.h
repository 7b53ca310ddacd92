/// The order of execution: one thread alone, or several in epochs. Its parts: coordinator.cpp has
/// the beginning, the end and the loop of one thread, epochs.cpp that of several, ownership.cpp
/// assigns bodies to threads, commits.cpp commits, fault_injection.cpp rolls everything back for
/// tests.
///
/// An epoch begins at global virtual time. In its first pass each worker advances the processes
/// that lie in its territory, optimistically, each as far as the optimism window allows; bodies of
/// the boundary do not advance. The second pass has territories across those of the first: most
/// bodies of the first boundary lie in them, and advance as far, with what was deferred; they roll
/// back the bodies that they affect in their past. Then one thread alone executes what is left, in
/// order. Everything before the end of the epoch is then certain. So nothing depends on the speed
/// of threads: a thread reads what others did in earlier passes, and nothing that they do
/// concurrently.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "framework/engines/timewarp/rollback_check.h"
#include "solutions_private/a4_timewarp/fast/worker.h"

namespace tumble::a4 {

// With several threads an epoch is this part of the window: at its end processes have completed
// their advances, not been cut short. The longer one is for runs in which hardly anything is
// undone: work evens out, and threads wait less often. Elsewhere boxes grow, and more pairs are
// checked.
constexpr double kRound = 0.25, kLongRound = 0.5;

class Coordinator {
 public:
  Coordinator(const scene::Scene& scene, const Laws& laws, const engines::RunOptions& options,
              TrajectorySink& sink, VirtualTimes* record, const engines::RollbackCheck* watch);
  void run();

 private:
  // fault_injection.cpp
  bool is_injection_due();
  void inject_rollback(const std::function<void()>& take_a_step);

  // coordinator.cpp
  void add_domains();
  void enter_obstacle(int body);
  void begin();
  void run_alone();
  Due in_place_of(const Due& callback);
  void work_alone_at(Due due);
  Due first_before(const Due& due);
  bool is_stale_fault(const Due& due);
  Domain* next_domain();
  double next_time();
  void adapt_optimism_window();
  void adapt_epochs();
  double first_optimism_window() const;
  void check_nothing_leaked();
  void end(const std::string& stopped_by);
  Worker& alone() { return *workers_.front(); }

  // epochs.cpp
  int passes() const { return all_.regions == 1 ? 0 : all_.slabs == 0 ? 1 : 2; }
  // Calls `work` with each worker that the thread is in a pass, in order.
  template <class Work>
  void for_each_worker(int pass, int thread, const Work& work) const {
    const int first = pass == 0 ? 0 : all_.regions, count = pass == 0 ? all_.regions : all_.slabs;
    for (int k = thread; k < count; k += all_.threads)
      work(*workers_[static_cast<std::size_t>(1 + first + k)]);
  }
  struct Pass;
  void run_in_epochs();
  double work_as(int thread, const Pass& pass) const;
  void run_epoch(Pass& now);
  double run_pass(Pass& now);
  bool is_worth_a_pass() const;
  void work_alone_before(double end);
  void collect_deferred();
  void collect_moves(Worker& worker);

  // ownership.cpp
  void settle();
  double unevenness() const;
  void repartition();
  std::uint8_t territory_that_holds(std::size_t pass, const Box& box) const;
  void find_sites();
  void keep_processes_together();
  void change_site(int body, const Site& site);
  void hand_out();

  // commits.cpp
  void require_certain(const EventStamp& key) const;
  void commit_before(const EventStamp& key);
  // a stamp before all others of that time
  void commit_before(double t) { commit_before(EventStamp{t, 0, StampKind::kRecheck, -1, -1}); }
  void hand_over_moves();
  void stand(double until);
  void note_kept();
  bool is_current(int body, std::uint32_t version) const;
  bool is_rolled_back(const Executed& event) const;
  static std::uint64_t anti_messages_of(const Executed& rolled_back);

  Shared all_;
  // the one that runs alone, those of the first pass, those of the second
  std::vector<std::unique_ptr<Worker>> workers_;
  Box obstacles_;                        // around all of them, but half-spaces
  VirtualTimes* record_;                 // null: no record is wanted
  const engines::RollbackCheck* watch_;  // null: no fault injection
  int injections_ = 0;                   // so far
  int since_injection_ = 0;              // events, or epochs
  double last_injection_ = 0.0;          // [s]
  // executed events between computations of global virtual time
  std::size_t commit_at_;
  std::size_t since_commit_ = 0;          // events
  std::optional<EventStamp> working_at_;  // by one thread alone
  std::vector<Site> wanted_site_;         // by body: the new site
  std::vector<int> leaders_;              // by body: of processes that must have one site
  // started; the epoch before which regions were last cut
  std::uint64_t epochs_ = 0, last_partition_ = 0;
  double first_optimism_window_ = 0.0;  // [s]
  double round_ = kRound;               // with several threads: of the window is an epoch
  // integrations, at the last adaptation of the window
  std::uint64_t done_before_ = 0, undone_before_ = 0;
  std::int64_t most_kept_ = 0;
};

}  // namespace tumble::a4
