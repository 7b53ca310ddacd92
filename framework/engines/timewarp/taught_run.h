/// The teaching timewarp as one thing with its parts: taught_timewarp.cpp goes round and checks, taught_events.cpp does what happens,
/// taught_rollback.cpp takes back and commits.
#pragma once

#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "framework/engines/events/flight_run.h"
#include "framework/engines/base/guarded_laws.h"
#include "framework/engines/timewarp/taught_groups.h"
#include "framework/engines/timewarp/taught_process.h"
#include "framework/engines/timewarp/taught_queue.h"
#include "framework/engines/timewarp/taught_search.h"
#include "framework/engines/timewarp/trace_watch.h"

namespace tumble::engines {

constexpr std::size_t kMostTaughtMoves = 50000;   // of virtual times kept for the chart

/// Something that was worked at, until it is committed or taken back.
struct Executed {
  Effect effect;
  EventKey key;
  Event first;
  std::vector<Event> more;
  bool is_silent;               // nothing is said of it
  std::set<int> taken_back{};   // by which of its processes
};

class TaughtTimewarp {
 public:
  TaughtTimewarp(const scene::Scene& scene, const Laws& laws, const RunOptions& options, TrajectorySink& sink, const Trajectory& reference);
  void run();

 private:
  const FlightWorld& world() const { return run_.world(); }
  TaughtProcess& process(int body) { return processes_[static_cast<std::size_t>(body)]; }
  const Flight& flight_of(int body) { return world().can_move(body) ? process(body).flight() : world().first_flight(body); }
  double local_time(int body) { return world().can_move(body) ? process(body).local_time() : std::numeric_limits<double>::infinity(); }
  std::string name(const EventKey& key) const;
  Box box(int body) { return world().can_move(body) ? process(body).swept() : boxes_[static_cast<std::size_t>(body)]; }
  std::string name(int body) const { return body < 0 || body >= world().size() ? fmt::format("body {}", body) : "'" + world().world().bodies[static_cast<std::size_t>(body)].name + "'"; }

  void loop();
  void work_at(int id);
  void redraw(int id);
  const KeptState& state_at(int body, double t);
  void check(int id);
  void collide(int id, const FoundImpact& found, const CheckDecision& decision);
  void check_group(int id);
  void call(int id);
  void go_to(int body, double t, std::optional<std::uint32_t> serial, const std::string& why);
  void begin_flights(const Meeting& meeting, double safe_time, double time);
  void ask_for_groups(const std::vector<BegunFlight>& begun);
  void keep_group_checks(double safe_time = kUnset, double time = kUnset);
  void expect_callback(const EventKey& key);
  std::vector<LocalTime> local_times() const;

  // The end of the run is a time to look, too: nothing in it goes unseen because the next look is due behind it.
  double due(const ScheduledEvent& check) const { return check.safe_time < run_.duration() ? std::min(check.stamp.time, run_.duration()) : check.stamp.time; }
  void put_check(int id, ScheduledEvent check) {
    check.stamp.time = due(check);
    queue_.put(id, check);
  }

  // By whole steps, past t where they do not fit: an optimist.
  void integrate(int body, double t) {
    while (process(body).local_time() < t) step_to(body, process(body).local_time() + run_.step());
  }
  void step_to(int body, double to);
  void find_pairs(int body, double from);
  void drop_pairs_of(int body);

  void roll_back(const std::vector<Rollback>& first, const std::string& why);
  void roll_back_one(const Rollback& rollback, const std::string& why);

  void look_at_gvt(bool is_over);
  void check_nothing_leaked();
  void commit();
  void commit_event();
  void commit_frame();
  void purge();
  void move(int body, double from, double to) {
    if (times_.moves.size() < kMostTaughtMoves) times_.moves.push_back({place_[static_cast<std::size_t>(body)], from, to, gvt_});
  }

  TraceWatch watch_;
  FlightRun run_;
  TrajectorySink& sink_;
  Scheduling decide_;
  double rate_;
  std::vector<TaughtProcess> processes_;      // by body; those of walls are not used
  std::vector<Box> boxes_;                    // by body; of walls
  std::vector<int> place_;                    // by body: among the processes
  std::vector<std::uint32_t> next_serial_ = std::vector<std::uint32_t>(static_cast<std::size_t>(world().size()), 1);
  TaughtQueue queue_;
  std::map<std::pair<int, int>, int> pairs_;  // whose boxes overlap, to their check
  std::map<int, int> groups_;                 // passages that somebody is on now and that may end by themselves, to their check
  std::vector<Executed> executed_;
  VirtualTimes times_;
  double gvt_ = 0.0;                          // global virtual time [s]
  Stamp committed_{-1.0, 0, WorkKind::kCallback, -1, -1};            // the last that was, frame or event
  EventKey committed_key_{-1.0, 0, EventClass::kCallback, -1, -1};   // the last event that was
  double drawn_until_ = -1.0;                 // redraws up to this were at the front [s]
  long next_redraw_ = 0;
  std::size_t since_gvt_ = 0, since_asked_ = 0;   // events
};

}  // namespace tumble::engines
