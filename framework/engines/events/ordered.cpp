#include "framework/engines/events/ordered.h"

#include <algorithm>
#include <limits>

#include "framework/core/numbers.h"
#include "framework/engines/events/flight_run.h"
#include "framework/engines/base/guarded_laws.h"

namespace tumble::engines {
namespace {

constexpr EventStamp kNeverKey{kInfinity, 0, StampKind::kCollision, -1, -1};

class OrderedRun {
 public:
  OrderedRun(const scene::Scene& scene, const Laws& laws, const RunOptions& options,
             TrajectorySink& sink)
      : run_(scene, laws, options, sink) {
    for (int i = 0; i < run_.world().size(); ++i) flights_.push_back(run_.world().first_flight(i));
    first_of_.assign(flights_.size(), kNeverKey);
  }

  void run() {
    std::string stopped_by;
    try {
      // the last instant is part of the run
      for (double begin = 0.0; begin <= run_.duration(); begin = end_) look_through_window(begin);
      at_ = kInfinity;
      draw_before(kInfinity);
    } catch (const StoppedRun& stop) {
      stopped_by = stop.what();
    }
    for (const int i : run_.world().movers())
      run_.world().stand(flights_[i], run_.stands_until(stopped_by, at_));
    run_.end(stopped_by);
  }

 private:
  void look_through_window(double begin) {
    if (run_.world().processes())
      run_.world().processes()->segments().forget_before(std::min(begin, run_.next_frame()));
    end_ = run_.impacts().window_end(begin);
    at_ = begin_ = begin;
    for (const int a : run_.world().movers()) first_of_[a] = first_among_all(a);
    for (;;) {
      EventStamp next = kNeverKey;
      for (const int a : run_.world().movers())
        if (first_of_[a] < next) next = first_of_[a];
      if (built::kCallback && called_ < run_.callbacks().size())
        next = std::min(next, run_.callbacks()[called_]);
      if (!(next.time < end_) || next.time > run_.duration()) return;
      at_ = next.time;
      draw_before(next.time);
      if (next.kind == StampKind::kFault) run_.commit_frame_at(next, flight_of());
      process(next);
    }
  }

  void process(const EventStamp& key) {
    const Discontinuity discontinuity = outcome_of(key);
    run_.watch_order(key, flight_of());
    run_.commit(discontinuity);
    std::vector<int> changed;
    if (discontinuity.begun.empty()) {
      changed = {key.body_a, key.body_b};
      if (run_.world().can_move(key.body_a)) flights_[key.body_a] = discontinuity.a;
      if (run_.world().can_move(key.body_b)) flights_[key.body_b] = discontinuity.b;
    }
    for (const BegunFlight& begun : discontinuity.begun) {
      run_.world().stand(flights_[begun.body], key.time);
      run_.world().release(flights_[begun.body]);
      flights_[begun.body] = begun.flight;
      changed.push_back(begun.body);
    }
    begin_ = key.time;
    const auto is_changed = [&](int body) {
      return std::find(changed.begin(), changed.end(), body) != changed.end();
    };
    for (const int c : run_.world().movers()) {
      if (is_changed(c) || is_changed(first_of_[c].body_a) || is_changed(first_of_[c].body_b))
        first_of_[c] = first_among_all(c);
      else
        for (const int body : changed) first_of_[c] = std::min(first_of_[c], impact_of(c, body));
    }
  }

  Discontinuity outcome_of(const EventStamp& key) {
    if (key.kind == StampKind::kProcess || key.kind == StampKind::kFault)
      return run_.end_of_segment(key, flights_[key.body_a]);
    if (key.kind == StampKind::kCollision)
      return run_.resolve_impact(key, flights_[key.body_a], flights_[key.body_b]);
    ++called_;
    return run_.call(key, flight_of());
  }

  EventStamp impact_of(int a, int b) {
    if (a == b || !run_.world().may_collide(a, b)) return kNeverKey;
    const double time =
        run_.impacts().first_impact(a, flights_[a], b, flights_[b], begin_, end_, run_.cost);
    return time < kInfinity ? key_of_impact(a, flights_[a], b, flights_[b], time) : kNeverKey;
  }

  EventStamp first_among_all(int a) {
    EventStamp first = run_.own_end(a, flights_[a], end_).value_or(kNeverKey);
    for (int b = 0; b < run_.world().size(); ++b) first = std::min(first, impact_of(a, b));
    return first;
  }

  void draw_before(double t) {
    while (run_.next_frame() < t) run_.commit_frame(flight_of());
  }
  FlightOf flight_of() const {
    return [this](int body) -> const Flight& { return flights_[body]; };
  }

  FlightRun run_;
  std::vector<Flight> flights_;       // by body
  std::vector<EventStamp> first_of_;  // by body: the first impact that involves it in this window
  std::size_t called_ = 0;            // callbacks
  double begin_ = 0.0, end_ = 0.0;    // the current window [s]
  double at_ = 0.0;                   // nothing before it is left to do [s]
};

}  // namespace

void run_ordered(const scene::Scene& scene, const Laws& laws, const RunOptions& options,
                 TrajectorySink& sink) {
  OrderedRun(scene, laws, options, sink).run();
}

}  // namespace tumble::engines
