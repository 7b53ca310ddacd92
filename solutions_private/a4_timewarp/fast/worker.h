/// One thread of the fast scheduler: takes processes on, does what happens to them, takes it back. Its parts: worker_advance.cpp and
/// worker_events.cpp. Which thread works when is conductor.cpp's.
///
/// A worker at home in a territory touches only bodies that are at home there, and looks at those of the border. Whatever else an event
/// asks for it leaves: events, anti-messages, processes that would go beyond the territory. The worker of the border works alone, at
/// whatever there is.
#pragma once

#include <exception>
#include <utility>
#include <vector>

#include "framework/core/numbers.h"
#include "framework/core/random.h"
#include "solutions_private/a4_timewarp/fast/shared.h"

namespace tumble::a4 {

class alignas(64) Worker {
 public:
  Worker(Shared& all, std::size_t home) : all_(all), home_(home), random_(all.trial.seed + home) {}

  /// What happens before `end`, in order, in this worker's territory.
  /// @return `end`; of one thread less where a body has done very much since: to there it has worked, and the round may end
  double work_before(double end);
  /// One event, taken from a queue. @throws StoppedRun
  void work_at(const Due& due);
  /// Whether nobody whom the event concerns would then have more states than are allowed.
  bool has_room(const Due& due);
  /// Lets go of what they did before what is committed.
  void purge(const Due& due);
  /// A process that goes on for the first time.
  void begin(int body) { advance(body); }
  void expect_callback(const EventKey& key);
  /// Drops the flights of a body from that with this serial on, and what they did to others.
  void take_back(int body, std::uint32_t serial);
  /// Begins to bring what an event will look at from memory.
  void fetch(const Due& due) const;
  /// Whether an event in a queue is to come, and not stale.
  bool is_to_come(const Due& due);
  /// A test's: rolls a body back by up to the trial's time.
  void disturb();
  /// A test's: as if the body had never gone beyond t. @pre t is not before what is committed
  void go_back(int body, double t);
  /// Which event is next: a test's lot decides, among those that may be.
  Due next_legal(double last);

  /// What it could not do itself.
  struct Left {
    std::vector<Due> due;
    std::vector<std::pair<int, std::uint32_t>> anti_messages;   // body, and serial of its flight that must be dropped
    std::vector<EventKey> recalls;                              // callbacks that must be called again
    std::exception_ptr out_of_time;                             // it has stopped, and so must all
  };
  Left left;
  std::vector<Executed> executed;
  std::vector<VirtualTimes::Move> moves;
  engines::RunCounters counters;
  engines::CheckCost cost;
  std::size_t longest = 0;                // history of a body since work_before began: states
  std::int64_t kept = 0, most_kept = 0;   // flights; of one worker the difference that it made
  double burden = 0.0;                    // of all together, since territories were cut
  double cpu_seconds = 0.0;               // of work_before
  std::uint64_t worked_at = 0;            // events, in work_before
  double now = kInfinity;                 // of the event that is worked at: it is in the queue no more, but not done [s]

 private:
  bool is_alone() const { return home_ == kBorder; }
  const FlightWorld& world() const { return all_.world(); }
  Process& process(int body) { return all_.processes[static_cast<std::size_t>(body)]; }
  const FlightHistory& history(int body) const { return all_.histories[body]; }
  bool is_mine(int body) const { return is_alone() || all_.home[static_cast<std::size_t>(body)] == home_; }

  void advance(int body);
  void advance_or_leave(int body);
  void advance_member(int body, const Flight& flight, double from, double to, const Box& box);
  void push(const Due& due, std::size_t home);
  bool may_enter(const Box& box) const;
  bool has_only_flown(int body) const;
  void enter_box(int body, const Box& box);
  template <class Found>
  void for_each_partner(int body, const Box& box, const Found& found) const;
  template <class Found>
  void for_each_in(std::size_t home, const Box& box, const Found& found) const;
  template <class Found>
  void for_each_elsewhere(std::size_t home, const Box& box, const Found& found) const;
  bool meets_nobody(int body, const Flight& flight, double from, double to) const;
  void find_obstacles(int body, const Flight& flight, double from, double to);
  void check(int body, const Flight& flight, double from, double to, int other);
  void offer(int body, const Flight& flight, int other, const Flight& its, double time, const Flight* its_next);
  double horizon_after(int body, const Flight& flight, double t) const;
  Box swept_box(int body, double from, double to) const;
  void move(int body, double t);
  void set_horizon(int body, double t);
  void shrink_box(int body);
  void schedule(int body, std::size_t home);
  void schedule(int body) { schedule(body, all_.home[static_cast<std::size_t>(body)]); }
  void look_again(int body, std::size_t home);
  void look_again(int body) { look_again(body, all_.home[static_cast<std::size_t>(body)]); }
  double global_virtual_time() const;

  void collide(const Due& due);
  void note_whose_territory(const Due& due);
  bool look_up(const Due& due, int side, std::size_t& place);
  void call(const Due& due);
  void begin_flights(const Due& due, engines::Meeting meeting);
  void begin_flight(int body, Flight flight, std::uint32_t serial);
  void purge(int body);
  void forget(const Flight& flight);
  void roll_back(int body, std::size_t keep);
  void unsend(int body, std::uint32_t serial);
  void recall(const EventKey& key);
  void delay();
  void leave(const Due& due);

  Shared& all_;
  const std::size_t home_;
  Random random_;
  std::vector<std::pair<int, std::size_t>> to_drop_;   // of roll_back, kept for its memory
  template <class Work>
  void for_each_member(const Due& due, const Work& work);

  std::vector<Due> found_;                             // of advance
  std::vector<Box> boxes_;                             // of advance: by member
  std::uint64_t since_disturbed_ = 0;
};

}  // namespace tumble::a4
