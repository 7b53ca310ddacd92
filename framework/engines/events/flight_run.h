/// What every event-ordered engine shares: the world on flights, the check of an interval, what an impact does, and the one place
/// where events and frames are committed, in order.
#pragma once

#include "framework/engines/events/flight_frames.h"
#include "framework/engines/events/impacts_of_flights.h"
#include "framework/engines/events/link_measures.h"
#include "framework/engines/events/meeting_of_flights.h"
#include "framework/engines/base/run_options.h"
#include "framework/engines/base/run_counters.h"
#include "framework/engines/stepping/stability.h"

namespace tumble::engines {

class FlightRun {
 public:
  /// @throws UserError where the scene has what no flight follows
  FlightRun(const scene::Scene& scene, const Laws& laws, const RunOptions& options, TrajectorySink& sink);
  FlightRun(const FlightRun&) = delete;
  FlightRun& operator=(const FlightRun&) = delete;

  const FlightWorld& world() const { return world_; }
  const ImpactsOfFlights& impacts() const { return impacts_; }
  /// From now on several threads ask about flights, and what impacts do to them, or one alone again.
  void share(bool shared) { world_.share(shared); }
  double duration() const { return duration_; }
  /// The engine's largest step: how far a scheduler looks ahead at most where it has no reason of its own. [s]
  double step() const { return step_; }

  /// What the impact of two flights does. Stops the run (StoppedRun, with time and names) where the laws fail.
  /// @post where processes took part (`begun` is not empty) all their members' flights end here
  /// @param counters  of the thread that asks
  Meeting meet(const EventKey& key, const Flight& f, const Flight& g, RunCounters& counters) const;
  Meeting meet(const EventKey& key, const Flight& f, const Flight& g) { return meet(key, f, g, counters); }
  /// When a body's flight ends by itself, if that is at `to` or before; nothing otherwise, and for all but a process's first member.
  std::optional<EventKey> own_end(int body, const Flight& flight, double to) const;
  /// What that does.
  Meeting end_of_passage(const EventKey& key, const Flight& flight) const;

  /// Callbacks of the run, by their keys, in order.
  const std::vector<EventKey>& callbacks() const { return callback_keys_; }
  const std::vector<int>& receivers(const EventKey& callback) const { return callbacks_[callback.generation].bodies; }
  /// What a callback does. @param flight_of  the flights that its bodies are on when it acts
  Meeting call(const EventKey& callback, const FlightOf& flight_of);
  /// @throws StoppedRun naming body, time and callback where it fails or leaves no numbers

  /// Commits an impact. @pre keys come in order
  void commit(const EventKey& key, const Event& first, const std::vector<Event>& more);
  void commit(const Meeting& meeting);
  /// Commits a change of membership that nothing is said of. @pre keys come in order
  void pass(const EventKey& key);
  /// The next frame that is not committed yet; infinite when there is none. [s]
  double next_frame() const { return frame_time(next_) <= duration_ ? frame_time(next_) : std::numeric_limits<double>::infinity(); }
  /// Commits the frame at next_frame(). @pre every event before it is committed, none after it
  /// @throws StoppedRun where energy has run away by then; the frame is recorded
  void commit_frame(const FlightOf& flight_of);

  /// Ends the run: frames that are left are pushed by the caller before. `stopped_by` is empty where all is well.
  void end(const std::string& stopped_by);

  CheckCost cost;
  RunCounters counters;

 private:
  Meeting meet_as_processes(const EventKey& key, const Flight& f, const Flight& g, RunCounters& counters) const;
  void require_progress(const EventKey& key, const Event& event);
  void commit_switches(double until);
  double frame_time(long k) const { return static_cast<double>(k) / rate_; }
  std::string name(int body) const { return body < 0 ? "itself" : "'" + world_.world().bodies[body].name + "'"; }

  const Laws laws_;   // guarded
  double step_, duration_, rate_;
  double step_of_impacts_ = -1.0;   // of the grid: the one that the last impact fell into
  long impacts_in_step_ = 0;
  FlightWorld world_;
  ImpactsOfFlights impacts_;
  MeetingOfFlights meetings_;
  TrajectorySink& sink_;
  EventKey last_{-1.0, 0, EventClass::kCollision, -1, -1};
  long next_ = 0;
  std::vector<Event> switches_;    // of point forces, in order of time; known from the start
  std::size_t switched_ = 0;
  std::unique_ptr<LinkMeasures> links_;
  std::vector<RigidBodyState> states_;   // of the frame that was committed last
  void tell_membership(double t, const FlightOf& flight_of) const;

  std::function<void(const Membership&)> on_membership_;
  std::vector<Callback> callbacks_;
  std::vector<EventKey> callback_keys_;
  EnergyWatch energy_watch_;
};

}  // namespace tumble::engines
