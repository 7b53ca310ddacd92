/// Impacts at one instant of bodies that fly freely: what their order decides.
///
/// Engines resolve them pair by pair, in the order of stamps (flight.h). Where one body meets two
/// at one instant, the first impact may change the second, or prevent it. What the opposite order
/// gives is computed as in a world of all bodies that touch there (sequential_impacts.h), and said
/// in the same words.
///
/// Not looked at: bodies on island segments, and in large worlds pairs of movable bodies.
#pragma once

#include <optional>
#include <vector>

#include "framework/engines/base/run_watch.h"
#include "framework/engines/events/flight_frames.h"
#include "framework/engines/events/flight_world.h"
#include "framework/engines/events/process_world.h"

namespace tumble::engines {

class TiedImpacts {
 public:
  TiedImpacts(const FlightWorld& world, const Laws& laws, ProcessRules rules)
      : world_(world), laws_(laws), rules_(rules) {}

  /// Says once a run where the opposite order gives another result, and where an impact has more
  /// than one normal (contact/impact_normal.h).
  /// @param key     of an impact that is committed
  /// @param before  the flights of all bodies before that instant
  void look(const EventStamp& key, const FlightOf& before, RunWatch& watch);

 private:
  bool is_far(int body, const Vector3d& com_world, int other, double t, const Flight& flight) const;
  bool touch(int a, int b, double t, const FlightOf& before) const;
  bool approach(int a, int b, double t, const FlightOf& before) const;
  std::vector<int> partners(int body, double t, const FlightOf& before) const;
  void look_at_normal(const EventStamp& key, const FlightOf& before, RunWatch& watch) const;
  std::vector<int> touching(const EventStamp& key, const FlightOf& before) const;
  bool meets_another(const EventStamp& key, const FlightOf& before) const;

  const FlightWorld& world_;
  const Laws& laws_;
  ProcessRules rules_;
  std::optional<EntriesByBody> entries_;  // from the first such instant on
};

}  // namespace tumble::engines
