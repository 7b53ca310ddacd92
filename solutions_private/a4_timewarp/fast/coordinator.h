/// Who works when: one thread alone, or several in rounds. Its parts: conductor.cpp goes round, homes.cpp says who looks after whom,
/// commits.cpp commits, trials.cpp rolls everything back on trial.
///
/// A round begins at global virtual time. Each worker takes the processes at home in its territory on, each as far as the window lets it,
/// optimistically: the bodies of the border stay behind. Then one thread alone takes what was left, and the border's own events, in order,
/// and whoever it meets in the past is rolled back. What is then before the end of the round is certain. So nothing depends on which thread
/// is faster: each looks at what the others did in rounds before, and at nothing that they do now.
#pragma once

#include <barrier>
#include <functional>
#include <memory>
#include <optional>

#include "framework/engines/timewarp/rollback_watch.h"
#include "solutions_private/a4_timewarp/fast/worker.h"

namespace tumble::a4 {

class Conductor {
 public:
  Conductor(const scene::Scene& scene, const Laws& laws, const engines::RunOptions& options, TrajectorySink& sink, VirtualTimes* record, const engines::RollbackWatch* watch);
  void run();

 private:
  // trials.cpp
  bool is_time_for_a_trial();
  void try_rollback(const std::function<void()>& take_a_step);

  // conductor.cpp
  void enter_obstacle(int body);
  void begin();
  void go_alone();
  Due in_place_of(const Due& callback);
  void go_in_rounds();
  double work_as(int thread, double end);
  void go_round(double& end_of_round, std::barrier<>& meet);
  void work_alone_before(double end);
  void work_alone_at(Due due);
  void collect_what_is_left();
  Domain* next_domain();
  double next_time();
  void adapt_window();
  void adapt_rounds();
  double first_window() const;
  void check_nothing_leaked();
  void end(const std::string& stopped_by);
  Worker& alone() { return *workers_[kBorder]; }

  // homes.cpp
  void settle();
  void cut_territories();
  void find_homes();
  void keep_processes_together();
  void move_home(int body, std::uint8_t home);
  void hand_out();

  // commits.cpp
  void require_certain(const EventKey& key) const;
  void commit_before(const EventKey& key);
  void commit_before(double t) { commit_before(EventKey{t, 0, EventClass::kLookAgain, -1, -1}); }   // a key before all others of that time
  void note_kept();
  bool still_stands(int body, std::uint32_t serial) const;

  Shared all_;
  std::vector<std::unique_ptr<Worker>> workers_;   // by domain
  VirtualTimes* record_;                           // null: nobody wants to know
  const engines::RollbackWatch* watch_;            // null: nobody tries
  int trials_ = 0;                                 // so far
  int since_trial_ = 0;                            // events, or rounds
  double last_trial_ = 0.0;                        // [s]
  std::size_t commit_at_;                          // events worked at before global virtual time is looked at again
  std::size_t since_commit_ = 0;                   // events
  std::optional<EventKey> working_at_;             // alone
  std::vector<std::uint8_t> wanted_;               // by body: home
  std::vector<int> leaders_;                       // by body: of processes that must have one home
  std::uint64_t rounds_ = 0, last_cut_ = 0;        // begun; the one before which territories were cut last
  double first_window_ = 0.0;                      // [s]
  std::uint64_t done_before_ = 0, undone_before_ = 0;   // integrations, when the window was looked at last
  std::int64_t most_kept_ = 0;
};

}  // namespace tumble::a4
