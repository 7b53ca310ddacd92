/// The state of the fast scheduler: processes, executed and pending events, and the territories
/// that each body lies in.
///
/// An epoch has two passes, and for each of them space is cut into territories in another way: the
/// second cut goes across the first. In a pass each thread advances the bodies whose swept boxes
/// lie in its territory of that pass: no other thread touches them while threads run. The other
/// bodies belong to the boundary of that pass: threads read them and change nothing about them.
/// What crosses the first cut is so worked at by several threads in the second pass, and one thread
/// alone has only what crosses both. With one region every body belongs to the boundary, and its
/// thread always runs alone. For very many bodies there are more regions than threads, so that the
/// working set of an epoch fits a thread's caches (partition.h); with one thread there is no second
/// pass.
///
/// Both cuts together divide space into domains (for two threads: four corners, four pieces of
/// planes, and what crosses both). Each has a queue and a grid of its own, which belong to one
/// thread in each pass, so that no body changes hands between the passes.
#pragma once

#include <array>
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
// the territory of bodies that lie in none; with one region, of all
constexpr std::uint8_t kBoundary = 0;
constexpr int kPasses = 2;

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

/// By pass: the territory in which a body lies, or all bodies of an event; kBoundary: in none.
struct Site {
  std::array<std::uint8_t, kPasses> territory{};

  bool operator==(const Site&) const = default;
};
/// The site of an event on two bodies.
inline Site common(const Site& a, const Site& b) {
  Site both;
  for (std::size_t pass = 0; pass < kPasses; ++pass)
    both.territory[pass] = a.territory[pass] == b.territory[pass] ? a.territory[pass] : kBoundary;
  return both;
}

/// The bodies of one site, and the queue of its events. The first is the boundary of both passes:
/// it has obstacles and callbacks, too.
struct alignas(64) Domain {
  Domain(ActivePairs::Entries& boxes, int number, const Site& site, int held, double cell,
         double bin)
      : site(site), pairs(boxes, number, held, cell), queue(bin) {}
  Site site;
  Box region;  // what its territories have in common
  Box hull;    // of the boxes in the grid; with one domain: all space
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
        slabs(slabs_for(regions, threads)),
        most_states(options.most_states),
        histories(static_cast<std::size_t>(run.world().size())),
        processes(static_cast<std::size_t>(run.world().size())),
        last_region(static_cast<std::size_t>(run.world().size()), kBoundary),
        boxes(static_cast<std::size_t>(run.world().size())),
        lengths(lengths_for(run.world())) {
    territory_of.fill(last_region);
  }

  FlightRun run;
  const engines::FaultInjection faults;
  const int threads;
  const int regions;      // of the first pass; 1: the boundary has all bodies, one thread runs
  const int slabs;        // territories of the second pass; 0: there is none
  const int most_states;  // of a body; 0: no limit
  FlightHistories histories;
  Changes changes;
  std::vector<LogicalProcess, LargePages<LogicalProcess>> processes;  // by body
  // by pass and body; a thread changes only its bodies' territories of the other pass
  std::array<std::vector<std::uint8_t>, kPasses> territory_of;
  // by body: the last region that it lay in; the boundary: none yet. With several threads
  std::vector<std::uint8_t> last_region;
  // by body: recent cost of its advances, written by the thread that advances it; empty: not
  // measured
  std::vector<double> work_loads;
  ActivePairs::Entries boxes;  // by body, for every domain
  const Lengths lengths;
  // by pass: the boundary first, which is no box
  std::array<std::vector<Box>, kPasses> territories;
  std::vector<Domain> domains;  // by site: see domain_of
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
  std::size_t domain_of(const Site& site) const {
    return site.territory[0] * (static_cast<std::size_t>(slabs) + 1) + site.territory[1];
  }
  Site site_of(int body) const {
    Site site;
    for (std::size_t pass = 0; pass < kPasses; ++pass)
      site.territory[pass] = territory_of[pass][static_cast<std::size_t>(body)];
    return site;
  }
  std::size_t domain_of(int body) const { return domain_of(site_of(body)); }
  /// The site that the movable bodies of an event have in common.
  Site site_of(const EventStamp& key) const {
    if (key.kind == StampKind::kCallback) return {};
    if (!can_move(key.body_a)) return site_of(key.body_b);
    return can_move(key.body_b) ? common(site_of(key.body_a), site_of(key.body_b))
                                : site_of(key.body_a);
  }
  Domain& domain_of(const EventStamp& key) { return domains[domain_of(site_of(key))]; }
  /// Enters a body's box, in place of its previous one, at this site. Writes no territory that
  /// stays the same: other threads may read it.
  void enter(int body, const Site& site, Box box) {
    const Site before = site_of(body);
    if (site != before) domains[domain_of(before)].pairs.remove(body);
    for (std::size_t pass = 0; pass < kPasses; ++pass)
      if (site.territory[pass] != before.territory[pass])
        territory_of[pass][static_cast<std::size_t>(body)] = site.territory[pass];
    Domain& domain = domains[domain_of(site)];
    domain.hull.take_in(box);
    domain.pairs.set_box(body, box);
  }
  bool can_move(int body) const { return body >= 0 && run.world().can_move(body); }
};

}  // namespace tumble::a4
