/// The logical processes of a run, by body: each from global virtual time to its local virtual
/// time. Bodies that cannot move have one flight and one box, and are ahead of all.
#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include "framework/dynamics/scheduling.h"
#include "framework/engines/events/flight_run.h"
#include "framework/engines/timewarp/taught_logical_process.h"

namespace tumble::engines {

class TaughtProcesses {
 public:
  TaughtProcesses(const FlightWorld& world, double duration);

  const FlightWorld& world() const { return world_; }
  /// @pre the body can move
  TaughtLogicalProcess& operator[](int body) { return processes_[static_cast<std::size_t>(body)]; }
  const TaughtLogicalProcess& operator[](int body) const {
    return processes_[static_cast<std::size_t>(body)];
  }
  double global_virtual_time() const { return gvt_; }  // [s]
  void raise_global_virtual_time(double gvt) { gvt_ = gvt; }

  double local_time(int body) const;
  std::vector<LocalTime> local_times() const;
  /// The state at t. @throws StoppedRun where it has been discarded
  const KeptState& state_at(int body, double t) const;
  /// The flight at local virtual time; at t; before t.
  const Flight& flight(int body) const;
  const Flight& flight_at(int body, double t) const;
  const Flight& flight_before(int body, double t) const;
  /// Swept from global to local virtual time.
  Box box(int body) const;
  /// These bodies and the members of their islands, ascending; without walls.
  std::vector<std::int32_t> moving_with(std::initializer_list<int> bodies) const;
  /// Of these bodies on their flights at t: the start of the first step that fails before t, where
  /// an impact that no check has found yet may end the flight before it. Once global virtual time
  /// is past that start, none can. [s]
  std::optional<double> open_failure(const std::vector<std::int32_t>& bodies, double t) const;

  /// The body goes on on another flight, which gets its version.
  void begin(BegunFlight& begun, const EventStamp& began);
  /// At the end of the run: its flights are part of it up to `until`. [s]
  void stand(double until) const;

  // For messages.
  std::string name(int body) const;
  std::string name(const EventStamp& key) const;

 private:
  const FlightWorld& world_;
  std::vector<TaughtLogicalProcess> processes_;  // by body; unused for walls
  std::vector<Box> boxes_;                       // by body; used for walls
  std::vector<std::uint32_t> next_version_;      // by body
  double gvt_ = 0.0;
};

}  // namespace tumble::engines
