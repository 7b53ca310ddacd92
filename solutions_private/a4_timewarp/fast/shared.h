/// What the fast scheduler knows: processes, what they have done, what is to come, and which thread looks after which of them.
///
/// Every movable body has a home. Those whose swept boxes lie in one thread's territory are at home there: nobody but that thread touches
/// them while threads work. The others are at the border, and wait: threads look at what they have done and change nothing about them,
/// until one thread works alone. With one territory every body is at the border, and its thread always works alone. There are more territories
/// than threads where there are very many bodies: what a thread looks at for a while then fits its caches (territories.h).
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "framework/core/numbers.h"
#include "framework/engines/events/flight_run.h"
#include "framework/engines/timewarp/active_pairs.h"
#include "framework/engines/timewarp/event_queue.h"
#include "framework/engines/timewarp/flight_histories.h"
#include "framework/trajectory/virtual_times.h"
#include "solutions_private/a4_timewarp/fast/changes.h"
#include "solutions_private/a4_timewarp/fast/lengths.h"
#include "solutions_private/a4_timewarp/fast/territories.h"

namespace tumble::a4 {

using engines::ActivePairs;
using engines::Box;
using engines::EventClass;
using engines::EventKey;
using engines::Flight;
using engines::FlightHistories;
using engines::FlightHistory;
using engines::FlightRun;
using engines::FlightWorld;

constexpr std::uint32_t kAfterAll = std::numeric_limits<std::uint32_t>::max();   // generation of a process's going on: after the impacts of its instant
constexpr std::size_t kBorder = 0;            // home of bodies that more than one thread may meet; of all, with one thread

/// An event in the queue: an impact of two flights, or a process that goes on from its horizon.
struct Due {
  EventKey key;
  std::uint32_t serial_a, serial_b;   // of the flights; of a process: its ticket
};
/// A process goes on: nothing happens that could be committed.
inline bool goes_on(const Due& due) { return due.key.kind == EventClass::kAdvance || due.key.kind == EventClass::kLookAgain; }

struct Process {
  double horizon = 0.0;               // local virtual time [s]
  double obstacle_time = kInfinity;   // first impact of the flight with a half-space [s]
  std::uint32_t obstacle_serial = kAfterAll;   // of the flight that this was worked out for
  std::int32_t obstacle = -1;
  std::uint32_t ticket = 0;           // of the going on that stands in the queue; others are stale
  std::uint32_t next_serial = 1;
};

/// An impact that was worked at; committed when global virtual time has passed it, unless it was taken back.
struct Executed {
  EventKey key;
  std::uint32_t serial_a, serial_b;   // of the flights it began
  Event first;
  std::vector<Event> more;
  bool is_silent = false;             // nothing is said of it
};

/// One thread's part of the room, or the border.
struct alignas(64) Domain {
  Domain(ActivePairs::Entries& boxes, int number, int held, const Lengths& lengths, double bin) : pairs(boxes, number, held, lengths.cell), queue(bin) {}
  Box territory;                      // of the border: none
  ActivePairs pairs;                  // whose home is here; obstacles stand at the border
  engines::EventQueue<Due> queue;
};

struct Shared {
  Shared(const scene::Scene& scene, const Laws& laws, const engines::RunOptions& options, TrajectorySink& sink)
      : run(scene, laws, options, sink), trial(options.trial), threads(options.threads), territories(territories_for(run.world(), options)), most_states(options.most_states), histories(static_cast<std::size_t>(run.world().size())),
        processes(static_cast<std::size_t>(run.world().size())), home(static_cast<std::size_t>(run.world().size()), kBorder), last_territory(home), boxes(static_cast<std::size_t>(run.world().size())), lengths(lengths_for(run.world())) {}

  FlightRun run;
  const engines::TimewarpTrial trial;
  const int threads;
  const int territories;               // 1: all is the border's, and one thread's
  const int most_states;               // of a body; 0: as many as it takes
  FlightHistories histories;
  Changes changes;
  std::vector<Process, LargePages<Process>> processes;   // by body
  std::vector<std::uint8_t> home;      // by body: place in domains
  std::vector<std::uint8_t> last_territory;   // by body: the last home that was no border; the border: none yet. With several threads
  std::vector<double> burdens;         // by body: what its going on has cost of late, written by whoever takes it on; empty: nobody wants to know
  ActivePairs::Entries boxes;          // by body: whatever its home is
  const Lengths lengths;
  std::vector<Domain> domains;         // the border first
  std::vector<int> planes;             // half-spaces
  std::vector<bool> called;            // by callback: executed, and not taken back
  double committed = 0.0;              // everything before is committed [s]
  double global_virtual_time = 0.0;    // where several threads work: as it was when they began [s]
  double window = kInfinity;           // no local virtual time goes farther beyond the global one [s]
  bool is_recorded = false;            // moves of local virtual times are wanted

  const FlightWorld& world() const { return run.world(); }
  const Flight& immovable(int body) const { return run.world().first_flight(body); }
  int first_member(int body) const { return run.world().first_member(body, histories[body].back()); }
  EventKey begin_of(int body, const Flight& flight) const {
    if (flight.change >= 0) return changes.key(flight.change);
    return {flight.begin, flight.generation, EventClass::kCollision, std::min(body, flight.partner), std::max(body, flight.partner)};
  }
  /// Whose affair an event is: the border's, where its bodies are not all at home in one place.
  std::size_t home_of(const EventKey& key) const {
    if (key.kind == EventClass::kCallback) return kBorder;
    const std::size_t a = home_of(key.body_a), b = home_of(key.body_b);
    if (a == kAnywhere) return b;
    return b == kAnywhere || a == b ? a : kBorder;
  }

 private:
  static constexpr std::size_t kAnywhere = 256;
  std::size_t home_of(int body) const { return body < 0 || !run.world().can_move(body) ? kAnywhere : home[static_cast<std::size_t>(body)]; }
};

}  // namespace tumble::a4
