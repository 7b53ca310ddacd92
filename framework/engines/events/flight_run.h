/// The base of all event-driven engines: the world on flights, the search of an interval for
/// impacts, the response to an impact, and the only place that commits events and frames, in order.
#pragma once

#include <algorithm>

#include "framework/core/numbers.h"
#include "framework/engines/events/flight_frames.h"
#include "framework/engines/events/flight_impact_detection.h"
#include "framework/engines/events/link_measures.h"
#include "framework/engines/events/flight_impact_response.h"
#include "framework/engines/events/tied_impacts.h"
#include "framework/engines/base/frame_times.h"
#include "framework/engines/base/run_options.h"
#include "framework/engines/base/run_counters.h"
#include "framework/engines/base/tolerances.h"
#include "framework/engines/stepping/energy_watch.h"

namespace tumble::engines {

class FlightRun {
 public:
  /// @throws UserError where the scene has an effect that flights do not model
  FlightRun(const scene::Scene& scene, const Laws& laws, const RunOptions& options,
            TrajectorySink& sink);
  FlightRun(const FlightRun&) = delete;
  FlightRun& operator=(const FlightRun&) = delete;

  const FlightWorld& world() const { return world_; }
  const FlightImpactDetection& impacts() const { return impacts_; }
  /// true: several threads query flights and impact responses from now on; false: one thread again.
  void share(bool shared) { world_.share(shared); }
  double duration() const { return duration_; }
  /// The engine's largest step: the largest lookahead of a scheduler that has no other reason for
  /// one. [s]
  double step() const { return step_; }
  /// Whether t is the end of the run, but for rounding.
  bool is_at_end(double t) const { return engines::is_at_end(t, duration_, step_); }

  /// The response to the impact of two flights. Stops the run (StoppedRun, with time and names)
  /// where the laws fail.
  /// @post with processes among the bodies (`begun` is not empty), the flights of all their members
  ///   end here
  /// @param counters  of the calling thread
  Discontinuity resolve_impact(const EventStamp& key, const Flight& f, const Flight& g,
                               RunCounters& counters) const;
  Discontinuity resolve_impact(const EventStamp& key, const Flight& f, const Flight& g) {
    return resolve_impact(key, f, g, counters);
  }
  /// The time at which a body's flight ends by itself or cannot go on (kFault), if that is at `to`
  /// or before; nothing otherwise, and nothing for members of a process other than the first. A
  /// step that begins at the end of the run, but for rounding, or beyond is no part of it: its
  /// failure does not count.
  std::optional<EventStamp> own_end(int body, const Flight& flight, double to) const;
  /// The discontinuity at that time. The failure of a step is raised here: a caller executes kFault
  /// only where nothing before it is left to do, since any of that may end the flight.
  /// @throws what the step threw, of a kFault
  Discontinuity end_of_segment(const EventStamp& key, const Flight& flight) const;

  /// Callbacks of the run by their stamps, in order.
  const std::vector<EventStamp>& callbacks() const { return callback_keys_; }
  const std::vector<int>& receivers(const EventStamp& callback) const {
    return callbacks_[callback.microstep].bodies;
  }
  /// Executes a callback. @param flight_of  the flights of its bodies at its time
  /// @throws StoppedRun with body, time and callback where it fails or leaves numbers that are not
  ///   finite
  Discontinuity call(const EventStamp& callback, const FlightOf& flight_of);

  /// Looks at what is about to be committed: whether the order of impacts at its instant decides.
  /// @param before  the flights of all bodies before that instant
  void watch_order(const EventStamp& key, const FlightOf& before) {
    tied_impacts_.look(key, before, counters.watch);
  }
  /// Commits an impact. @pre keys come in order
  void commit(const EventStamp& key, const Event& first, const std::vector<Event>& more);
  void commit(const Discontinuity& discontinuity);
  /// What a committed event has noted counts; null: nothing.
  void count(const RunWatch* noted);
  /// Commits a change of islands without an event. @pre keys come in order
  void pass(const EventStamp& key);
  /// The next frame that is not committed yet; infinite when there is none. [s]
  double next_frame() const { return frame_times_.next(); }
  /// Commits the frame at next_frame(). @pre every event before it is committed, none after it
  /// @throws StoppedRun where it cannot be drawn, because a law fails; and where energy has run
  ///   away by then: the frame is recorded
  void commit_frame(const FlightOf& flight_of);
  /// Commits the frame of a fault's own instant, but for rounding, if there is one: the fault comes
  /// after all else of it. Where that frame cannot be drawn it is left out, because the fault says
  /// more. Where a response fails there is none: nothing is known after the impact.
  /// @pre the fault is the next event of all, and every frame before its instant is committed
  void commit_frame_at(const EventStamp& fault, const FlightOf& flight_of);

  /// The time up to which what was computed is part of the run: its end; where it has stopped, the
  /// event or the frame that stopped it as it was committed, or else `at`, where the engine is. [s]
  double stands_until(const std::string& stopped_by, double at) const {
    if (stopped_by.empty()) return duration_;
    return std::min(duration_, stopped_at_ < kInfinity ? stopped_at_ : at);
  }
  /// Ends the run: frames that are left are pushed by the caller before, and flights that are still
  /// held stand as far as stands_until. `stopped_by` is empty where all is well.
  void end(const std::string& stopped_by);

  CheckCost cost;
  RunCounters counters;

 private:
  Discontinuity resolve_process_impact(const EventStamp& key, const Flight& f, const Flight& g,
                                       RunCounters& counters) const;
  void require_progress(const EventStamp& key, const Event& event);
  void commit_switches(double until);
  void draw_frame(const FlightOf& flight_of);
  std::string name(int body) const {
    return body < 0 ? "itself" : "'" + world_.world().bodies[body].name + "'";
  }

  const Laws laws_;  // guarded
  double step_, duration_;
  FrameTimes frame_times_;
  double stopped_at_ = kInfinity;  // where something that is committed stops the run [s]
  double step_of_impacts_ = -1.0;  // of the grid: the one that the last impact fell into
  long impacts_in_step_ = 0;
  FlightWorld world_;
  FlightImpactDetection impacts_;
  FlightImpactResponse meetings_;
  TiedImpacts tied_impacts_;
  TrajectorySink& sink_;
  EventStamp last_{-1.0, 0, StampKind::kCollision, -1, -1};
  std::vector<Event> switches_;  // of point forces, in order of time; known from the start
  std::size_t switched_ = 0;
  std::unique_ptr<LinkMeasures> links_;
  std::vector<RigidBodyState> states_;  // of the frame that was committed last
  void report_membership(double t, const FlightOf& flight_of) const;
  void note_overlaps(const Frame& frame);
  void note_islands_in_contact(const FlightOf& flight_of);
  bool pass_steps_of(int body, double time, const FlightOf& flight_of);

  std::function<void(const Membership&)> on_membership_;
  std::vector<Callback> callbacks_;
  std::vector<EventStamp> callback_keys_;
  EnergyWatch energy_watch_;
};

}  // namespace tumble::engines
