/// The state of the fast scheduler: processes, executed and pending events, and the thread that
/// owns each body.
///
/// Every movable body has an owner. Bodies whose swept boxes lie in one thread's region are owned
/// by that region: no other thread touches them while threads run. The other bodies belong to the
/// boundary: threads read them and change nothing about them, until one thread runs alone. With one
/// region every body belongs to the boundary, and its thread always runs alone. For very many
/// bodies there are more regions than threads, so that the working set of an epoch fits a thread's
/// caches (partition.h).
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "framework/core/numbers.h"
#include "framework/engines/events/flight_run.h"
#include "framework/engines/timewarp/active_pairs.h"
#include "framework/engines/timewarp/event_queue.h"
#include "framework/engines/timewarp/flight_histories.h"
#include "framework/trajectory/virtual_times.h"
#include "solutions_private/a4_timewarp/fast/changes.h"
#include "solutions_private/a4_timewarp/fast/lengths.h"
#include "solutions_private/a4_timewarp/fast/partition.h"

namespace tumble::a4 {

using engines::ActivePairs;
using engines::Box;
using engines::EventStamp;
using engines::Flight;
using engines::FlightHistories;
using engines::FlightHistory;
using engines::FlightRun;
using engines::FlightWorld;
using engines::StampKind;

// microstep of a process's advance: after the impacts of its instant
constexpr std::uint32_t kAfterAll = std::numeric_limits<std::uint32_t>::max();
// owner of bodies that more than one thread may meet; with one thread, of all
constexpr std::size_t kBoundary = 0;

/// An event in the queue: an impact of two flights, or the advance of a process from its horizon.
struct Due {
  EventStamp key;
  std::uint32_t version_a, version_b;  // of the flights; of an advance: the process's version
};
/// Whether it is only the advance of a process: nothing of it is committed.
inline bool is_advance(const Due& due) {
  return due.key.kind == StampKind::kAdvance || due.key.kind == StampKind::kRecheck;
}

struct LogicalProcess {
  double horizon = 0.0;                        // local virtual time [s]
  double obstacle_time = kInfinity;            // first impact of the flight with a half-space [s]
  std::uint32_t obstacle_version = kAfterAll;  // of the flight that it was computed for
  std::int32_t obstacle = -1;
  std::uint32_t version = 0;  // of the advance in the queue; others are stale
  std::uint32_t next_version = 1;
};

/// An executed impact; committed when global virtual time has passed it, unless it is rolled back.
struct Executed {
  EventStamp key;
  std::uint32_t version_a, version_b;  // of the flights that began with it
  Event first;
  std::vector<Event> more;
  bool is_silent = false;                      // no event is recorded
  std::size_t processes = 0;                   // on which flights began with it
  std::unique_ptr<engines::RunWatch> noted{};  // of its discontinuity
};

/// One region with its queue, or the boundary.
struct alignas(64) Domain {
  Domain(ActivePairs::Entries& boxes, int number, int held, const Lengths& lengths, double bin)
      : pairs(boxes, number, held, lengths.cell), queue(bin) {}
  Box region;  // none for the boundary
  // boxes of the bodies that it owns; obstacles belong to the boundary
  ActivePairs pairs;
  engines::EventQueue<Due> queue;
};

struct Shared {
  Shared(const scene::Scene& scene, const Laws& laws, const engines::RunOptions& options,
         TrajectorySink& sink)
      : run(scene, laws, options, sink),
        faults(options.faults),
        threads(options.threads),
        regions(regions_for(run.world(), options)),
        most_states(options.most_states),
        histories(static_cast<std::size_t>(run.world().size())),
        processes(static_cast<std::size_t>(run.world().size())),
        owner(static_cast<std::size_t>(run.world().size()), kBoundary),
        last_region(owner),
        boxes(static_cast<std::size_t>(run.world().size())),
        lengths(lengths_for(run.world())) {}

  FlightRun run;
  const engines::FaultInjection faults;
  const int threads;
  const int regions;      // 1: the boundary has all bodies, and one thread runs
  const int most_states;  // of a body; 0: no limit
  FlightHistories histories;
  Changes changes;
  std::vector<LogicalProcess, LargePages<LogicalProcess>> processes;  // by body
  std::vector<std::uint8_t> owner;                                    // by body: index in domains
  // by body: the last owner that was not the boundary; the boundary: none yet. With several threads
  std::vector<std::uint8_t> last_region;
  // by body: recent cost of its advances, written by the thread that advances it; empty: not
  // measured
  std::vector<double> work_loads;
  ActivePairs::Entries boxes;  // by body, for every owner
  const Lengths lengths;
  std::vector<Domain> domains;  // the boundary first
  std::vector<int> planes;      // half-spaces
  std::vector<bool> called;     // by callback: executed, and not rolled back
  double committed = 0.0;       // everything before is committed [s]
  // with several threads: its value at the start of the epoch [s]
  double global_virtual_time = 0.0;
  // no local virtual time is farther ahead of the global one [s]
  double optimism_window = kInfinity;
  bool is_recorded = false;  // changes of local virtual times are recorded

  const FlightWorld& world() const { return run.world(); }
  const Flight& immovable(int body) const { return run.world().first_flight(body); }
  int first_member(int body) const {
    return run.world().first_member(body, histories[body].back());
  }
  EventStamp begin_of(int body, const Flight& flight) const {
    if (flight.change >= 0) return changes.key(flight.change);
    return {flight.begin, flight.microstep, StampKind::kCollision, std::min(body, flight.partner),
            std::max(body, flight.partner)};
  }
  /// The owner of an event: the boundary, where its bodies do not all have one owner.
  std::size_t owner_of(const EventStamp& key) const {
    if (key.kind == StampKind::kCallback) return kBoundary;
    const std::size_t a = owner_of(key.body_a), b = owner_of(key.body_b);
    if (a == kAnywhere) return b;
    return b == kAnywhere || a == b ? a : kBoundary;
  }

 private:
  static constexpr std::size_t kAnywhere = 256;
  std::size_t owner_of(int body) const {
    return body < 0 || !run.world().can_move(body) ? kAnywhere
                                                   : owner[static_cast<std::size_t>(body)];
  }
};

}  // namespace tumble::a4
