/// What an impact does to two bodies on their flights: the laws' impulse, a rest, or a hop.
///
/// The law of several bodies that touch at one instant is the order of events (flight.h): pairs collide one after the other, lowest
/// generation first, then lowest bodies. For equal balls in a row and restitution 1 this is Newton's cradle.
#pragma once

#include <vector>

#include "framework/dynamics/laws.h"
#include "framework/engines/events/flight_world.h"
#include "framework/trajectory/trajectory.h"

namespace tumble::engines {

/// What the flights of a pair become, or those of a process.
struct Meeting {
  EventKey key;
  Flight a, b;                 // of key.body_a and key.body_b, from key.time on; serials are the caller's to give
  std::vector<BegunFlight> begun;   // where processes took part: all flights that begin, and `a` and `b` are not used
  double impulse = 0.0;        // sum of the impulses along the normal [N s]
  Event first;                 // the first impulse, or the rest that came without one
  std::vector<Event> more;     // flat landings take several; coming to rest
  bool is_silent = false;      // members of a process only part: nothing is said of it
};

struct MeetingRules {
  double rest_speed;           // [m/s]
  double micro_interval;       // a pair that meets again within this, slower than the rest speed, is sent apart at the rest speed [s]
};

class MeetingOfFlights {
 public:
  /// @pre `laws` has the three laws of an impact
  MeetingOfFlights(const FlightWorld& world, const Laws& laws, MeetingRules rules) : world_(world), laws_(laws), rules_(rules) {}

  /// @param f, g  flights of key.body_a and key.body_b, which meet at key.time
  /// @throws StoppedRun where the laws leave the two approaching, or give what is not a number
  Meeting meet(const EventKey& key, const Flight& f, const Flight& g) const;

 private:
  struct Work;
  void collide(Work& work) const;
  void push(Work& work, const Contact& contact, double impulse) const;
  void hop(Work& work) const;
  bool settle(Work& work, int body, int support) const;
  void draw_apart(Work& work) const;
  Flight flight_of(const Work& work, int body, const Flight& before, const Body& now) const;

  const FlightWorld& world_;
  const Laws& laws_;
  MeetingRules rules_;
};

}  // namespace tumble::engines
